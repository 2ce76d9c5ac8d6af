/* global_levels.c - coarse levels above the transfer vertices: points, interpolation, factors.
 *
 * F = N + P A P^T: A are factors between coarse points, P interpolation from them, N what is left,
 * exact where points are near and dropped where P A P^T is as good. A is made the same way.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/global_levels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"

/* Measured (docs/transfer.md): coarse points 1.7 spacings of the finer ones apart are a fifth as
 * many; nearer than 2.5 of their own spacings their factors are a poor account of the finer ones.
 */
static const double REACH = 1.7, NEAR_SPACINGS = 2.5;
/* A level pays when a row of the finer points would keep at least so many factors. */
static const double WORTHWHILE_FACTORS = 600;
enum { POINTS_MIN = 1000, FORCED_POINTS_MIN = 12 };

/* ---- one level ---- */

/* Distance of neighbours, were the points a hexagonal lattice. */
static double point_spacing(const parian_vertex_frame *frame)
{
    double area = 0;
    for (uint32_t v = 0; v < frame->points.count; v++) {
        area += frame->area[v];
    }
    return sqrt(area / frame->points.count * 2 / sqrt(3));
}

static bool has_blend(const parian_body *body)
{
    parian_local_form form = body->local_form;
    return form == PARIAN_LOCAL_REBUILT || form == PARIAN_LOCAL_F16 || form == PARIAN_LOCAL_U8;
}

static parian_result mark_finer(const parian_env *env, const parian_body *body,
                                const parian_level *below, parian_level *level)
{
    double reach = NEAR_SPACINGS * point_spacing(&level->maker.factors.frame);
    parian_result result =
        parian_bits_create(env, (size_t)level->coarse.count * level->coarse.count, &level->finer);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_pairs_add_near(body, &level->coarse, reach, &level->finer);
    if (below) {
        parian_pairs_add_lifted(&level->coarse, &below->finer, &level->finer);
    } else if (has_blend(body)) {
        result = parian_pairs_add_windows(env, body, &level->coarse, &level->finer);
    }
    level->maker.finer = &level->finer;
    return result;
}

static parian_result make_level(const parian_env *env, const parian_body *body,
                                const parian_row_maker *vertices, parian_levels *levels)
{
    uint32_t number = levels->count;
    parian_level *level = &levels->level[number], *below = number ? level - 1 : NULL;
    const parian_row_maker *finer = below ? &below->maker : vertices;
    parian_result result =
        parian_coarse_make(env, body, &vertices->factors.frame, below ? below->coarse.vertex : NULL,
                           finer->factors.frame.points.count,
                           REACH * point_spacing(&finer->factors.frame), &level->coarse);
    levels->count++;
    if (result == PARIAN_OK) {
        level->maker.threshold = vertices->threshold;
        result = parian_coarse_maker_make(env, &level->coarse, &vertices->factors, &finer->factors,
                                          &level->maker.factors);
    }
    return result == PARIAN_OK ? mark_finer(env, body, below, level) : result;
}

/* ---- all levels ---- */

static void link_levels(parian_levels *levels)
{
    for (uint32_t l = 0; l < levels->count; l++) {
        parian_far *lower = l ? &levels->level[l - 1].far : &levels->far;
        for (uint32_t k = l; k < levels->count; k++) {
            lower->coarse[lower->count] = &levels->level[k].coarse;
            lower->factors[lower->count++] = &levels->level[k].factors;
        }
    }
    for (uint32_t l = 0; l + 1 < levels->count; l++) {
        levels->level[l].maker.far = &levels->level[l].far;
    }
}

static void explain(const parian_row_maker *vertices, const parian_levels *levels,
                    double factors_per_row, char *reason, size_t size)
{
    uint32_t points = vertices->factors.frame.points.count;
    if (levels->count > 0) {
        snprintf(reason, size,
                 "%u coarse levels, the last of %u points: the rows of %u vertices alone would "
                 "keep %.0f factors each",
                 levels->count, levels->level[levels->count - 1].coarse.count, points,
                 factors_per_row);
    } else if (factors_per_row < 0) {
        snprintf(reason, size, "no coarse level: %u vertices, at least %d are worth it", points,
                 POINTS_MIN);
    } else {
        snprintf(reason, size,
                 "no coarse level: the rows of %u vertices keep %.0f factors each, at least %.0f "
                 "are worth it",
                 points, factors_per_row, WORTHWHILE_FACTORS);
    }
}

