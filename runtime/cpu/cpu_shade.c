/* cpu_shade.c - radiance of the picture: the C evaluation of the shading passes.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_shade.h"

#include <string.h>

#include "core/fresnel.h"
#include "core/memory.h"
#include "cpu/cpu_raster.h"
#include "shade/chart_color.h"
#include "vec3.h"

enum { PIXEL_PIECE = 4096, NOTHING = 0xFFFFFFFF };

/* What is seen through a sample: mesh (the bodies of each instance, then the surroundings),
 * triangle, place in it. */
typedef struct seen_point {
    uint32_t mesh, triangle;
    float b0, b1, depth;
} seen_point;

typedef struct mesh_view {
    const float (*position)[3];
    const uint32_t (*triangle)[3];
    const float (*corner_normal)[3][3];
    uint32_t triangle_count;
    bool is_body;
    uint32_t index;      /* of the body or surrounding */
    parian_placement at; /* where it stands */
} mesh_view;

typedef struct draw_job {
    const parian_shade_desc *desc;
    seen_point *seen;
    uint32_t mesh_index;
    mesh_view mesh;
    float clip[16]; /* for the mesh before it is placed */
    float (*radiance)[4];
} draw_job;

static mesh_view view_mesh(const parian_shade_desc *desc, uint32_t mesh)
{
    static const parian_placement stay = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, 1};
    const parian_scene_data *scene = desc->scene;
    if (mesh < desc->instance_count * scene->body_count) {
        uint32_t b = mesh % scene->body_count;
        const parian_body *body = &scene->bodies[b];
        return (mesh_view){(const float(*)[3])body->vertex_position,
                           (const uint32_t(*)[3])body->triangle,
                           (const float(*)[3][3])body->corner_normal,
                           body->triangle_count,
                           true,
                           b,
                           desc->instances[mesh / scene->body_count]};
    }
    uint32_t s = mesh - desc->instance_count * scene->body_count;
    const parian_surrounding *piece = &scene->surroundings[s];
    return (mesh_view){(const float(*)[3])piece->vertex_position,
                       (const uint32_t(*)[3])piece->triangle,
                       (const float(*)[3][3])piece->corner_normal,
                       piece->triangle_count,
                       false,
                       s,
                       stay};
}

/* ---- visibility ---- */

static void see_fragment(void *context, uint32_t pixel, uint32_t triangle, const float share[3])
{
    draw_job *job = context;
    const float *clip = job->clip;
    float sum = share[0] + share[1] + share[2], depth = 0.0f;
    for (int k = 0; k < 3; k++) {
        const float *p = job->mesh.position[job->mesh.triangle[triangle][k]];
        depth += share[k] * (clip[2] * p[0] + clip[6] * p[1] + clip[10] * p[2] + clip[14]);
    }
    if (depth >= -1.0f && depth <= 1.0f && depth < job->seen[pixel].depth) {
        job->seen[pixel] =
            (seen_point){job->mesh_index, triangle, share[0] / sum, share[1] / sum, depth};
    }
}

static parian_result see_mesh(const parian_env *env, draw_job *job, uint32_t mesh)
{
    const float *clip = job->clip;
    job->mesh_index = mesh;
    job->mesh = view_mesh(job->desc, mesh);
    placement_fold_matrix(&job->mesh.at, job->desc->view->clip, job->clip);
    parian_raster_desc raster = {.width = job->desc->width,
                                 .height = job->desc->height,
                                 .triangle_count = job->mesh.triangle_count,
                                 .triangle = job->mesh.triangle,
                                 .position = job->mesh.position,
                                 .fragment = see_fragment,
                                 .context = job};
    for (int k = 0; k < 4; k++) {
        raster.row_x[k] = clip[4 * k];
        raster.row_y[k] = clip[4 * k + 1];
        raster.row_w[k] = clip[4 * k + 3];
    }
    return parian_raster_run(env, &raster);
}

/* ---- shading ---- */

/* Bilinear by hand; texels without a value drop out. */
static void fetch_atlas(const float (*atlas)[4], uint32_t size, const float uv[2], float value[3])
{
    float x = uv[0] - 0.5f, y = uv[1] - 0.5f;
    float x0 = floorf(x), y0 = floorf(y), fx = x - x0, fy = y - y0, total = 0.0f;
    vec3_set(value, 0.0f);
    for (int k = 0; k < 4; k++) {
        int ix = (int)x0 + (k & 1), iy = (int)y0 + (k >> 1);
        if (ix < 0 || iy < 0 || ix >= (int)size || iy >= (int)size) {
            continue;
        }
        const float *texel = atlas[(size_t)iy * size + (size_t)ix];
        float weight = (k & 1 ? fx : 1.0f - fx) * (k >> 1 ? fy : 1.0f - fy) * texel[3];
        vec3_add_scaled(value, texel, weight);
        total += weight;
    }
    vec3_scale(value, total > 0.0f ? 1.0f / total : 0.0f);
}

