/* border.c - lists the neighbours of texels whose window leaves their chart, across charts.
 *
 * A texel is interior when every texel of its window is owned and fully covered by its chart, and
 * no opposite side of a sheet is nearer than the window reaches; its window is then its
 * neighbourhood. All others are border texels and carry a list. Two texels are neighbours
 *   - of one chart: when each lies in the other's window;
 *   - of two charts, which then are both border texels: when their Euclidean distance is at most
 *     that of a disc with the window's area. Lists reach around sharp edges, and through walls that
 *     are too thin for the vertices to resolve.
 * Both rules are symmetric. Lists are counted first and filled afterwards, by slices of border
 * texels.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/stages/texels_parts.h"
#include "core/memory.h"
#include "core/small_maths.h"

enum { SLICE = 512, HASH_LOAD = 2 };
static const float FULL_COVER = 0.999f;
static const float OPPOSITE_COSINE = -0.2f; /* beyond an edge of 100 degrees */

/* What the rule across charts needs of a border texel, filed in the order of the hash. */
typedef struct border_point {
    float position[3], normal[3];
    uint32_t chart, texel;
} border_point;

typedef struct border_job {
    const parian_body *body;
    int32_t half;           /* of the window */
    float radius2;          /* m^2 */
    double cell_size;       /* of the hash grid, metres */
    uint8_t *supported;     /* [side^2] scratch of the erosion, then: interior */
    uint32_t *chart;        /* [texel_count] */
    uint32_t *bucket_begin; /* [bucket_count + 1] into point */
    border_point *point;    /* [border_count] texels ascending in a bucket */
    uint32_t bucket_mask;
    uint32_t border_count;
    uint32_t *border_texel; /* the texels that are hashed and listed; all while looking for walls */
    uint8_t *thin;          /* [texel_count] an opposite side is near */
    uint32_t *offset;       /* [border_count + 1] */
    uint32_t *neighbour;    /* NULL while counting */
} border_job;

/* Keep what has `half` set cells on both sides, along rows (step 1) or columns (step side). */
static void erode(uint8_t *map, uint32_t side, size_t step, uint32_t half)
{
    size_t across = step == 1 ? side : 1;
    for (size_t line = 0; line < side; line++) {
        uint8_t *cell = map + line * across;
        uint32_t length = 0;
        for (uint32_t i = 0; i <= side; i++) {
            if (i < side && cell[i * step]) {
                length++;
                continue;
            }
            /* A run of set cells ends before i: clear `half` cells at both ends. */
            for (uint32_t k = 0; k < half && k < length; k++) {
                cell[(i - 1 - k) * step] = 0;
                cell[(i - length + k) * step] = 0;
            }
            length = 0;
        }
    }
}

/* The map of the texels whose windows are covered by their charts. */
static void find_supported(border_job *job, const float *covered)
{
    const parian_body *body = job->body;
    uint32_t side = body->atlas_size;
    memset(job->supported, 0, (size_t)side * side);
    for (uint32_t i = 0; i < body->texel_count; i++) {
        job->supported[body->texel_index[i]] = covered[i] > FULL_COVER;
    }
    erode(job->supported, side, 1, (uint32_t)job->half);
    erode(job->supported, side, side, (uint32_t)job->half);
}

/* All texels, to look for walls among them. */
static parian_result take_all(const parian_env *env, border_job *job)
{
    const parian_body *body = job->body;
    job->border_count = body->texel_count;
    if (!PARIAN_NEW(env, job->border_texel, body->texel_count) ||
        !PARIAN_NEW(env, job->chart, body->texel_count) ||
        !PARIAN_NEW0(env, job->thin, body->texel_count)) {
        return PARIAN_E_NOMEM;
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        job->chart[i] = texel_chart(body, i);
        job->border_texel[i] = i;
    }
    return PARIAN_OK;
}

/* Only the border texels from here on. */
static void keep_border(border_job *job)
{
    const parian_body *body = job->body;
    job->border_count = 0;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        if (!job->supported[body->texel_index[i]] || job->thin[i]) {
            job->border_texel[job->border_count++] = i;
        }
    }
}

/* The radius of a disc with a window's area, from the mean texel. */
static double window_radius(const parian_body *body, const float *covered)
{
    double area = 0.0, cover = 0.0;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        area += (double)body->texel_area[i];
        cover += (double)covered[i];
    }
    return body->kernel_width * sqrt(area / fmax(cover, 1e-9) / PARIAN_PI);
}

static int64_t grid_coordinate(const border_job *job, double x)
{
    return (int64_t)floor(x / job->cell_size);
}

static uint32_t bucket_of(const border_job *job, int64_t x, int64_t y, int64_t z)
{
    uint64_t key = (uint64_t)x * 0x9E3779B97F4A7C15u ^ (uint64_t)y * 0xC2B2AE3D27D4EB4Fu ^
                   (uint64_t)z * 0x165667B19E3779F9u;
    key ^= key >> 32;
    key *= 0xD6E8FEB86659FD93u;
    return (uint32_t)(key >> 32) & job->bucket_mask;
}