parian_result parian_levels_choose(const parian_env *env, const parian_body *body,
                                   const parian_row_maker *base, bool forced, parian_levels *levels,
                                   char *reason, size_t reason_size)
{
    const parian_row_maker *finest = base;
    parian_result result = PARIAN_OK;
    double factors_per_row = -1, factors = 0;
    memset(levels, 0, sizeof *levels);
    while (result == PARIAN_OK && levels->count < PARIAN_LEVELS_MAX) {
        bool must = forced && levels->count == 0;
        if (finest->factors.frame.points.count < (must ? FORCED_POINTS_MIN : POINTS_MIN)) {
            break;
        }
        result = parian_rows_sample(env, finest, &factors);
        factors_per_row = levels->count ? factors_per_row : factors;
        if (result == PARIAN_OK && !must && factors < WORTHWHILE_FACTORS) {
            break;
        }
        if (result == PARIAN_OK) {
            result = make_level(env, body, base, levels);
            finest = &levels->level[levels->count - 1].maker;
        }
    }
    link_levels(levels);
    explain(base, levels, factors_per_row, reason, reason_size);
    return result;
}

parian_result parian_levels_make(const parian_env *env, double begin, double end,
                                 parian_levels *levels)
{
    parian_result result = PARIAN_OK;
    for (uint32_t l = levels->count; l-- > 0 && result == PARIAN_OK;) {
        parian_rows_report unused;
        double share = (end - begin) / levels->count;
        result = parian_rows_to_operator(env, &levels->level[l].maker, end - share * (l + 1),
                                         end - share * l, &levels->level[l].factors, &unused);
    }
    return result;
}

/* ---- into the body ---- */

/* Register of a level's flux; its radiosity follows. The vertices' are 0 and 1. */
static uint32_t flux_register(uint32_t level)
{
    return 2 * level;
}

static void store_operator(parian_operator *op, uint32_t source, uint32_t target, parian_body *body)
{
    op->source_register = source;
    op->target_register = target;
    body->operators[body->operator_count++] = *op;
    memset(op, 0, sizeof *op);
}

parian_result parian_levels_store(const parian_env *env, parian_operator *near,
                                  parian_levels *levels, parian_body *body)
{
    parian_result result = PARIAN_OK;
    for (uint32_t o = 0; o < body->operator_count; o++) {
        parian_operator_free(env, &body->operators[o]);
    }
    body->operator_count = 0;
    store_operator(near, flux_register(0), flux_register(0) + 1, body);
    for (uint32_t l = 0; l < levels->count && result == PARIAN_OK; l++) {
        parian_operator down;
        result = parian_coarse_down(env, &levels->level[l].coarse, &down);
        if (result == PARIAN_OK) {
            store_operator(&down, flux_register(l), flux_register(l + 1), body);
        }
    }
    for (uint32_t l = levels->count; l-- > 0 && result == PARIAN_OK;) {
        parian_operator up;
        uint32_t flux = flux_register(l + 1);
        store_operator(&levels->level[l].factors, flux, flux + 1, body);
        result = parian_coarse_up(env, &levels->level[l].coarse, &up);
        if (result == PARIAN_OK) {
            store_operator(&up, flux + 1, flux_register(l) + 1, body);
        }
    }
    return result;
}

void parian_levels_free(const parian_env *env, parian_levels *levels)
{
    for (uint32_t l = 0; l < levels->count; l++) {
        parian_level *level = &levels->level[l];
        parian_coarse_maker_free(env, &level->maker.factors);
        parian_coarse_free(env, &level->coarse);
        parian_bits_free(env, &level->finer);
        parian_operator_free(env, &level->factors);
    }
    memset(levels, 0, sizeof *levels);
}
