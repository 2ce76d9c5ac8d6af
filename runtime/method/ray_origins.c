/* ray_origins.c - where the shadow rays of texels start.
 *
 * SPDX-License-Identifier: MIT
 */
#include "method/ray_origins.h"

#include <string.h>

#include "core/memory.h"
#include "core/random.h"
#include "lights/sample_set.h"
#include "vec3.h"

enum { TEXEL_PIECE = 1024, TRY_MAX = 8 };

/* ---- triangles of a texel ---- */

/* Barycentrics of a point of the atlas; false outside the triangle. */
static bool place_in(const parian_body *body, uint32_t triangle, const double at[2],
                     double share[3])
{
    const float(*uv)[2] = (const float(*)[2])body->corner_uv[triangle];
    double edge[2][2], from[2];
    for (int c = 0; c < 2; c++) {
        edge[0][c] = (double)uv[1][c] - (double)uv[0][c];
        edge[1][c] = (double)uv[2][c] - (double)uv[0][c];
        from[c] = at[c] - (double)uv[0][c];
    }
    double det = edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
    if (det == 0.0) {
        return false;
    }
    share[1] = (from[0] * edge[1][1] - from[1] * edge[1][0]) / det;
    share[2] = (edge[0][0] * from[1] - edge[0][1] * from[0]) / det;
    share[0] = 1.0 - share[1] - share[2];
    return share[0] >= 0.0 && share[1] >= 0.0 && share[2] >= 0.0;
}

/* Whether an edge parts the triangle from the texel. */
static bool parted(const float (*uv)[2], const double low[2])
{
    double area = ((double)uv[1][0] - (double)uv[0][0]) * ((double)uv[2][1] - (double)uv[0][1]) -
                  ((double)uv[1][1] - (double)uv[0][1]) * ((double)uv[2][0] - (double)uv[0][0]);
    for (int k = 0; k < 3; k++) {
        const float *a = uv[k], *b = uv[(k + 1) % 3];
        double nx = (double)a[1] - (double)b[1], ny = (double)b[0] - (double)a[0], most = -1e300;
        for (int corner = 0; corner < 4; corner++) {
            double x = low[0] + (corner & 1) - (double)a[0];
            double y = low[1] + (corner >> 1) - (double)a[1];
            most = fmax(most, (area < 0.0 ? -1.0 : 1.0) * (nx * x + ny * y));
        }
        if (most <= 0.0) {
            return true;
        }
    }
    return false;
}

typedef void (*cover_visit)(const parian_body *body, parian_texel_cover *cover, uint32_t texel,
                            uint32_t triangle);

static uint32_t clamp_place(float at, uint32_t size)
{
    return at <= 0.0f ? 0 : at >= (float)size ? size : (uint32_t)at;
}

/* Call visit for each texel that a triangle of its chart reaches into. */
static void visit_triangle(const parian_body *body, uint32_t triangle, parian_texel_cover *cover,
                           cover_visit visit)
{
    const float(*uv)[2] = (const float(*)[2])body->corner_uv[triangle];
    uint32_t first[2], last[2];
    for (int c = 0; c < 2; c++) {
        first[c] = clamp_place(fminf(uv[0][c], fminf(uv[1][c], uv[2][c])), body->atlas_size);
        last[c] = clamp_place(fmaxf(uv[0][c], fmaxf(uv[1][c], uv[2][c])) + 1.0f, body->atlas_size);
    }
    for (uint32_t v = first[1]; v < last[1]; v++) {
        for (uint32_t u = first[0]; u < last[0]; u++) {
            uint32_t texel = body->texel_at[(size_t)v * body->atlas_size + u];
            const double low[2] = {u, v};
            if (texel != UINT32_MAX && !parted(uv, low) &&
                body->triangle_chart[body->texel_triangle[texel]] ==
                    body->triangle_chart[triangle]) {
                visit(body, cover, texel, triangle);
            }
        }
    }
}

static void count_one(const parian_body *body, parian_texel_cover *cover, uint32_t texel,
                      uint32_t triangle)
{
    (void)body;
    (void)triangle;
    cover->offset[texel + 1]++;
}

/* Offsets of texels move up as their places fill. */
static void put_one(const parian_body *body, parian_texel_cover *cover, uint32_t texel,
                    uint32_t triangle)
{
    (void)body;
    cover->triangle[cover->offset[texel]++] = triangle;
}

