/* global.c - the global stage: throughput factors between the transfer vertices, the near ones
 * alone where coarse levels carry the rest.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/stages/global_levels.h"
#include "core/memory.h"

/* With coarse levels what is dropped has both signs and averages out: twice the share costs no
 * more error than of factors themselves, up to 0.004 (docs/transfer.md). */
static const double FAR_THRESHOLD = 2, FAR_THRESHOLD_MAX = 0.004;

static double far_threshold(double threshold)
{
    return fmax(threshold, fmin(FAR_THRESHOLD * threshold, FAR_THRESHOLD_MAX));
}

/* Whether coarse levels may be set at all; if not, why. */
static const char *objection(const parian_global_desc *desc, const parian_row_maker *maker,
                             const parian_body *body)
{
    if (desc && desc->hierarchy == PARIAN_HIERARCHY_OFF) {
        return "no coarse level, as asked";
    }
    if (body->paper_form) {
        return "no coarse level: the paper's form has none";
    }
    if (maker->threshold_absolute > 0 || maker->threshold <= 0) {
        return "no coarse level: it takes a threshold by share";
    }
    return NULL;
}

static parian_result choose_levels(const parian_env *env, const parian_global_desc *desc,
                                   const parian_body *body, parian_row_maker *maker,
                                   parian_levels *levels, parian_global_report *report)
{
    const char *why_not = objection(desc, maker, body);
    bool forced = desc && desc->hierarchy == PARIAN_HIERARCHY_ON;
    parian_result result = PARIAN_OK;
    memset(levels, 0, sizeof *levels);
    if (why_not) {
        snprintf(report->hierarchy, sizeof report->hierarchy, "%s", why_not);
    } else {
        result = parian_levels_choose(env, body, maker, forced, levels, report->hierarchy,
                                      sizeof report->hierarchy);
    }
    for (uint32_t l = 0; l < levels->count; l++) {
        levels->level[l].maker.threshold = far_threshold(maker->threshold);
        report->level_points[l] = levels->level[l].coarse.count;
    }
    if (levels->count > 0) {
        maker->threshold = far_threshold(maker->threshold);
        maker->far = &levels->far;
    }
    report->level_count = levels->count;
    return result;
}

static void fill_report(const parian_body *body, const parian_rows_report *rows,
                        parian_global_report *report)
{
    double vertices = body->vertex_count;
    report->factor_count = 0;
    for (uint32_t o = 0; o < body->operator_count; o++) {
        report->factor_count += body->operators[o].factor_total;
    }
    report->kept_share = (double)report->factor_count / (vertices * vertices);
    report->lost_mean = rows->lost_mean;
    report->lost_max = rows->lost_max;
    memcpy(report->row_sum_min, rows->sum_min, sizeof rows->sum_min);
    memcpy(report->row_sum_max, rows->sum_max, sizeof rows->sum_max);
}

parian_result parian_stage_global(const parian_env *env, const parian_global_desc *desc,
                                  parian_body *body, parian_global_report *report)
{
    parian_global_report unused;
    parian_row_maker maker;
    parian_levels levels = {0};
    parian_operator near = {0};
    parian_rows_report rows;
    report = report ? report : &unused;
    memset(report, 0, sizeof *report);
    if (!body->has_global) {
        return PARIAN_OK;
    }
    parian_result result = parian_row_maker_make(env, desc, body, &maker);
    if (result == PARIAN_OK) {
        result = choose_levels(env, desc, body, &maker, &levels, report);
    }
    if (result == PARIAN_OK) {
        result = parian_levels_make(env, 0.1, 0.3, &levels);
    }
    if (result == PARIAN_OK) {
        result = parian_rows_to_operator(env, &maker, levels.count ? 0.3 : 0.1, 1, &near, &rows);
    }
    if (result == PARIAN_OK) {
        result = parian_levels_store(env, &near, &levels, body);
    }
    if (result == PARIAN_OK) {
        fill_report(body, &rows, report);
    }
    parian_operator_free(env, &near);
    parian_levels_free(env, &levels);
    parian_row_maker_free(env, &maker);
    return result;
}
