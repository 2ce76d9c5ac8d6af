/* test_transport_truth.c - exact transport of a given irradiance against sums in double precision.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include "support/transport_case.h"
#include "tests/measure/transport_truth.h"

static const parian_medium MARBLE = {.name = "marble",
                                     .sigma_s_prime = {2190, 2620, 3000},
                                     .sigma_a = {2.1, 4.1, 7.1},
                                     .eta = 1.5,
                                     .reduced_only = true};

/* Texels of a plane under a checkerboard; the tables of the fast sum hold 1e-5, near texels are
 * doubles. */
static void test_one_body(void **state)
{
    (void)state;
    enum { RECEIVERS = 40 };
    const parian_env *env = test_env(0);
    parian_body body;
    parian_dipole dipole[3];
    float(*e)[3];
    uint32_t texel[RECEIVERS];
    double area[RECEIVERS], got[RECEIVERS][3];
    case_plane(env, 6, 8, 2e-4, &body);
    body.medium = MARBLE;
    assert_true(PARIAN_NEW(env, e, body.texel_count));
    case_illuminate(&body, CASE_CHECKER, 48 * 2e-4, e);
    for (int c = 0; c < 3; c++) {
        dipole[c] = parian_dipole_make(&body.medium, c, false);
    }
    for (uint32_t k = 0; k < RECEIVERS; k++) {
        texel[k] = (k * 577) % body.texel_count;
        area[k] = 1;
    }
    const parian_texel_choice choice = {RECEIVERS, texel, area};
    assert_int_equal(parian_transport_truth(env, &body, 1, (const float(*)[3])e, &choice, got),
                     PARIAN_OK);
    for (uint32_t k = 0; k < RECEIVERS; k++) {
        double want[3];
        case_reference(&body, dipole, texel[k], (const float(*)[3])e, want);
        for (int c = 0; c < 3; c++) {
            assert_true(want[c] > 0 && fabs(got[k][c] / want[c] - 1) < 1e-4);
        }
    }
    parian_free(env, e);
    parian_body_free(env, &body);
}

/* Two bodies do not light each other, and receivers of both are served by one call. */
static void test_two_bodies(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    parian_body body[2];
    float(*e)[3];
    double both[2][3], alone[1][3];
    case_plane(env, 3, 8, 2e-4, &body[0]);
    case_plane(env, 3, 8, 2e-4, &body[1]);
    body[0].medium = body[1].medium = MARBLE;
    uint32_t n = body[0].texel_count;
    assert_true(PARIAN_NEW0(env, e, 2 * n));
    for (uint32_t i = 0; i < n; i++) {
        e[n + i][0] = e[n + i][1] = e[n + i][2] = 2; /* the second alone is lit */
    }
    uint32_t texel[2] = {100, n + 100}, first = 100;
    double area[2] = {1, 1};
    const parian_texel_choice choice = {2, texel, area}, single = {1, &first, area};
    assert_int_equal(parian_transport_truth(env, body, 2, (const float(*)[3])e, &choice, both),
                     PARIAN_OK);
    assert_int_equal(
        parian_transport_truth(env, &body[1], 1, (const float(*)[3])(e + n), &single, alone),
        PARIAN_OK);
    assert_true(both[0][0] == 0 && both[1][2] == alone[0][2] && alone[0][2] > 0);
    parian_free(env, e);
    parian_body_free(env, &body[0]);
    parian_body_free(env, &body[1]);
}

/* With the gradient form a near texel's share follows the receiver's normal: one lit texel, a
 * neighbour that is turned by 0, 30 and 60 degrees, against the value between their centres. 5 %:
 * the texel is half a z_r wide. */
static void test_gradient_form_near_by(void **state)
{
    (void)state;
    const parian_env *env = test_env(0);
    parian_body body;
    float(*e)[3];
    case_plane(env, 6, 8, 2e-4, &body);
    body.medium = MARBLE;
    body.bssrdf = PARIAN_BSSRDF_DIPOLE_FLUX;
    assert_true(PARIAN_NEW0(env, e, body.texel_count));
    const uint32_t from = body.texel_count / 2;
    uint32_t to = from;
    double nearest = INFINITY;
    for (uint32_t i = 0; i < body.texel_count; i++) {
        double dx = body.texel_position[i][0] - body.texel_position[from][0];
        double dy = body.texel_position[i][1] - body.texel_position[from][1];
        if (i != from && dx > fabs(dy) && hypot(dx - 4e-4, dy) < nearest) {
            nearest = hypot(dx - 4e-4, dy);
            to = i;
        }
    }
    e[from][0] = e[from][1] = e[from][2] = 1;
    for (int turn = 0; turn < 3; turn++) {
        double x_i[3], n_i[3], x_o[3], n_o[3], got[1][3], area = 1;
        const parian_texel_choice choice = {1, &to, &area};
        body.texel_normal[to][0] = (float)sin(turn * PARIAN_PI / 6);
        body.texel_normal[to][1] = 0;
        body.texel_normal[to][2] = (float)cos(turn * PARIAN_PI / 6);
        for (int k = 0; k < 3; k++) {
            x_i[k] = body.texel_position[from][k];
            n_i[k] = body.texel_normal[from][k];
            x_o[k] = body.texel_position[to][k];
            n_o[k] = body.texel_normal[to][k];
        }
        assert_int_equal(parian_transport_truth(env, &body, 1, (const float(*)[3])e, &choice, got),
                         PARIAN_OK);
        for (int c = 0; c < 3; c++) {
            parian_dipole dipole = parian_dipole_make(&body.medium, c, false);
            double want = body.texel_area[from] * parian_dipole_flux(&dipole, x_i, n_i, x_o, n_o);
            print_message("turned by %d, channel %d: %g, expected %g\n", 30 * turn, c, got[0][c],
                          want);
            assert_true(want > 0 && fabs(got[0][c] / want - 1) < 0.05);
        }
    }
    parian_free(env, e);
    parian_body_free(env, &body);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_body),
                                       cmocka_unit_test(test_two_bodies),
                                       cmocka_unit_test(test_gradient_form_near_by)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
