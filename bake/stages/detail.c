/* detail.c - carries detail of the source surface over to the texels: normals and surface colour.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/detail.h"

#include <math.h>

#include "bake/adapters/cgal_closest.h"
#include "bake/stages/detail_color.h"
#include "core/memory.h"
#include "core/small_maths.h"
#include "tool/picture.h"

enum { BLOCK_SIZE = 1024 };
static const double crease_deg = 45.0;
/* The counterpart of a texel faces the same way within 78 degrees, and is a few triangles away at
 * most. */
static const double agree_cosine_min = 0.2, reach_edges = 4.0;
static const float albedo_min = 0.02f;

typedef struct detail_job {
    const parian_detail_desc *desc;
    const parian_body *body;
    const float (*corner_normal)[3][3]; /* of the source */
    double (*point)[3];                 /* [texel_count] */
    double (*normal)[3];
    parian_closest_hit *hit;
    float srgb_to_linear[256];
    float (*normal_map)[3];
    float (*albedo)[3];
} detail_job;

/* The source's normal where the texel lies; the texel's own where that says nothing. */
static void shade_normal(const detail_job *job, uint32_t texel)
{
    const parian_closest_hit *hit = &job->hit[texel];
    double n[3] = {0.0, 0.0, 0.0};
    for (int corner = 0; corner < 3; corner++) {
        for (int k = 0; k < 3; k++) {
            n[k] += hit->barycentric[corner] * job->corner_normal[hit->triangle][corner][k];
        }
    }
    double length = sqrt(parian_dot3(n, n));
    bool usable = length > 0.0 && parian_dot3(n, job->normal[texel]) > 0.0;
    for (int k = 0; k < 3; k++) {
        job->normal_map[texel][k] =
            usable ? (float)(n[k] / length) : job->body->texel_normal[texel][k];
    }
}

static void shade_albedo(const detail_job *job, uint32_t texel)
{
    float *out = job->albedo[texel];
    parian_detail_color(job->desc, job->srgb_to_linear, &job->hit[texel],
                        sqrt(job->body->texel_area[texel]), out);
    for (int c = 0; c < 3; c++) {
        out[c] = out[c] > albedo_min ? fminf(out[c], 1.0f) : albedo_min;
    }
}

static void shade_block(void *context, size_t block)
{
    detail_job *job = context;
    uint32_t begin = (uint32_t)(block * BLOCK_SIZE), count = job->body->texel_count;
    uint32_t end = count - begin < BLOCK_SIZE ? count : begin + BLOCK_SIZE;
    for (uint32_t texel = begin; texel < end; texel++) {
        if (job->normal_map) {
            shade_normal(job, texel);
        }
        if (job->albedo) {
            shade_albedo(job, texel);
        }
    }
}

static double find_reach(const parian_body *body)
{
    double area = 0.0;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        area += body->texel_area[i];
    }
    return body->triangle_count ? reach_edges * sqrt(area / body->triangle_count) : 0.0;
}

static parian_result find_counterparts(const parian_env *env, detail_job *job)
{
    const parian_body *body = job->body;
    parian_closest *closest = NULL;
    parian_result result = parian_closest_create(env, job->desc->source, &closest);
    if (result != PARIAN_OK) {
        return result;
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        for (int k = 0; k < 3; k++) {
            job->point[i][k] = body->texel_position[i][k];
            job->normal[i][k] = body->texel_normal[i][k];
        }
    }
    parian_closest_query query = {body->texel_count, (const double(*)[3])job->point,
                                  (const double(*)[3])job->normal, agree_cosine_min,
                                  find_reach(body)};
    result = parian_closest_find(env, closest, &query, job->hit);
    parian_closest_destroy(closest);
    return result;
}

/* The source's own corner normals, or crease-aware ones made into *made. */
static parian_result find_corner_normals(const parian_env *env, detail_job *job, parian_mesh *made)
{
    const parian_mesh *source = job->desc->source;
    job->corner_normal = (const float(*)[3][3])source->corner_normal;
    if (!job->desc->normal_map || job->corner_normal) {
        return PARIAN_OK;
    }
    *made = *source;
    parian_result result = parian_mesh_make_corner_normals(env, made, crease_deg);
    job->corner_normal = (const float(*)[3][3])made->corner_normal;
    return result;
}

static bool allocate(const parian_env *env, detail_job *job, bool color)
{
    uint32_t count = job->body->texel_count;
    return PARIAN_NEW(env, job->point, count) && PARIAN_NEW(env, job->normal, count) &&
           PARIAN_NEW(env, job->hit, count) &&
           (!job->desc->normal_map || PARIAN_NEW(env, job->normal_map, count)) &&
           (!color || PARIAN_NEW(env, job->albedo, count));
}

static void make_srgb_table(float table[256])
{
    for (int code = 0; code < 256; code++) {
        table[code] = parian_srgb_decode((uint8_t)code);
    }
}

parian_result parian_stage_detail(const parian_env *env, const parian_detail_desc *desc,
                                  parian_body *body)
{
    bool color = parian_detail_has_color(desc);
    detail_job job = {.desc = desc, .body = body};
    parian_mesh shaded = {0};
    parian_result result = PARIAN_OK;
    if ((!desc->normal_map && !color) || !desc->source->triangle_count || !body->texel_count) {
        return PARIAN_OK;
    }
    if (!allocate(env, &job, color)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "detail: out of memory for %u texels",
                             body->texel_count);
        goto done;
    }
    parian_progress(env, "detail", 0.0);
    make_srgb_table(job.srgb_to_linear);
    result = find_corner_normals(env, &job, &shaded);
    if (result == PARIAN_OK) {
        result = find_counterparts(env, &job);
    }
    if (result == PARIAN_OK) {
        parian_par(env, (body->texel_count + BLOCK_SIZE - 1) / BLOCK_SIZE, shade_block, &job);
        parian_free(env, body->texel_normal_map);
        parian_free(env, body->texel_albedo);
        body->texel_normal_map = job.normal_map;
        body->texel_albedo = job.albedo;
        job.normal_map = NULL;
        job.albedo = NULL;
        parian_progress(env, "detail", 1.0);
    }
done:
    parian_free(env, job.albedo);
    parian_free(env, job.normal_map);
    if (shaded.corner_normal != desc->source->corner_normal) {
        parian_free(env, shaded.corner_normal);
    }
    parian_free(env, job.hit);
    parian_free(env, job.normal);
    parian_free(env, job.point);
    return result;
}