/* GGX with height-correlated masking, times the cosine of the light. */
static float ggx(float alpha, float n_l, float n_v, float n_h)
{
    float a2 = alpha * alpha;
    float base = n_h * n_h * (a2 - 1.0f) + 1.0f;
    float density = a2 / ((float)M_PI * base * base);
    float mask_l = n_v * sqrtf(n_l * n_l * (1.0f - a2) + a2);
    float mask_v = n_l * sqrtf(n_v * n_v * (1.0f - a2) + a2);
    return density * 0.5f * n_l / (mask_l + mask_v);
}

/* Cosine towards the viewer. A normal that interpolation or the map turned away from a triangle
 * that is seen counts as grazing: without this, F_t would draw black lines there. */
static float seen_cosine(const mesh_view *mesh, uint32_t triangle, const float n[3],
                         const float v[3])
{
    const uint32_t *corner = mesh->triangle[triangle];
    const float *a = mesh->position[corner[0]];
    float e1[3], e2[3], facet[3], placed[3];
    vec3_sub(e1, mesh->position[corner[1]], a);
    vec3_sub(e2, mesh->position[corner[2]], a);
    vec3_cross(facet, e1, e2);
    vec3_normalize(facet);
    placement_normal(&mesh->at, facet, placed);
    float facing = fabsf(vec3_dot(placed, v));
    return fmaxf(fmaxf(vec3_dot(n, v), fminf(facing, 0.1f)), 1e-3f);
}

/* A point of a body, as shading sees it. */
typedef struct body_point {
    float p[3], smooth[3]; /* place, interpolated normal */
    float n[3];            /* normal, of the map where there is one */
    float v[3], n_v;       /* towards the viewer, and its cosine */
} body_point;

/* Surface reflection of lights and environment. */
static void reflect_lights(const parian_shade_desc *desc, float eta, float scale,
                           const body_point *at, float sum[3])
{
    const parian_light_list *list = desc->lights->list;
    const float extent = scale * desc->lights->lift;
    float roughness = desc->settings->roughness > 0.0f ? desc->settings->roughness : 0.35f;
    float alpha = fmaxf(roughness * roughness, 1e-3f);
    vec3_set(sum, 0.0f);
    for (uint32_t i = 0; i < list->sample_count; i++) {
        const parian_light_sample *sample = &list->sample[i];
        float l[3], light[3], h[3];
        if (sample->kind == PARIAN_SAMPLE_PROBE) {
            continue;
        }
        parian_cpu_light_at(list, sample, at->p, extent, l, light);
        float n_l = vec3_dot(at->n, l);
        if (n_l <= 0.0f || vec3_dot(at->smooth, l) <= 0.0f ||
            light[0] + light[1] + light[2] <= 0.0f) {
            continue;
        }
        vec3_copy(h, l);
        vec3_add_scaled(h, at->v, 1.0f);
        vec3_normalize(h);
        float lobe = ggx(alpha, n_l, at->n_v, fmaxf(vec3_dot(at->n, h), 0.0f));
        lobe *= 1.0f - parian_fresnel_transmittancef(vec3_dot(l, h), eta);
        vec3_add_scaled(sum, light,
                        lobe *
                            parian_cpu_visibility(desc->lights, sample, at->p, at->smooth, scale));
    }
    if (list->sky_count > 0) {
        float mirrored[3] = {-at->v[0], -at->v[1], -at->v[2]}, sky[3];
        vec3_add_scaled(mirrored, at->n, 2.0f * at->n_v);
        vec3_normalize(mirrored);
        parian_cpu_environment_radiance(list, mirrored, sky);
        vec3_add_scaled(sum, sky, 1.0f - parian_fresnel_transmittancef(at->n_v, eta));
    }
}

