/* chart_color.h - colours that tell charts apart.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CHART_COLOR_H
#define PARIAN_CHART_COLOR_H

#include <stdint.h>

static inline void parian_chart_color(uint32_t chart, float color[3])
{
    uint32_t hash = (chart + 1u) * 2654435761u;
    for (int c = 0; c < 3; c++) {
        color[c] = 0.1f + 0.8f * (float)(hash >> (8 * c + 8) & 255u) / 255.0f;
    }
}

#endif