parian_result parian_texel_cover_build(const parian_env *env, const parian_body *body,
                                       parian_texel_cover *cover)
{
    parian_texel_cover made = {NULL, NULL};
    if (!PARIAN_NEW0(env, made.offset, (size_t)body->texel_count + 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the cover of %u texels",
                           body->texel_count);
    }
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        visit_triangle(body, t, &made, count_one);
    }
    for (uint32_t t = 0; t < body->texel_count; t++) {
        made.offset[t + 1] += made.offset[t];
    }
    if (!PARIAN_NEW(env, made.triangle, made.offset[body->texel_count])) {
        parian_free(env, made.offset);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the cover of %u texels",
                           body->texel_count);
    }
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        visit_triangle(body, t, &made, put_one);
    }
    memmove(made.offset + 1, made.offset, (size_t)body->texel_count * sizeof *made.offset);
    made.offset[0] = 0;
    *cover = made;
    return PARIAN_OK;
}

void parian_texel_cover_free(const parian_env *env, parian_texel_cover *cover)
{
    if (cover) {
        parian_free(env, cover->offset);
        parian_free(env, cover->triangle);
        *cover = (parian_texel_cover){NULL, NULL};
    }
}

/* ---- origins ---- */

typedef struct origin_job {
    const parian_body *body;
    const parian_texel_cover *cover;
    uint32_t set;
    float lift; /* metres along the facet's normal */
    float (*origin)[3];
} origin_job;

/* A point of the texel; its centroid where none is found. */
static uint32_t pick_point(const origin_job *job, uint32_t texel, double share[3])
{
    const parian_body *body = job->body;
    uint32_t index = body->texel_index[texel];
    for (uint32_t attempt = 0; job->set > 0 && attempt < TRY_MAX; attempt++) {
        double at[2];
        parian_set_point(PARIAN_SET_TEXEL, texel + ((uint64_t)attempt << 32), job->set, at);
        at[0] += index % body->atlas_size;
        at[1] += index / body->atlas_size;
        for (uint32_t i = job->cover->offset[texel]; i < job->cover->offset[texel + 1]; i++) {
            if (place_in(body, job->cover->triangle[i], at, share)) {
                return job->cover->triangle[i];
            }
        }
    }
    share[0] = (double)body->texel_barycentric[texel][0];
    share[1] = (double)body->texel_barycentric[texel][1];
    share[2] = 1.0 - share[0] - share[1];
    return body->texel_triangle[texel];
}

static void origin_of_texel(const origin_job *job, uint32_t texel)
{
    const parian_body *body = job->body;
    double share[3];
    uint32_t triangle = pick_point(job, texel, share);
    const float *corner[3];
    float point[3] = {0}, edge[2][3], normal[3], *origin = job->origin[texel];
    for (int k = 0; k < 3; k++) {
        corner[k] = body->vertex_position[body->triangle[triangle][k]];
        vec3_add_scaled(point, corner[k], (float)share[k]);
    }
    vec3_sub(edge[0], corner[1], corner[0]);
    vec3_sub(edge[1], corner[2], corner[0]);
    vec3_cross(normal, edge[0], edge[1]);
    vec3_normalize(normal);
    vec3_copy(origin, point);
    vec3_add_scaled(origin, normal, job->lift);
    for (int k = 0; k < 3; k++) {
        float away[3];
        const float *smooth = body->corner_normal[triangle][k];
        vec3_sub(away, point, corner[k]);
        float below = fminf(0.0f, vec3_dot(away, smooth));
        vec3_add_scaled(origin, smooth, -below * (float)share[k]);
    }
}

static void origin_piece(void *context, size_t piece)
{
    const origin_job *job = context;
    uint32_t first = (uint32_t)piece * TEXEL_PIECE;
    for (uint32_t t = first; t < first + TEXEL_PIECE && t < job->body->texel_count; t++) {
        origin_of_texel(job, t);
    }
}

void parian_ray_origins(const parian_env *env, const parian_body *body,
                        const parian_texel_cover *cover, uint32_t set, float (*origin)[3])
{
    origin_job job = {.body = body, .cover = cover, .set = set, .origin = origin};
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        for (int c = 0; c < 3; c++) {
            job.lift = fmaxf(job.lift, 2e-6f * fabsf(body->vertex_position[v][c]));
        }
    }
    parian_par(env, (body->texel_count + TEXEL_PIECE - 1) / TEXEL_PIECE, origin_piece, &job);
}