static uint32_t bucket_of_texel(const border_job *job, uint32_t texel)
{
    const float *p = job->body->texel_position[texel];
    return bucket_of(job, grid_coordinate(job, (double)p[0]), grid_coordinate(job, (double)p[1]),
                     grid_coordinate(job, (double)p[2]));
}

/* Hash the texels at hand by their position, cells as wide as the radius. */
static parian_result fill_hash(const parian_env *env, border_job *job)
{
    uint32_t bucket_count = 64;
    while (bucket_count < HASH_LOAD * (uint64_t)job->border_count && bucket_count < 1u << 30) {
        bucket_count *= 2;
    }
    job->bucket_mask = bucket_count - 1;
    parian_free(env, job->bucket_begin);
    parian_free(env, job->point);
    job->point = NULL;
    if (!PARIAN_NEW0(env, job->bucket_begin, (size_t)bucket_count + 2) ||
        !PARIAN_NEW(env, job->point, job->border_count)) {
        return PARIAN_E_NOMEM;
    }
    for (uint32_t b = 0; b < job->border_count; b++) {
        job->bucket_begin[bucket_of_texel(job, job->border_texel[b]) + 2]++;
    }
    for (uint32_t i = 0; i < bucket_count; i++) {
        job->bucket_begin[i + 1] += job->bucket_begin[i];
    }
    for (uint32_t b = 0; b < job->border_count; b++) {
        uint32_t texel = job->border_texel[b];
        border_point *p = &job->point[job->bucket_begin[bucket_of_texel(job, texel) + 1]++];
        memcpy(p->position, job->body->texel_position[texel], sizeof p->position);
        memcpy(p->normal, job->body->texel_normal[texel], sizeof p->normal);
        p->chart = job->chart[texel];
        p->texel = texel;
    }
    return PARIAN_OK;
}

/* Neighbours of the same chart, through the window. */
static uint32_t list_window(const border_job *job, uint32_t texel, uint32_t *out)
{
    const parian_body *body = job->body;
    int32_t side = (int32_t)body->atlas_size, half = job->half;
    int32_t u = (int32_t)(body->texel_index[texel] % body->atlas_size);
    int32_t v = (int32_t)(body->texel_index[texel] / body->atlas_size);
    uint32_t chart = job->chart[texel], count = 0;
    for (int32_t y = v > half ? v - half : 0; y <= v + half && y < side; y++) {
        for (int32_t x = u > half ? u - half : 0; x <= u + half && x < side; x++) {
            uint32_t other = body->texel_at[(size_t)y * (size_t)side + (size_t)x];
            if (other != UINT32_MAX && job->chart[other] == chart) {
                if (out) {
                    out[count] = other;
                }
                count++;
            }
        }
    }
    return count;
}

static bool across_charts(const border_job *job, uint32_t texel, const border_point *other)
{
    return parian_distance2f(job->body->texel_position[texel], other->position) <= job->radius2 &&
           other->chart != job->chart[texel];
}

static bool opposite(const border_job *job, uint32_t texel, const border_point *other)
{
    const float *n = job->body->texel_normal[texel], *m = other->normal;
    return n[0] * m[0] + n[1] * m[1] + n[2] * m[2] <= OPPOSITE_COSINE &&
           across_charts(job, texel, other);
}

/* The buckets of the 27 cells around a texel, each once: cells may share one. */
static uint32_t buckets_around(const border_job *job, uint32_t texel, uint32_t seen[27])
{
    uint32_t seen_count = 0;
    int64_t at[3];
    for (int d = 0; d < 3; d++) {
        at[d] = grid_coordinate(job, (double)job->body->texel_position[texel][d]);
    }
    for (int cell = 0; cell < 27; cell++) {
        uint32_t bucket = bucket_of(job, at[0] + cell % 3 - 1, at[1] + cell / 3 % 3 - 1,
                                    at[2] + cell / 9 - 1),
                 k = 0;
        while (k < seen_count && seen[k] != bucket) {
            k++;
        }
        if (k < seen_count) {
            continue;
        }
        seen[seen_count++] = bucket;
    }
    return seen_count;
}

/* Neighbours of other charts, through the hash. */
static uint32_t list_across(const border_job *job, uint32_t texel, uint32_t *out)
{
    uint32_t bucket[27], count = 0, buckets = buckets_around(job, texel, bucket);
    for (uint32_t b = 0; b < buckets; b++) {
        for (uint32_t i = job->bucket_begin[bucket[b]]; i < job->bucket_begin[bucket[b] + 1]; i++) {
            if (across_charts(job, texel, &job->point[i])) {
                if (out) {
                    out[count] = job->point[i].texel;
                }
                count++;
            }
        }
    }
    return count;
}

