/* lanes.h - sixteen floats at a time, in the compiler's vector types: the same bits on every
 * machine.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_LANES_H
#define PARIAN_CORE_LANES_H

#include <stdint.h>
#include <string.h>

typedef float parian_lanes __attribute__((vector_size(64)));
typedef int32_t parian_lane_mask __attribute__((vector_size(64)));
typedef int8_t parian_lane_bytes __attribute__((vector_size(16)));

/* Read sixteen floats; no alignment needed. A macro, so that no vector crosses a call. */
#define PARIAN_LANES_LOAD(lanes, from) memcpy(&(lanes), (from), sizeof(lanes))

/* The lanes where mask is set, zero elsewhere. */
#define PARIAN_LANES_WHERE(mask, lanes) ((parian_lanes)((parian_lane_mask)(lanes) & (mask)))

#endif
