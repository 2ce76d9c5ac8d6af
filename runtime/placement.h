/* placement.h - where an instance stands: a rigid motion times a uniform scale.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_PLACEMENT_H
#define PARIAN_PLACEMENT_H

/* model: column-major, last row 0 0 0 1; its upper left 3 x 3 is a rotation times scale. */
typedef struct parian_placement {
    float model[16];
    float scale;
} parian_placement;

static inline void placement_point(const parian_placement *at, const float from[3], float to[3])
{
    const float *m = at->model, x = from[0], y = from[1], z = from[2];
    for (int c = 0; c < 3; c++) {
        to[c] = m[c] * x + m[4 + c] * y + m[8 + c] * z + m[12 + c];
    }
}

/* Unit vectors stay unit vectors. */
static inline void placement_normal(const parian_placement *at, const float from[3], float to[3])
{
    const float *m = at->model, x = from[0], y = from[1], z = from[2];
    for (int c = 0; c < 3; c++) {
        to[c] = (m[c] * x + m[4 + c] * y + m[8 + c] * z) / at->scale;
    }
}

/* A row that is multiplied with placed points becomes one for points before they are placed. */
static inline void placement_fold(const parian_placement *at, const float row[4], float folded[4])
{
    for (int k = 0; k < 4; k++) {
        const float *column = &at->model[4 * k];
        folded[k] =
            row[0] * column[0] + row[1] * column[1] + row[2] * column[2] + row[3] * column[3];
    }
}

/* The same for the four rows of a column-major matrix. */
static inline void placement_fold_matrix(const parian_placement *at, const float matrix[16],
                                         float folded[16])
{
    for (int r = 0; r < 4; r++) {
        const float row[4] = {matrix[r], matrix[4 + r], matrix[8 + r], matrix[12 + r]};
        float turned[4];
        placement_fold(at, row, turned);
        for (int k = 0; k < 4; k++) {
            folded[4 * k + r] = turned[k];
        }
    }
}

#endif
