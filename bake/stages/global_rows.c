/* global_rows.c - one row of throughput factors: computed, chosen from, coded.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/global_rows.h"

#include <math.h>
#include <string.h>

#include "core/clones.h"
#include "core/half.h"
#include "core/lanes.h"
#include "core/memory.h"
#include "core/small_maths.h"

enum { GAP_MAX = 8, RUN_STEP = 8, BISECTIONS = 14 };

parian_result parian_row_maker_make(const parian_env *env, const parian_global_desc *desc,
                                    const parian_body *body, parian_row_maker *maker)
{
    memset(maker, 0, sizeof *maker);
    maker->threshold = desc && desc->threshold != 0 ? desc->threshold : 0.002;
    maker->threshold_absolute = desc ? desc->threshold_absolute : 0;
    if (body->paper_form && maker->threshold_absolute <= 0) {
        maker->threshold_absolute = 1e-5;
    }
    return parian_factor_maker_make(env, body, &maker->factors);
}

void parian_row_maker_free(const parian_env *env, parian_row_maker *maker)
{
    parian_factor_maker_free(env, &maker->factors);
}

parian_result parian_row_work_make(const parian_env *env, const parian_row_maker *maker,
                                   parian_row_work *work)
{
    size_t padded = maker->factors.frame.points.padded;
    parian_result result = parian_row_make(env, &maker->factors.frame, &work->row);
    if (result != PARIAN_OK) {
        return result;
    }
    if (!PARIAN_NEW(env, work->base, padded * 3) || !PARIAN_NEW(env, work->keep, padded) ||
        !PARIAN_NEW(env, work->coded, PARIAN_RUN_MAX)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a row of %zu factors", padded);
    }
    for (int c = 0; c < 3; c++) {
        work->weighted[c] = work->base + (size_t)c * padded;
    }
    return maker->far ? parian_far_work_make(env, maker->far, &work->far) : PARIAN_OK;
}

void parian_row_work_free(const parian_env *env, parian_row_work *work)
{
    parian_row_free(env, &work->row);
    parian_free(env, work->base);
    parian_free(env, work->keep);
    parian_free(env, work->coded);
    parian_far_work_free(env, &work->far);
    memset(work, 0, sizeof *work);
}

void parian_run_list_free(const parian_env *env, parian_run_list *list)
{
    parian_free(env, list->run);
    memset(list, 0, sizeof *list);
}

/* Leave to finer points what is theirs. */
static void clear_finer(const parian_row_maker *maker, uint32_t v, const parian_row *row)
{
    uint32_t count = maker->factors.frame.points.count;
    for (uint32_t u = 0; u < count; u++) {
        if (parian_bits_get(maker->finer, (size_t)v * count + u)) {
            row->value[0][u] = row->value[1][u] = row->value[2][u] = 0;
        }
    }
}

void parian_row_compute(const parian_row_maker *maker, uint32_t v, parian_row_work *work)
{
    const parian_vertex_frame *frame = &maker->factors.frame;
    const parian_row *row = &work->row;
    parian_factor_row(&maker->factors, v, row);
    for (int c = 0; c < 3; c++) {
        work->whole[c] = parian_row_dot(frame->area, row->value[c], frame->points.padded);
    }
    if (maker->finer) {
        clear_finer(maker, v, row);
    }
    if (maker->far) {
        parian_far_subtract(maker->far, v, &work->far, row->value);
    }
}

static inline __attribute__((always_inline)) void take_magnitude(parian_lanes *v)
{
    *v = (parian_lanes)((parian_lane_mask)*v & 0x7fffffff);
}

