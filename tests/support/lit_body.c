/* lit_body.c - bodies with texels on every triangle, made by hand from any mesh.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/lit_body.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"
#include "support/test_support.h"

enum { MARGIN = 1 };

/* A number in [0, 1) that depends on its index alone. */
static double noise(uint64_t index)
{
    uint64_t x = index + 0x9E3779B97F4A7C15ull;
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ x >> 27) * 0x94D049BB133111EBull;
    return (double)((x ^ x >> 31) >> 11) * 0x1p-53;
}

static void set_medium(parian_medium *medium)
{
    snprintf(medium->name, sizeof medium->name, "Test");
    snprintf(medium->source, sizeof medium->source, "made up for tests");
    for (int c = 0; c < 3; c++) {
        medium->sigma_s_prime[c] = 2000.0 + 300.0 * c;
        medium->sigma_a[c] = 2.0 + 3.0 * c;
    }
    medium->eta = 1.5;
    medium->reduced_only = true;
}

static bool set_surface(const parian_env *env, parian_body *body, const parian_mesh *mesh,
                        uint32_t cut, uint32_t per_row)
{
    static const float corner[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    body->vertex_count = mesh->vertex_count;
    body->triangle_count = mesh->triangle_count;
    body->chart_count = mesh->triangle_count;
    if (!PARIAN_NEW(env, body->vertex_position, mesh->vertex_count) ||
        !PARIAN_NEW(env, body->triangle, mesh->triangle_count) ||
        !PARIAN_NEW(env, body->corner_normal, mesh->triangle_count) ||
        !PARIAN_NEW(env, body->corner_uv, mesh->triangle_count) ||
        !PARIAN_NEW(env, body->triangle_chart, mesh->triangle_count)) {
        return false;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int d = 0; d < 3; d++) {
            body->vertex_position[v][d] = (float)mesh->position[v][d];
        }
    }
    memcpy(body->triangle, mesh->triangle, mesh->triangle_count * sizeof *body->triangle);
    memcpy(body->corner_normal, mesh->corner_normal,
           mesh->triangle_count * sizeof *body->corner_normal);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        body->triangle_chart[t] = t;
        for (int k = 0; k < 3; k++) {
            uint32_t cell[2] = {t % per_row, t / per_row};
            for (int axis = 0; axis < 2; axis++) {
                body->corner_uv[t][k][axis] = (float)(cell[axis] * (cut + 2 * MARGIN) + MARGIN) +
                                              corner[k][axis] * (float)cut;
            }
        }
    }
    return true;
}

