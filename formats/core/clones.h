/* clones.h - compiles a hot function for several x86-64 levels and picks one at load.
 *
 * Results do not depend on the clone: contraction is off and reductions name their lanes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_CLONES_H
#define PARIAN_CORE_CLONES_H

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__) &&   \
    !defined(PARIAN_SANITIZE)
#define PARIAN_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define PARIAN_CLONES
#endif

#endif