/* weighted = |value area|; their largest. */
PARIAN_CLONES
static float weigh_row(const float *value, const float *area, uint32_t padded, float *weighted)
{
    parian_lanes v, a, most = {0};
    for (uint32_t i = 0; i < padded; i += 16) {
        PARIAN_LANES_LOAD(v, value + i);
        PARIAN_LANES_LOAD(a, area + i);
        v *= a;
        take_magnitude(&v);
        memcpy(weighted + i, &v, sizeof v);
        parian_lane_mask more = v > most;
        most = (parian_lanes)(((parian_lane_mask)v & more) | ((parian_lane_mask)most & ~more));
    }
    float all = 0;
    for (int k = 0; k < 16; k++) {
        all = most[k] > all ? most[k] : all;
    }
    return all;
}

/* Sum of the entries below a bound. */
PARIAN_CLONES
static float sum_below(const float *weighted, uint32_t padded, float bound)
{
    parian_lanes w, lane = {0};
    float sum = 0;
    for (uint32_t i = 0; i < padded; i += 16) {
        PARIAN_LANES_LOAD(w, weighted + i);
        lane += PARIAN_LANES_WHERE(w < bound, w);
    }
    for (int k = 0; k < 16; k++) {
        sum += lane[k];
    }
    return sum;
}

/* The largest bound (found by bisecting the bits of floats) such that what lies below it sums to at
 * most `allowed`. */
static float find_bound(const float *weighted, uint32_t padded, float most, float allowed)
{
    uint32_t low = 0, high;
    memcpy(&high, &most, sizeof high);
    low = high > (24u << 23) ? high - (24u << 23) : 0;
    for (int step = 0; step < BISECTIONS; step++) {
        uint32_t middle = low + (high - low) / 2;
        float bound;
        memcpy(&bound, &middle, sizeof bound);
        if (sum_below(weighted, padded, bound) <= allowed) {
            low = middle;
        } else {
            high = middle;
        }
    }
    float found;
    memcpy(&found, &low, sizeof found);
    return found;
}

PARIAN_CLONES
static void mark_kept(float *const weighted[3], const float bound[3], uint32_t padded,
                      uint8_t *keep)
{
    const float *restrict r = weighted[0], *restrict g = weighted[1], *restrict b = weighted[2];
    float br = bound[0], bg = bound[1], bb = bound[2];
    for (uint32_t i = 0; i < padded; i++) {
        int any = (r[i] >= br && r[i] > 0) | (g[i] >= bg && g[i] > 0) | (b[i] >= bb && b[i] > 0);
        keep[i] = (uint8_t)any;
    }
}

/* Join runs that are at most GAP_MAX columns apart, and round their lengths up to RUN_STEP: a few
 * more factors cost less than another run, or than a rest that does not fill a vector. */
static void round_runs(uint8_t *keep, uint32_t count)
{
    for (uint32_t begin = 0; begin < count;) {
        const uint8_t *next = memchr(keep + begin, 1, count - begin);
        if (!next) {
            return;
        }
        begin = (uint32_t)(next - keep);
        uint32_t end = begin, gap = 0;
        for (uint32_t i = begin; i < count && gap <= GAP_MAX; i++) {
            gap = keep[i] ? 0 : gap + 1;
            end = keep[i] ? i + 1 : end;
        }
        end = begin + (end - begin + RUN_STEP - 1) / RUN_STEP * RUN_STEP;
        end = end < count ? end : count;
        memset(keep + begin, 1, end - begin);
        begin = end;
    }
}

/* Sum over what is not kept of value, or of weight times value. */
static inline __attribute__((always_inline)) float
add_unkept(const float *weight, const float *value, const uint8_t *keep, uint32_t padded)
{
    parian_lanes w, v, lane = {0};
    parian_lane_bytes bytes;
    float sum = 0;
    for (uint32_t i = 0; i < padded; i += 16) {
        PARIAN_LANES_LOAD(v, value + i);
        if (weight) {
            PARIAN_LANES_LOAD(w, weight + i);
            v *= w;
        }
        memcpy(&bytes, keep + i, sizeof bytes);
        parian_lane_mask kept = __builtin_convertvector(bytes, parian_lane_mask);
        lane += PARIAN_LANES_WHERE(kept == 0, v);
    }
    for (int k = 0; k < 16; k++) {
        sum += lane[k];
    }
    return sum;
}