static double triangle_area(const parian_mesh *mesh, uint32_t t)
{
    double u[3], v[3], n[3];
    for (int d = 0; d < 3; d++) {
        u[d] = mesh->position[mesh->triangle[t][1]][d] - mesh->position[mesh->triangle[t][0]][d];
        v[d] = mesh->position[mesh->triangle[t][2]][d] - mesh->position[mesh->triangle[t][0]][d];
    }
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Texel (i, j) of a triangle: whole inside, half along the third edge. */
static void set_texel(parian_body *body, const parian_mesh *mesh, uint32_t texel, uint32_t t,
                      uint32_t i, uint32_t j, uint32_t cut)
{
    bool half = i + j == cut - 1;
    double at = half ? 1.0 / 3.0 : 0.5;
    double b1 = (i + at) / cut, b2 = (j + at) / cut;
    body->texel_triangle[texel] = t;
    body->texel_barycentric[texel][0] = (float)(1.0 - b1 - b2);
    body->texel_barycentric[texel][1] = (float)b1;
    body->texel_area[texel] =
        (float)(triangle_area(mesh, t) * (half ? 1.0 : 2.0) / ((double)cut * cut));
}

static bool set_texels(const parian_env *env, parian_body *body, const parian_mesh *mesh,
                       uint32_t cut, uint32_t per_row)
{
    uint32_t count = mesh->triangle_count * cut * (cut + 1) / 2, texel = 0, side = cut + 2 * MARGIN;
    body->atlas_size = per_row * side;
    body->texel_count = count;
    if (!PARIAN_NEW(env, body->texel_index, count) ||
        !PARIAN_NEW(env, body->texel_triangle, count) ||
        !PARIAN_NEW(env, body->texel_barycentric, count) ||
        !PARIAN_NEW(env, body->texel_area, count)) {
        return false;
    }
    for (uint32_t index = 0; index < body->atlas_size * body->atlas_size; index++) {
        uint32_t u = index % body->atlas_size, v = index / body->atlas_size;
        uint32_t t = v / side * per_row + u / side;
        uint32_t i = u % side - MARGIN, j = v % side - MARGIN; /* wraps to huge in the margin */
        if (t < mesh->triangle_count && i < cut && j < cut && i + j < cut) {
            body->texel_index[texel] = index;
            set_texel(body, mesh, texel++, t, i, j, cut);
        }
    }
    return texel == count;
}

/* Margins left of a chart take the mean of the two texels beside them. */
static bool set_gutter(const parian_env *env, parian_body *body)
{
    uint32_t count = 0;
    if (!PARIAN_NEW(env, body->gutter_index, body->texel_count) ||
        !PARIAN_NEW0(env, body->gutter_source, body->texel_count) ||
        !PARIAN_NEW0(env, body->gutter_weight, body->texel_count)) {
        return false;
    }
    for (uint32_t t = 0; t + 1 < body->texel_count; t++) {
        uint32_t index = body->texel_index[t];
        bool first = t == 0 || body->texel_index[t - 1] + 1 != index;
        bool second = body->texel_index[t + 1] == index + 1;
        if (first && second) {
            body->gutter_index[count] = index - 1;
            body->gutter_source[count][0] = t;
            body->gutter_source[count][1] = t + 1;
            body->gutter_weight[count][0] = 0.75f;
            body->gutter_weight[count++][1] = 0.25f;
        }
    }
    body->gutter_count = count;
    return true;
}

static bool is_owned(const uint8_t *owned, uint32_t size, uint32_t index, uint32_t half)
{
    uint32_t u = index % size, v = index / size;
    if (u < half || v < half || u + half >= size || v + half >= size) {
        return false;
    }
    for (uint32_t y = v - half; y <= v + half; y++) {
        for (uint32_t x = u - half; x <= u + half; x++) {
            if (!owned[y * size + x]) {
                return false;
            }
        }
    }
    return true;
}

/* Border texels list themselves and a few others, near and far. */
static bool set_borders(const parian_env *env, parian_body *body)
{
    uint32_t count = body->texel_count, half = body->kernel_width / 2, total = 0;
    uint8_t *owned;
    if (!PARIAN_NEW0(env, owned, (size_t)body->atlas_size * body->atlas_size)) {
        return false;
    }
    bool made = PARIAN_NEW(env, body->border_texel, count) &&
                PARIAN_NEW(env, body->border_offset, (size_t)count + 1) &&
                PARIAN_NEW(env, body->border_neighbour, (size_t)count * 8);
    for (uint32_t t = 0; t < count; t++) {
        owned[body->texel_index[t]] = 1;
    }
    for (uint32_t t = 0; made && t < count; t++) {
        if (is_owned(owned, body->atlas_size, body->texel_index[t], half)) {
            continue;
        }
        uint32_t listed = 1 + (uint32_t)(8 * noise(t));
        body->border_texel[body->border_count] = t;
        body->border_offset[body->border_count++] = total;
        for (uint32_t k = 0; k < listed; k++) {
            uint32_t other = (uint32_t)((k + noise(77 * t + k)) * count / listed);
            body->border_neighbour[total++] = other < count ? other : count - 1;
        }
        body->border_offset[body->border_count] = total;
    }
    if (made && !body->border_count) {
        body->border_offset[0] = 0;
    }
    parian_free(env, owned);
    return made;
}

static bool set_kernels(const parian_env *env, parian_body *body)
{
    size_t interior =
        (size_t)(body->texel_count - body->border_count) * body->kernel_width * body->kernel_width;
    size_t listed = body->border_offset[body->border_count];
    bool bytes = body->local_form == PARIAN_LOCAL_U8, made;
    if (bytes) {
        made = PARIAN_NEW(env, body->kernel_s8, interior) &&
               PARIAN_NEW(env, body->border_s8, listed) &&
               PARIAN_NEW(env, body->kernel_scale, body->texel_count);
    } else {
        made = PARIAN_NEW(env, body->kernel_f16, interior) &&
               PARIAN_NEW(env, body->border_f16, listed);
    }
    for (int c = 0; made && c < 3; c++) {
        body->kernel_channel_scale[c] = 0.03f + 0.01f * (float)c;
        for (size_t i = 0; i < interior + listed; i++) {
            size_t at = i < interior ? i : i - interior;
            float value = (float)(1.2 * noise(3 * i + (size_t)c) - 0.2);
            if (bytes) {
                (i < interior ? body->kernel_s8 : body->border_s8)[at][c] =
                    (int8_t)(100.0f * value);
            } else {
                (i < interior ? body->kernel_f16 : body->border_f16)[at][c] =
                    parian_half_from_float(value);
            }
        }
        for (uint32_t t = 0; bytes && t < body->texel_count; t++) {
            body->kernel_scale[t][c] = 0.01f + 0.05f * (float)noise(t);
        }
    }
    return made;
}

static bool set_weights(const parian_env *env, parian_body *body)
{
    if (!PARIAN_NEW(env, body->blend_weight, body->texel_count)) {
        return false;
    }
    for (uint32_t t = 0; t < body->texel_count; t++) {
        for (int k = 0; k < 9; k++) {
            body->blend_weight[t][k / 3][k % 3] = parian_half_from_float(
                (float)(0.02 * noise(9 * (uint64_t)t + (uint64_t)k) - 0.002));
        }
    }
    return true;
}

/* Every row: runs of up to 200 columns with gaps of up to 20. */
static bool set_transport(const parian_env *env, parian_body *body)
{
    parian_operator *op = &body->operators[0];
    size_t most = (size_t)body->vertex_count * body->vertex_count;
    op->target_register = 1;
    op->row_count = op->column_count = body->vertex_count;
    if (!PARIAN_NEW(env, op->run_offset, (size_t)body->vertex_count + 1) ||
        !PARIAN_NEW(env, op->run_column, most) || !PARIAN_NEW(env, op->run_count, most) ||
        !PARIAN_NEW(env, op->factor, most) || !PARIAN_NEW(env, op->scale, body->vertex_count)) {
        return false;
    }
    for (uint32_t row = 0; row < body->vertex_count; row++) {
        op->run_offset[row] = op->run_total;
        uint32_t column = (uint32_t)(20 * noise(row));
        while (column < body->vertex_count) {
            uint32_t count = 1 + (uint32_t)(200 * noise(row * 131 + column));
            count = column + count > body->vertex_count ? body->vertex_count - column : count;
            op->run_column[op->run_total] = column;
            op->run_count[op->run_total++] = (uint16_t)count;
            for (uint32_t k = 0; k < 3 * count; k++) {
                op->factor[op->factor_total + k / 3][k % 3] =
                    parian_half_from_float((float)noise(row * 977 + 3 * column + k));
            }
            op->factor_total += count;
            column += count + 1 + (uint32_t)(20 * noise(column));
        }
        for (int c = 0; c < 3; c++) {
            op->scale[row][c] = ldexpf(1.0f, -8 + (int)(row % 3) + c);
        }
    }
    op->run_offset[body->vertex_count] = op->run_total;
    body->has_global = true;
    body->operator_count = 1;
    return true;
}

static bool set_detail(const parian_env *env, parian_body *body)
{
    if (!PARIAN_NEW(env, body->texel_normal_map, body->texel_count) ||
        !PARIAN_NEW(env, body->texel_albedo, body->texel_count)) {
        return false;
    }
    for (uint32_t t = 0; t < body->texel_count; t++) {
        const float *n = body->corner_normal[body->texel_triangle[t]][0];
        memcpy(body->texel_normal_map[t], n, 3 * sizeof *n);
        for (int c = 0; c < 3; c++) {
            body->texel_albedo[t][c] = 0.5f + 0.5f * (float)noise(3 * (uint64_t)t + (uint64_t)c);
        }
    }
    return true;
}

static void make_round(parian_body *body)
{
    for (uint32_t t = 0; t < 3 * body->triangle_count; t++) {
        const float *p = body->vertex_position[body->triangle[t / 3][t % 3]];
        float length = sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int d = 0; d < 3; d++) {
            body->corner_normal[t / 3][t % 3][d] = p[d] / length;
        }
    }
}

