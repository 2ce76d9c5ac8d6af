/* test_thickness.c - thickness of plates, balls and open sheets in mean free paths.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <string.h>

#include "bake/stages/thickness.h"
#include "core/memory.h"

static const double MM = 1e-3;
/* Mean free path of 1 mm in the clearest channel, green. */
static const parian_medium MEDIUM = {
    .sigma_s_prime = {4000, 900, 2000}, .sigma_a = {100, 100, 100}, .eta = 1.4};

static void body_of(const parian_mesh *mesh, parian_body *body)
{
    *body = (parian_body){.medium = MEDIUM,
                          .vertex_count = mesh->vertex_count,
                          .triangle_count = mesh->triangle_count};
    assert_true(PARIAN_NEW(NULL, body->vertex_position, mesh->vertex_count));
    assert_true(PARIAN_NEW(NULL, body->triangle, mesh->triangle_count));
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            body->vertex_position[v][k] = (float)mesh->position[v][k];
        }
    }
    memcpy(body->triangle, mesh->triangle, mesh->triangle_count * sizeof *mesh->triangle);
}

static parian_thickness_report measure(parian_mesh *mesh)
{
    parian_body body;
    parian_thickness_report report;
    body_of(mesh, &body);
    assert_int_equal(parian_stage_thickness(test_env(2), &body, &report), PARIAN_OK);
    assert_true(fabs(report.flight_m - MM) < 1e-9);
    parian_body_free(NULL, &body);
    parian_mesh_free(NULL, mesh);
    return report;
}

/* Nearly all of a plate of 60 x 60 x t mm is t thick; its rims look across 60 mm. Floats: 1e-5. */
static void plates(void **state)
{
    (void)state;
    const struct {
        double thickness, share;
    } plate[] = {{3.9, 1}, {4.1, 0}};
    for (int i = 0; i < 2; i++) {
        parian_mesh mesh = {0};
        double t = plate[i].thickness, rims = 4 * t * 60 / (4 * t * 60 + 2 * 60 * 60);
        assert_int_equal(test_box(NULL, 60 * MM, 60 * MM, t * MM, 12, &mesh), PARIAN_OK);
        parian_thickness_report r = measure(&mesh);
        assert_true(fabs(r.thin_m - t * MM) < 1e-5 * MM);
        assert_true(fabs(r.median_m - t * MM) < 1e-5 * MM);
        assert_true(fabs(r.thin_share - plate[i].share * (1 - rims)) < 1e-5);
    }
}

/* A ball is 2 R thick everywhere; its facets' middles and their far sides lie up to 1 % further in.
 */
static void ball(void **state)
{
    (void)state;
    parian_mesh mesh = {0};
    assert_int_equal(test_sphere(NULL, 10 * MM, 16, &mesh), PARIAN_OK);
    parian_thickness_report r = measure(&mesh);
    assert_true(fabs(r.median_m - 20 * MM) < 0.2 * MM);
    assert_true(fabs(r.thin_m - 20 * MM) < 0.2 * MM);
    assert_true(r.thin_share == 0);
}

/* An open sheet has no other side; one without area has nothing to measure. */
static void open_sheets(void **state)
{
    (void)state;
    for (int flat = 0; flat < 2; flat++) {
        parian_mesh mesh = {0};
        assert_true(PARIAN_NEW0(NULL, mesh.position, 3) && PARIAN_NEW0(NULL, mesh.triangle, 1));
        mesh.vertex_count = 3;
        mesh.triangle_count = 1;
        mesh.position[1][0] = MM;
        mesh.position[2][flat ? 0 : 1] = MM;
        mesh.triangle[0][1] = 1;
        mesh.triangle[0][2] = 2;
        parian_thickness_report r = measure(&mesh);
        assert_true(isinf(r.median_m) && r.thin_share == 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plates),
        cmocka_unit_test(ball),
        cmocka_unit_test(open_sheets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
