/* test_support.h - what tests share: an env with threads, generated meshes, scratch folders, failing memory.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_SUPPORT_H
#define PARIAN_TEST_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/mesh.h"
#include "parian/env.h"
#include "parian/result.h"

/* An env with a pool of `threads` threads (0: one for each core) that logs to stderr in verbose runs
 * (PARIAN_TEST_VERBOSE set). Lives until the process ends. */
const parian_env *test_env(unsigned threads);

/* An env whose k-th allocation (from 0) fails; counts allocations and leaks. */
typedef struct test_memory {
    size_t calls, fail_at, live;
} test_memory;
parian_env test_failing_env(test_memory *memory);

/* A path below a scratch folder of this test program, made on first use (static buffer, rotating). */
const char *test_scratch(const char *name);
/* A path below the source tree (static buffer, rotating). */
const char *test_source(const char *name);
/* A path below ../shared beside the source tree (test data that is not part of the repository), or NULL where
 * it is absent: skip then. */
const char *test_shared(const char *name);

/* Geodesic sphere of radius r: an icosahedron with each edge cut into `cuts`; 10 cuts^2 + 2 vertices. */
parian_result test_sphere(const parian_env *env, double radius, unsigned cuts, parian_mesh *mesh);
/* Flat square of side s in the plane z = 0, facing +z, n x n quads cut into right triangles. */
parian_result test_plane(const parian_env *env, double side, unsigned n, parian_mesh *mesh);
/* A box with square faces cut n x n per face, sides a, b, c, welded and closed. */
parian_result test_box(const parian_env *env, double a, double b, double c, unsigned n, parian_mesh *mesh);

#endif