static bool fill(const parian_env *env, const parian_mesh *mesh, const test_lit_desc *desc,
                 parian_body *body)
{
    uint32_t cut = desc->cut ? desc->cut : 4;
    uint32_t per_row = (uint32_t)ceil(sqrt((double)mesh->triangle_count));
    bool stored = desc->form == PARIAN_LOCAL_F16 || desc->form == PARIAN_LOCAL_U8;
    bool blended = stored || desc->form == PARIAN_LOCAL_REBUILT;
    set_medium(&body->medium);
    snprintf(body->name, sizeof body->name, "lit");
    body->paper_form = desc->paper_form;
    body->local_form = desc->form;
    body->kernel_width = desc->kernel_width ? desc->kernel_width : 3;
    body->split_radius_m = 1e-3f;
    if (!set_surface(env, body, mesh, cut, per_row)) {
        return false;
    }
    if (desc->smooth_sphere) {
        make_round(body);
    }
    return set_texels(env, body, mesh, cut, per_row) && set_gutter(env, body) &&
           set_borders(env, body) && (!stored || set_kernels(env, body)) &&
           (!blended || set_weights(env, body)) && (!desc->transport || set_transport(env, body)) &&
           (!desc->detail || set_detail(env, body));
}

parian_result test_lit_body(const parian_env *env, const parian_mesh *mesh,
                            const test_lit_desc *desc, parian_body *body)
{
    memset(body, 0, sizeof *body);
    parian_result result =
        fill(env, mesh, desc, body) ? parian_body_derive(env, body) : PARIAN_E_NOMEM;
    if (result != PARIAN_OK) {
        parian_body_free(env, body);
    }
    return result;
}

/* How far the surface of the figure is from the middle in a direction. */
static double figure_reach(const double d[3])
{
    double reach = 1.0 + 0.06 * sin(9.0 * d[0]) * sin(8.0 * d[1] + 1.0) * sin(7.0 * d[2]);
    for (int side = -1; side <= 1; side += 2) {
        double ear[3] = {0.5 * side, 0.8, 0.33}; /* nearly unit: about 1.0 long */
        double along = d[0] * ear[0] + d[1] * ear[1] + d[2] * ear[2];
        double across = d[2] - 0.33; /* ears are flat in z */
        reach += 1.1 * exp(-(1.0 - along) / 0.03) * exp(-across * across / 0.004);
    }
    return reach;
}

parian_result test_figure(const parian_env *env, double radius, unsigned cuts, parian_mesh *mesh)
{
    parian_result result = test_sphere(env, 1.0, cuts, mesh);
    for (uint32_t v = 0; result == PARIAN_OK && v < mesh->vertex_count; v++) {
        double reach = radius * figure_reach(mesh->position[v]);
        for (int d = 0; d < 3; d++) {
            mesh->position[v][d] *= reach;
        }
    }
    return result == PARIAN_OK ? parian_mesh_make_corner_normals(env, mesh, 180.0) : result;
}
