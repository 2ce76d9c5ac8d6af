/* chunk_info.h - what can be said of a chunk from its description alone.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CHUNK_INFO_H
#define PARIAN_CHUNK_INFO_H

#include "parian/format.h"

/* Check name, element, codec, flags and shape, and compute the bytes of the array. Returns 0, or
 * the number of the violated rule with a sentence that lives as long as the program. */
int parian_chunk_info_check(const parian_chunk_info *info, uint64_t *size, const char **finding);

/* Order by object, level, name. */
int parian_chunk_info_order(const parian_chunk_info *a, const parian_chunk_info *b);

#endif