/* Scattered light of a view mode at a point: what leaves, times pi, before Fresnel. */
static void scattered(const parian_shade_desc *desc, const parian_shade_atlas *atlas, uint32_t size,
                      const float uv[2], float value[3])
{
    parian_view_mode view = desc->settings->view;
    float part[3];
    vec3_set(value, 0.0f);
    if (view == PARIAN_VIEW_IRRADIANCE || view == PARIAN_VIEW_OPAQUE) {
        fetch_atlas((const float(*)[4])atlas->irradiance, size, uv, value);
    }
    const bool both = view == PARIAN_VIEW_COMBINED || view == PARIAN_VIEW_RADIOSITY;
    if (both || view == PARIAN_VIEW_LOCAL) {
        fetch_atlas((const float(*)[4])atlas->local, size, uv, part);
        vec3_add_scaled(value, part, 1.0f);
    }
    if (both || view == PARIAN_VIEW_GLOBAL) {
        fetch_atlas((const float(*)[4])atlas->global, size, uv, part);
        vec3_add_scaled(value, part, 1.0f);
    }
    if (atlas->albedo && !desc->settings->no_albedo && view != PARIAN_VIEW_IRRADIANCE &&
        view != PARIAN_VIEW_RADIOSITY) {
        fetch_atlas((const float(*)[4])atlas->albedo, size, uv, part);
        for (int c = 0; c < 3; c++) {
            value[c] *= part[c];
        }
    }
}

/* The factor from scattered light to radiance, per channel. */
static float exit_factor(const parian_shade_desc *desc, uint32_t b, float n_v, int channel)
{
    const parian_body_optics *optics = &desc->optics[b];
    if (desc->settings->view == PARIAN_VIEW_IRRADIANCE ||
        desc->settings->view == PARIAN_VIEW_RADIOSITY) {
        return 1.0f / (float)M_PI;
    }
    if (desc->settings->view == PARIAN_VIEW_OPAQUE) {
        return optics->tint[channel] * optics->albedo[channel] / (float)M_PI;
    }
    return optics->tint[channel] * parian_fresnel_transmittancef(n_v, optics->eta) /
           ((float)M_PI * optics->exit_norm);
}

/* at: p, smooth and v are set. */
static void shade_body(const parian_shade_desc *desc, const mesh_view *mesh, const seen_point *seen,
                       const float uv[2], body_point *at, float out[3])
{
    const parian_settings *settings = desc->settings;
    const parian_shade_atlas *atlas = &desc->atlas[seen->mesh];
    const uint32_t b = mesh->index, size = desc->scene->bodies[b].atlas_size;
    vec3_copy(at->n, at->smooth);
    if (atlas->normal && !settings->no_normal_map) {
        float mapped[3];
        fetch_atlas((const float(*)[4])atlas->normal, size, uv, mapped);
        placement_normal(&mesh->at, mapped, at->n);
        vec3_normalize(at->n);
    }
    at->n_v = seen_cosine(mesh, seen->triangle, at->n, at->v);
    if (settings->view == PARIAN_VIEW_NORMALS) {
        vec3_set(out, 0.5f);
        vec3_add_scaled(out, at->n, 0.5f);
        return;
    }
    if (settings->view == PARIAN_VIEW_CHARTS) {
        parian_chart_color(desc->scene->bodies[b].triangle_chart[seen->triangle], out);
        vec3_scale(out, 0.3f + 0.7f * at->n_v);
        return;
    }
    if (settings->view == PARIAN_VIEW_VALUES) {
        fetch_atlas((const float(*)[4])atlas->values, size, uv, out);
        return;
    }
    scattered(desc, atlas, size, uv, out);
    for (int c = 0; c < 3; c++) {
        out[c] = fmaxf(out[c] * exit_factor(desc, b, at->n_v, c), 0.0f);
    }
    bool whole = settings->view == PARIAN_VIEW_COMBINED || settings->view == PARIAN_VIEW_OPAQUE;
    if (whole && !settings->no_specular && desc->optics[b].eta != 1.0f) {
        float shine[3];
        reflect_lights(desc, desc->optics[b].eta, mesh->at.scale, at, shine);
        vec3_add_scaled(out, shine, 1.0f);
    }
}

