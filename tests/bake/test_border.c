/* test_border.c - neighbourhoods of texels: symmetry, brute force, and smooth sums across seams.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdlib.h>

#include "bake/stages/atlas.h"
#include "bake/stages/texels.h"
#include "support/atlas_case.h"

static const double pi = 3.14159265358979323846;

static double make_texels(parian_mesh *mesh, uint32_t side, uint32_t width, parian_body *body)
{
    parian_atlas_desc desc = {.atlas_size = side};
    parian_atlas_report report;
    assert_int_equal(atlas_case_body(NULL, mesh, body), PARIAN_OK);
    body->kernel_width = width;
    assert_int_equal(parian_stage_atlas(NULL, &desc, body, &report), PARIAN_OK);
    assert_int_equal(parian_stage_texels(test_env(2), body), PARIAN_OK);
    parian_mesh_free(NULL, mesh);
    return report.texel_edge_m;
}

static uint32_t chart_of(const parian_body *body, uint32_t texel)
{
    return body->triangle_chart[body->texel_triangle[texel]];
}

static int compare(const void *left, const void *right)
{
    uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
    return a < b ? -1 : a > b;
}

/* i is in W(o), whichever way W(o) is given. */
static bool is_neighbour(const parian_body *body, uint32_t i, uint32_t o)
{
    uint32_t border = body->texel_border[o];
    if (border != PARIAN_NO_BORDER) {
        uint32_t begin = body->border_offset[border], end = body->border_offset[border + 1];
        return bsearch(&i, body->border_neighbour + begin, end - begin, 4, compare) != NULL;
    }
    int side = (int)body->atlas_size, half = (int)(body->kernel_width / 2);
    int a = (int)body->texel_index[i], b = (int)body->texel_index[o];
    return abs(a % side - b % side) <= half && abs(a / side - b / side) <= half;
}

/* The neighbours of a texel; their number. */
static uint32_t list(const parian_body *body, uint32_t o, uint32_t *out)
{
    uint32_t border = body->texel_border[o], count = 0;
    if (border != PARIAN_NO_BORDER) {
        for (uint32_t k = body->border_offset[border]; k < body->border_offset[border + 1]; k++) {
            out[count++] = body->border_neighbour[k];
        }
        return count;
    }
    int side = (int)body->atlas_size, half = (int)(body->kernel_width / 2);
    int u = (int)body->texel_index[o] % side, v = (int)body->texel_index[o] / side;
    for (int y = v - half; y <= v + half; y++) {
        for (int x = u - half; x <= u + half; x++) {
            assert_true(x >= 0 && y >= 0 && x < side && y < side);
            out[count++] = body->texel_at[y * side + x];
            /* Every texel of an interior window is owned, and of the same chart. */
            assert_true(out[count - 1] != 0xFFFFFFFFu);
            assert_int_equal(chart_of(body, out[count - 1]), chart_of(body, o));
        }
    }
    return count;
}

static void check_symmetry(const parian_body *body)
{
    uint32_t *neighbours = malloc(body->texel_count * sizeof *neighbours);
    for (uint32_t o = 0; o < body->texel_count; o++) {
        uint32_t count = list(body, o, neighbours);
        bool self = false;
        for (uint32_t k = 0; k < count; k++) {
            assert_true(k == 0 || neighbours[k] > neighbours[k - 1]);
            assert_true(is_neighbour(body, o, neighbours[k]));
            self = self || neighbours[k] == o;
        }
        assert_true(self);
    }
    free(neighbours);
}

static void lists_are_symmetric(void **state)
{
    (void)state;
    const uint32_t widths[] = {3, 7, 15};
    for (int shape = 0; shape < 3; shape++) {
        for (int w = 0; w < 3; w++) {
            parian_mesh mesh;
            parian_body body;
            parian_result made = shape == 0   ? test_sphere(NULL, 0.025, 16, &mesh)
                                 : shape == 1 ? test_box(NULL, 0.05, 0.04, 0.0005, 10, &mesh)
                                              : test_plane(NULL, 0.05, 6, &mesh);
            assert_int_equal(made, PARIAN_OK);
            make_texels(&mesh, 128, widths[w], &body);
            check_symmetry(&body);
            assert_true(body.border_count > 0);
            /* Every texel of the thin box sees its other side. */
            assert_true(shape == 1 || body.border_count < body.texel_count);
            parian_body_free(NULL, &body);
        }
    }
}

/* The rule of border.c for two border texels, without its grid. */
static bool near_by_rule(const parian_body *body, uint32_t i, uint32_t o, double radius)
{
    if (chart_of(body, i) == chart_of(body, o)) {
        int side = (int)body->atlas_size, half = (int)(body->kernel_width / 2);
        int a = (int)body->texel_index[i], b = (int)body->texel_index[o];
        return abs(a % side - b % side) <= half && abs(a / side - b / side) <= half;
    }
    double away2 = 0.0;
    for (int d = 0; d < 3; d++) {
        double x = (double)body->texel_position[i][d] - (double)body->texel_position[o][d];
        away2 += x * x;
    }
    return away2 <= radius * radius;
}

