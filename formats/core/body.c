/* body.c - frees bodies and scenes, and computes the arrays of a body that follow from the stored
 * ones.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/body.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"

void parian_operator_free(const parian_env *env, parian_operator *op)
{
    if (!op) {
        return;
    }
    parian_free(env, op->run_offset);
    parian_free(env, op->run_column);
    parian_free(env, op->run_count);
    parian_free(env, op->run_factor);
    parian_free(env, op->factor);
    parian_free(env, op->scale);
    memset(op, 0, sizeof *op);
}

static void free_texels(const parian_env *env, parian_body *body)
{
    parian_free(env, body->texel_index);
    parian_free(env, body->texel_triangle);
    parian_free(env, body->texel_barycentric);
    parian_free(env, body->texel_area);
    parian_free(env, body->texel_position);
    parian_free(env, body->texel_normal);
    parian_free(env, body->texel_at);
    parian_free(env, body->texel_normal_map);
    parian_free(env, body->texel_albedo);
    parian_free(env, body->gutter_index);
    parian_free(env, body->gutter_source);
    parian_free(env, body->gutter_weight);
    parian_free(env, body->border_texel);
    parian_free(env, body->border_offset);
    parian_free(env, body->border_neighbour);
    parian_free(env, body->texel_border);
}

void parian_body_free(const parian_env *env, parian_body *body)
{
    if (!body) {
        return;
    }
    parian_free(env, body->vertex_position);
    parian_free(env, body->triangle);
    parian_free(env, body->corner_normal);
    parian_free(env, body->corner_uv);
    parian_free(env, body->triangle_chart);
    free_texels(env, body);
    for (uint32_t i = 0; i < PARIAN_MAX_OPERATORS; i++) {
        parian_operator_free(env, &body->operators[i]);
    }
    parian_free(env, body->blend_weight);
    parian_free(env, body->kernel_f16);
    parian_free(env, body->border_f16);
    parian_free(env, body->kernel_s8);
    parian_free(env, body->border_s8);
    parian_free(env, body->kernel_scale);
    parian_free(env, body->plan_json);
    memset(body, 0, sizeof *body);
}

void parian_scene_data_free(const parian_env *env, parian_scene_data *scene)
{
    if (!scene) {
        return;
    }
    for (uint32_t i = 0; scene->bodies && i < scene->body_count; i++) {
        parian_body_free(env, &scene->bodies[i]);
    }
    for (uint32_t i = 0; scene->surroundings && i < scene->surrounding_count; i++) {
        parian_free(env, scene->surroundings[i].vertex_position);
        parian_free(env, scene->surroundings[i].triangle);
        parian_free(env, scene->surroundings[i].corner_normal);
    }
    parian_free(env, scene->bodies);
    parian_free(env, scene->surroundings);
    parian_free(env, scene->lights_json);
    parian_free(env, scene->provenance_json);
    memset(scene, 0, sizeof *scene);
}

enum { TEXEL_SLICE = 8192 }; /* texels of one parallel piece */

/* The unit normal of a triangle; +z where it has no area. */
static void triangle_normal(const parian_body *body, uint32_t triangle, double normal[3])
{
    const uint32_t *corner = body->triangle[triangle];
    double edge[2][3];
    for (int k = 0; k < 3; k++) {
        double origin = body->vertex_position[corner[0]][k];
        edge[0][k] = body->vertex_position[corner[1]][k] - origin;
        edge[1][k] = body->vertex_position[corner[2]][k] - origin;
    }
    for (int k = 0; k < 3; k++) {
        int m = (k + 1) % 3, n = (k + 2) % 3;
        normal[k] = edge[0][m] * edge[1][n] - edge[0][n] * edge[1][m];
    }
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int k = 0; k < 3; k++) {
        normal[k] = length > 0 ? normal[k] / length : k == 2;
    }
}

static void derive_texel(const parian_body *body, uint32_t texel)
{
    uint32_t triangle = body->texel_triangle[texel];
    const float *beta = body->texel_barycentric[texel];
    double weight[3] = {beta[0], beta[1], 1.0 - beta[0] - beta[1]};
    double normal[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        double position = 0;
        for (int corner = 0; corner < 3; corner++) {
            uint32_t vertex = body->triangle[triangle][corner];
            position += weight[corner] * body->vertex_position[vertex][k];
            normal[k] += weight[corner] * body->corner_normal[triangle][corner][k];
        }
        body->texel_position[texel][k] = (float)position;
    }
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if (length > 1e-6) {
        for (int k = 0; k < 3; k++) {
            normal[k] /= length;
        }
    } else {
        triangle_normal(body, triangle, normal);
    }
    for (int k = 0; k < 3; k++) {
        body->texel_normal[texel][k] = (float)normal[k];
    }
}

static void derive_slice(void *context, size_t slice)
{
    const parian_body *body = context;
    uint32_t first = (uint32_t)slice * TEXEL_SLICE;
    uint32_t rest = body->texel_count - first;
    uint32_t end = first + (rest < TEXEL_SLICE ? rest : TEXEL_SLICE);
    for (uint32_t texel = first; texel < end; texel++) {
        derive_texel(body, texel);
    }
}

static parian_result derive_run_factors(const parian_env *env, parian_operator *op)
{
    uint64_t *run_factor;
    if (!PARIAN_NEW(env, run_factor, (size_t)op->run_total + 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u runs of factors", op->run_total);
    }
    run_factor[0] = 0;
    for (uint32_t run = 0; run < op->run_total; run++) {
        run_factor[run + 1] = run_factor[run] + op->run_count[run];
    }
    parian_free(env, op->run_factor);
    op->run_factor = run_factor;
    return PARIAN_OK;
}

/* Fill texel_at and texel_border, the inverses of texel_index and border_texel. */
static void derive_inverses(parian_body *body)
{
    size_t side = body->atlas_size;
    memset(body->texel_at, 0xff, side * side * sizeof *body->texel_at);
    for (uint32_t texel = 0; texel < body->texel_count; texel++) {
        body->texel_at[body->texel_index[texel]] = texel;
        body->texel_border[texel] = PARIAN_NO_BORDER;
    }
    for (uint32_t border = 0; border < body->border_count; border++) {
        body->texel_border[body->border_texel[border]] = border;
    }
}

parian_result parian_body_derive(const parian_env *env, parian_body *body)
{
    size_t side = body->atlas_size;
    parian_free(env, body->texel_position);
    parian_free(env, body->texel_normal);
    parian_free(env, body->texel_at);
    parian_free(env, body->texel_border);
    body->texel_position = body->texel_normal = NULL;
    body->texel_at = body->texel_border = NULL;
    if (!PARIAN_NEW(env, body->texel_position, body->texel_count) ||
        !PARIAN_NEW(env, body->texel_normal, body->texel_count) ||
        !PARIAN_NEW(env, body->texel_border, body->texel_count) ||
        !PARIAN_NEW(env, body->texel_at, side * side)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u texels of a %u x %u atlas",
                           body->texel_count, body->atlas_size, body->atlas_size);
    }
    derive_inverses(body);
    parian_par(env, (body->texel_count + TEXEL_SLICE - 1) / TEXEL_SLICE, derive_slice, body);
    for (uint32_t i = 0; i < body->operator_count; i++) {
        parian_result result = derive_run_factors(env, &body->operators[i]);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    return PARIAN_OK;
}