PARIAN_CLONES
static float sum_unkept(const float *value, const uint8_t *keep, uint32_t padded)
{
    return add_unkept(NULL, value, keep, padded);
}

PARIAN_CLONES
static float sum_weighted_unkept(const float *weight, const float *value, const uint8_t *keep,
                                 uint32_t padded)
{
    return add_unkept(weight, value, keep, padded);
}

void parian_row_choose(const parian_row_maker *maker, uint32_t v, parian_row_work *work,
                       parian_row_choice *choice)
{
    uint32_t padded = maker->factors.frame.points.padded, count = maker->factors.frame.points.count;
    float bound[3];
    for (int c = 0; c < 3; c++) {
        float most =
            weigh_row(work->row.value[c], maker->factors.frame.area, padded, work->weighted[c]);
        double allowed = maker->threshold * work->whole[c];
        if (maker->threshold_absolute > 0) {
            bound[c] = (float)maker->threshold_absolute;
        } else if (maker->threshold > 0 && most > 0) {
            bound[c] = find_bound(work->weighted[c], padded, most, (float)allowed);
        } else {
            bound[c] = 0;
        }
    }
    mark_kept(work->weighted, bound, padded, work->keep);
    bool mend = maker->far && maker->factors.total && maker->factors.frame.area[v] > 0;
    work->keep[v] |= mend;
    round_runs(work->keep, count);
    for (int c = 0; c < 3; c++) {
        double lost = sum_unkept(work->weighted[c], work->keep, padded);
        double dropped =
            sum_weighted_unkept(maker->factors.frame.area, work->row.value[c], work->keep, padded);
        choice->lost[c] = work->whole[c] > 0 ? lost / work->whole[c] : 0;
        if (mend) {
            float *own = &work->row.value[c][v];
            *own = (float)fmax(0, *own + dropped / maker->factors.frame.area[v]);
        }
        choice->sum[c] = work->whole[c] - (mend ? 0 : dropped);
        choice->scale[c] = parian_factor_scale(work->row.value[c], padded);
    }
}

static parian_result append_run(const parian_env *env, parian_run_list *list, uint32_t column,
                                uint32_t count)
{
    if (list->count == list->capacity) {
        uint32_t capacity = list->capacity ? list->capacity * 2 : 1024;
        parian_run *run;
        if (!PARIAN_NEW(env, run, capacity)) {
            return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u runs of factors", capacity);
        }
        if (list->count) {
            memcpy(run, list->run, list->count * sizeof *run);
        }
        parian_free(env, list->run);
        list->run = run;
        list->capacity = capacity;
    }
    list->run[list->count].column = column;
    list->run[list->count++].count = count;
    return PARIAN_OK;
}

parian_result parian_row_append_runs(const parian_env *env, const parian_row_maker *maker,
                                     const parian_row_work *work, parian_run_list *list,
                                     uint64_t *factors)
{
    uint32_t count = maker->factors.frame.points.count;
    const uint8_t *keep = work->keep;
    for (uint32_t i = 0; i < count;) {
        const uint8_t *next = memchr(keep + i, 1, count - i);
        if (!next) {
            break;
        }
        uint32_t begin = (uint32_t)(next - keep);
        next = memchr(next, 0, count - begin);
        i = next ? (uint32_t)(next - keep) : count;
        for (uint32_t at = begin; at < i; at += PARIAN_RUN_MAX) {
            uint32_t length = i - at < PARIAN_RUN_MAX ? i - at : PARIAN_RUN_MAX;
            parian_result result = append_run(env, list, at, length);
            if (result != PARIAN_OK) {
                return result;
            }
        }
        *factors += i - begin;
    }
    return PARIAN_OK;
}