/* Lambertian surroundings, lit on the side that is seen. */
static void shade_surrounding(const parian_shade_desc *desc, uint32_t index, const float p[3],
                              const float smooth[3], const float v[3], float out[3])
{
    static const float zonal[3] = {3.14159265f, 2.09439510f, 0.785398163f};
    const float *reflectance = desc->scene->surroundings[index].reflectance;
    const parian_light_list *list = desc->lights->list;
    float n[3];
    vec3_copy(n, smooth);
    vec3_scale(n, vec3_dot(smooth, v) < 0.0f ? -1.0f : 1.0f);
    vec3_set(out, 0.0f);
    if (parian_view_is_plain(desc->settings->view)) {
        vec3_set(out, 0.5f);
        vec3_add_scaled(out, n, desc->settings->view == PARIAN_VIEW_NORMALS ? 0.5f : 0.0f);
        return;
    }
    for (uint32_t i = 0; i < list->sample_count; i++) {
        float l[3], light[3];
        if (list->sample[i].kind == PARIAN_SAMPLE_PROBE) {
            continue;
        }
        parian_cpu_light_at(list, &list->sample[i], p, desc->lights->lift, l, light);
        float cosine = vec3_dot(n, l);
        if (cosine > 0.0f && light[0] + light[1] + light[2] > 0.0f) {
            vec3_add_scaled(out, light,
                            cosine *
                                parian_cpu_visibility(desc->lights, &list->sample[i], p, n, 1.0f));
        }
    }
    if (list->sky_count > 0) {
        float sky[3];
        parian_cpu_environment(desc->lights, p, n, zonal, 1.0f, sky);
        vec3_add_scaled(out, sky, 1.0f);
    }
    for (int c = 0; c < 3; c++) {
        out[c] *= reflectance[c] / (float)M_PI;
    }
}

/* Place, smooth normal and atlas position of what is seen. */
static void find_point(const parian_shade_desc *desc, const mesh_view *mesh, const seen_point *seen,
                       body_point *at, float uv[2])
{
    const float beta[3] = {seen->b0, seen->b1, 1.0f - seen->b0 - seen->b1};
    float p[3] = {0}, n[3] = {0};
    for (int k = 0; k < 3; k++) {
        vec3_add_scaled(p, mesh->position[mesh->triangle[seen->triangle][k]], beta[k]);
        vec3_add_scaled(n, mesh->corner_normal[seen->triangle][k], beta[k]);
        for (int axis = 0; mesh->is_body && axis < 2; axis++) {
            uv[axis] +=
                beta[k] * desc->scene->bodies[mesh->index].corner_uv[seen->triangle][k][axis];
        }
    }
    placement_point(&mesh->at, p, at->p);
    placement_normal(&mesh->at, n, at->smooth);
    vec3_normalize(at->smooth);
    vec3_copy(at->v, desc->view->eye);
    vec3_add_scaled(at->v, at->p, -desc->view->eye[3]);
    vec3_normalize(at->v);
}

static void shade_point(const parian_shade_desc *desc, const seen_point *seen, float out[4])
{
    const mesh_view mesh = view_mesh(desc, seen->mesh);
    float uv[2] = {0};
    body_point at = {{0}, {0}, {0}, {0}, 0.0f};
    find_point(desc, &mesh, seen, &at, uv);
    if (mesh.is_body) {
        shade_body(desc, &mesh, seen, uv, &at, out);
    } else {
        shade_surrounding(desc, mesh.index, at.p, at.smooth, at.v, out);
    }
    out[3] = 1.0f;
}

static void shade_piece(void *context, size_t piece)
{
    draw_job *job = context;
    size_t total = (size_t)job->desc->width * job->desc->height;
    size_t first = piece * PIXEL_PIECE;
    for (size_t i = first; i < first + PIXEL_PIECE && i < total; i++) {
        if (job->seen[i].mesh == NOTHING) {
            vec3_copy(job->radiance[i], job->desc->settings->background);
            job->radiance[i][3] = 0.0f;
        } else {
            shade_point(job->desc, &job->seen[i], job->radiance[i]);
        }
    }
}

parian_result parian_cpu_shade(const parian_env *env, const parian_shade_desc *desc,
                               float (*radiance)[4])
{
    draw_job job = {.desc = desc, .radiance = radiance};
    size_t total = (size_t)desc->width * desc->height;
    parian_result result = PARIAN_OK;
    if (!PARIAN_NEW(env, job.seen, total)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u x %u samples", desc->width,
                           desc->height);
    }
    for (size_t i = 0; i < total; i++) {
        job.seen[i] = (seen_point){NOTHING, 0, 0.0f, 0.0f, 2.0f};
    }
    uint32_t meshes =
        desc->instance_count * desc->scene->body_count + desc->scene->surrounding_count;
    for (uint32_t m = 0; result == PARIAN_OK && m < meshes; m++) {
        result = see_mesh(env, &job, m);
    }
    if (result == PARIAN_OK) {
        parian_par(env, (total + PIXEL_PIECE - 1) / PIXEL_PIECE, shade_piece, &job);
    }
    parian_free(env, job.seen);
    return result;
}