static void lists_agree_with_brute_force(void **state)
{
    (void)state;
    for (int shape = 0; shape < 2; shape++) {
        parian_mesh mesh;
        parian_body body;
        assert_int_equal(shape == 0 ? test_sphere(NULL, 0.025, 8, &mesh)
                                    : test_box(NULL, 0.05, 0.03, 0.002, 4, &mesh),
                         PARIAN_OK);
        make_texels(&mesh, 64, 7, &body);
        /* The mean texel is the surface over the covered part of the atlas. */
        double area = atlas_case_area(&body), flat = 0.0;
        for (uint32_t t = 0; t < body.triangle_count; t++) {
            float(*uv)[2] = body.corner_uv[t];
            flat += 0.5 * (((double)uv[1][0] - uv[0][0]) * ((double)uv[2][1] - uv[0][1]) -
                           ((double)uv[1][1] - uv[0][1]) * ((double)uv[2][0] - uv[0][0]));
        }
        double radius = 7.0 * sqrt(area / flat / pi);
        uint64_t disputed = 0, pairs = 0;
        for (uint32_t a = 0; a < body.border_count; a++) {
            for (uint32_t b = 0; b < body.border_count; b++) {
                uint32_t i = body.border_texel[a], o = body.border_texel[b];
                bool expected = near_by_rule(&body, i, o, radius);
                disputed += expected != is_neighbour(&body, i, o);
                pairs += expected;
            }
        }
        /* Pairs at the radius itself, to a rounding, may fall either way. */
        assert_true(pairs > 1000 && disputed <= pairs / 1000);
        parian_body_free(NULL, &body);
    }
}

/* Through a wall far thinner than a texel every texel, also in the middle of its chart, lists both
 * sides; through one thicker than a window reaches, none does. */
static void lists_reach_through_thin_walls(void **state)
{
    (void)state;
    for (int thick = 0; thick < 2; thick++) {
        parian_mesh mesh;
        parian_body body;
        assert_int_equal(test_box(NULL, 0.05, 0.05, thick ? 0.02 : 1e-4, 6, &mesh), PARIAN_OK);
        make_texels(&mesh, 128, 7, &body);
        uint32_t through = 0;
        for (uint32_t b = 0; b < body.border_count; b++) {
            const float *n = body.texel_normal[body.border_texel[b]];
            bool opposite = false;
            for (uint32_t k = body.border_offset[b]; k < body.border_offset[b + 1]; k++) {
                const float *m = body.texel_normal[body.border_neighbour[k]];
                opposite |= n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < -0.9f;
            }
            through += opposite;
        }
        if (thick) {
            assert_int_equal(through, 0);
        } else {
            assert_true(through > 0.95 * body.texel_count);
        }
        check_symmetry(&body);
        parian_body_free(NULL, &body);
    }
}

/* On a sphere the area within the chord d of a point is pi d^2, so a function (1 - d^2/r^2)^2 of
 * the distance integrates to pi r^2 / 3, for every texel, seam or none. */
static void sums_are_the_same_across_seams(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    assert_int_equal(test_sphere(NULL, 0.025, 44, &mesh), PARIAN_OK);
    double edge = make_texels(&mesh, 512, 7, &body), radius = 3.0 * edge;
    uint32_t neighbours[4096];
    double mean[2] = {0, 0}, squares[2] = {0, 0}, worst[2] = {0, 0};
    uint32_t number[2] = {0, 0};
    for (uint32_t o = 0; o < body.texel_count; o++) {
        uint32_t count = list(&body, o, neighbours);
        int kind = body.texel_border[o] != PARIAN_NO_BORDER;
        double sum = 0.0;
        for (uint32_t k = 0; k < count; k++) {
            double away2 = 0.0;
            for (int d = 0; d < 3; d++) {
                double x = (double)body.texel_position[neighbours[k]][d] -
                           (double)body.texel_position[o][d];
                away2 += x * x;
            }
            double f = 1.0 - away2 / (radius * radius);
            sum += f > 0.0 ? (double)body.texel_area[neighbours[k]] * f * f : 0.0;
        }
        double relative = sum / (pi * radius * radius / 3.0) - 1.0;
        mean[kind] += relative;
        squares[kind] += relative * relative;
        worst[kind] = fmax(worst[kind], fabs(relative));
        number[kind]++;
    }
    for (int kind = 0; kind < 2; kind++) {
        print_message("%s texels: %u, mean %+.4f, rms %.4f, largest %.4f\n",
                      kind ? "border" : "interior", number[kind], mean[kind] / number[kind],
                      sqrt(squares[kind] / number[kind]), worst[kind]);
    }
    /* Nine texels across the function: its quadrature over a regular grid is good to a per cent,
     * over the irregular texels of a seam to a few. A neighbour missing at a seam costs up to half
     * the sum. */
    assert_true(fabs(mean[0] / number[0]) < 0.005 && fabs(mean[1] / number[1]) < 0.01);
    assert_true(sqrt(squares[0] / number[0]) < 0.01 && sqrt(squares[1] / number[1]) < 0.02);
    assert_true(worst[0] < 0.03 && worst[1] < 0.10);
    parian_body_free(NULL, &body);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_are_symmetric),
        cmocka_unit_test(lists_agree_with_brute_force),
        cmocka_unit_test(lists_reach_through_thin_walls),
        cmocka_unit_test(sums_are_the_same_across_seams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