static bool has_opposite(const border_job *job, uint32_t texel)
{
    uint32_t bucket[27], buckets = buckets_around(job, texel, bucket);
    for (uint32_t b = 0; b < buckets; b++) {
        for (uint32_t i = job->bucket_begin[bucket[b]]; i < job->bucket_begin[bucket[b] + 1]; i++) {
            if (opposite(job, texel, &job->point[i])) {
                return true;
            }
        }
    }
    return false;
}

static void find_thin_slice(void *context, size_t slice)
{
    border_job *job = context;
    uint32_t first = (uint32_t)slice * SLICE;
    uint32_t end = job->border_count - first < SLICE ? job->border_count : first + SLICE;
    for (uint32_t i = first; i < end; i++) {
        job->thin[i] = has_opposite(job, i);
    }
}

static int compare_texels(const void *left, const void *right)
{
    uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
    return a < b ? -1 : a > b;
}

/* Sort a list whose first `sorted` entries ascend already. */
static void sort_list(uint32_t *list, uint32_t count, uint32_t sorted)
{
    if (count > 128) {
        qsort(list, count, sizeof *list, compare_texels);
        return;
    }
    for (uint32_t i = sorted; i < count; i++) {
        uint32_t moving = list[i], j = i;
        for (; j > 0 && list[j - 1] > moving; j--) {
            list[j] = list[j - 1];
        }
        list[j] = moving;
    }
}

/* Count or fill the lists of a slice of border texels. */
static void list_slice(void *context, size_t slice)
{
    border_job *job = context;
    uint32_t first = (uint32_t)slice * SLICE;
    uint32_t end = job->border_count - first < SLICE ? job->border_count : first + SLICE;
    for (uint32_t b = first; b < end; b++) {
        uint32_t *out = job->neighbour ? job->neighbour + job->offset[b] : NULL;
        uint32_t window = list_window(job, job->border_texel[b], out);
        uint32_t count = window + list_across(job, job->border_texel[b], out ? out + window : NULL);
        if (out) {
            sort_list(out, count, window);
        } else {
            job->offset[b + 1] = count;
        }
    }
}

static parian_result make_lists(const parian_env *env, border_job *job)
{
    uint64_t total = 0;
    size_t slices = (job->border_count + SLICE - 1) / SLICE;
    if (!PARIAN_NEW0(env, job->offset, (size_t)job->border_count + 1)) {
        return PARIAN_E_NOMEM;
    }
    parian_par(env, slices, list_slice, job);
    for (uint32_t b = 0; b < job->border_count; b++) {
        total += job->offset[b + 1];
        if (total > UINT32_MAX) {
            return parian_fail(
                env, PARIAN_E_LIMIT,
                "the %u border texels have more than 2^32 neighbours within %g m; the "
                "atlas is too coarse for this surface",
                job->border_count, sqrt((double)job->radius2));
        }
        job->offset[b + 1] = (uint32_t)total;
    }
    if (!PARIAN_NEW(env, job->neighbour, total)) {
        return PARIAN_E_NOMEM;
    }
    parian_par(env, slices, list_slice, job);
    return PARIAN_OK;
}

parian_result texels_border(const parian_env *env, parian_body *body, const float *covered)
{
    border_job job = {.body = body, .half = (int32_t)(body->kernel_width / 2)};
    double radius = window_radius(body, covered);
    job.radius2 = (float)(radius * radius);
    /* A little wider than the radius: no neighbour is lost to rounding at cell faces. */
    job.cell_size = 1.0001 * radius;
    parian_result result = PARIAN_E_NOMEM;
    if (PARIAN_NEW(env, job.supported, (size_t)body->atlas_size * body->atlas_size)) {
        find_supported(&job, covered);
        result = take_all(env, &job);
    }
    if (result == PARIAN_OK) {
        result = fill_hash(env, &job);
    }
    if (result == PARIAN_OK) {
        parian_par(env, (job.border_count + SLICE - 1) / SLICE, find_thin_slice, &job);
        keep_border(&job);
        result = fill_hash(env, &job);
    }
    if (result == PARIAN_OK) {
        result = make_lists(env, &job);
    }
    if (result == PARIAN_OK) {
        body->border_count = job.border_count;
        body->border_texel = job.border_texel;
        body->border_offset = job.offset;
        body->border_neighbour = job.neighbour;
        job.border_texel = job.offset = job.neighbour = NULL;
    } else if (result == PARIAN_E_NOMEM) {
        parian_fail(env, result, "no memory for the neighbours of %u border texels",
                    job.border_count);
    }
    parian_free(env, job.neighbour);
    parian_free(env, job.offset);
    parian_free(env, job.border_texel);
    parian_free(env, job.point);
    parian_free(env, job.chart);
    parian_free(env, job.thin);
    parian_free(env, job.bucket_begin);
    parian_free(env, job.supported);
    return result;
}
