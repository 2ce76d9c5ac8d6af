/* path_outcome.h - traces a scene of path_case.h and holds what came out: for the tests of path
 * tracing.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_PATH_OUTCOME_H
#define PARIAN_TEST_PATH_OUTCOME_H

#include <stdio.h>

#include "support/path_case.h"

static const double MM = 1e-3;

typedef struct outcome {
    size_t count;
    parian_reference_result result;
    parian_receivers receivers;
} outcome;

static inline void release(outcome *o)
{
    parian_reference_result_free(test_env(2), &o->result);
    parian_receivers_free(test_env(2), &o->receivers);
}

/* Trace receivers spread over a scene, which is freed. */
static inline outcome trace(parian_reference_scene *scene, size_t count,
                            const parian_path_desc *desc)
{
    outcome o = {.count = count};
    path_case_spread(test_env(2), scene, count, &o.receivers);
    assert_int_equal(parian_reference_path(test_env(2), scene, &o.receivers, desc, &o.result),
                     PARIAN_OK);
    parian_reference_scene_free(test_env(2), scene);
    return o;
}

static inline outcome trace_sphere(double radius, unsigned cuts, const parian_medium *medium,
                                   const parian_light *light, size_t count,
                                   const parian_path_desc *desc)
{
    parian_mesh mesh = {0};
    parian_reference_scene scene;
    assert_int_equal(test_sphere(test_env(2), radius, cuts, &mesh), PARIAN_OK);
    path_case_scene(test_env(2), &mesh, medium, light, light ? 1 : 0, &scene);
    return trace(&scene, count, desc);
}

static inline double mean_b(const outcome *o, int channel)
{
    return path_case_mean((const double(*)[3])o->result.radiosity, o->count, channel);
}

static inline double mean_unscattered(const outcome *o, int channel)
{
    return path_case_mean((const double(*)[3])o->result.unscattered, o->count, channel);
}

static inline void assert_near(const char *what, double value, double expected, double tolerance)
{
    print_message("%-44s %.6g, expected %.6g, off by %.2g of %.2g\n", what, value, expected,
                  fabs(value - expected), tolerance);
    assert_true(fabs(value - expected) <= tolerance);
}

/* in + added = out + absorbed + removed + lost, and next to nothing is lost. */
static inline void assert_books(const parian_reference_result *r)
{
    for (int c = 0; c < 3; c++) {
        double gap = r->in[c] + r->roulette_added[c] - r->out[c] - r->absorbed[c] -
                     r->roulette_removed[c] - r->lost[c];
        assert_true(r->in[c] > 0);
        assert_true(fabs(gap) <= 1e-6 * r->in[c]);
        assert_true(r->lost[c] <= 1e-5 * r->in[c]);
    }
}

#endif
