/* measure_maps.c - where the error is: in the atlas, and on the object as a picture.
 *
 * The value is the mean over the channels of (B - truth) / mean of the truth.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/reference/rays.h"
#include "core/memory.h"
#include "tests/measure/error_map.h"
#include "tests/measure/measure_run.h"
#include "tests/measure/nearest_point.h"
#include "tool/files.h"

enum {
    MAP_SAMPLES = 8192
}; /* of quadrature for each receiver: a standard error near 0.4 % of the mean is not seen */
enum { SEARCH_TEXELS = 2 }; /* how far from a place of the surface its texel is looked for */
static const double PI = 3.14159265358979323846;

typedef struct error_maps {
    const parian_measure_run *run;
    const parian_measure_case *c;
    char folder[PARIAN_MEASURE_PATH_MAX], slug[2 * PARIAN_LABEL_MAX];
    float *error;               /* [texel_count] of the scene */
    size_t first_texel[64 + 1]; /* of each body */
    double limit;
} error_maps;

/* ---- values of texels
 * ---------------------------------------------------------------------------------------- */
static void compare(const parian_relit *relit, const parian_texel_choice *choice,
                    const parian_reference_result *truth, float *error)
{
    double mean[3] = {0}, area = 0;
    for (size_t i = 0; i < choice->count; i++) {
        area += choice->area[i];
        for (int c = 0; c < 3; c++) {
            mean[c] += choice->area[i] * truth->radiosity[i][c];
        }
    }
    for (size_t i = 0; i < choice->count; i++) {
        double sum = 0;
        for (int c = 0; c < 3; c++) {
            double d = relit->radiosity[choice->texel[i]][c] - truth->radiosity[i][c];
            sum += mean[c] > 0 ? d * area / mean[c] : 0;
        }
        error[i] = (float)(sum / 3);
    }
}

/* Every texel takes the value of the nearest one that has a truth. */
static parian_result spread(const parian_env *env, const parian_relit *relit,
                            const parian_texel_choice *choice, const float *known, float *error)
{
    size_t n = relit->info.texel_count;
    float(*point)[3] = NULL;
    uint32_t *nearest = NULL;
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW(env, point, choice->count) || !PARIAN_NEW(env, nearest, n)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for a map of %zu texels", n);
    }
    for (size_t i = 0; r == PARIAN_OK && i < choice->count; i++) {
        memcpy(point[i], relit->position[choice->texel[i]], sizeof point[i]);
    }
    if (r == PARIAN_OK) {
        r = parian_nearest_points(env, (const float(*)[3])point, choice->count,
                                  (const float(*)[3])relit->position, n, nearest);
    }
    for (size_t i = 0; r == PARIAN_OK && i < n; i++) {
        error[i] = known[nearest[i]];
    }
    parian_free(env, point);
    parian_free(env, nearest);
    return r;
}

static parian_result find_errors(const parian_env *env, error_maps *maps)
{
    const parian_relit *relit = maps->c->relit;
    const parian_light_set *set = &maps->c->lights->set;
    parian_texel_choice choice = {0};
    parian_receivers receivers = {0};
    parian_reference_result truth = {0};
    parian_truth_desc desc = maps->c->truth;
    float *known = NULL;
    bool cached;
    if (desc.samples == 0 && desc.model != PARIAN_REFERENCE_PATH) {
        desc.samples = MAP_SAMPLES;
    }
    parian_result r = parian_texels_choose(
        env, (const float(*)[3])relit->position, relit->area, relit->info.texel_count,
        maps->run->options->map_receivers, maps->run->options->seed, &choice);
    r = r == PARIAN_OK
            ? parian_truth_receivers(env, maps->c->scene, (const float(*)[3])relit->position, NULL,
                                     &choice, &receivers)
            : r;
    r = r == PARIAN_OK ? parian_truth_get(env, maps->c->scene, &receivers, &desc, &truth, &cached)
                       : r;
    r = r == PARIAN_OK ? parian_relit_light(maps->c->relit, set->light, set->count) : r;
    if (r == PARIAN_OK && !PARIAN_NEW(env, known, choice.count)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu errors", choice.count);
    }
    if (r == PARIAN_OK) {
        compare(relit, &choice, &truth, known);
        r = spread(env, relit, &choice, known, maps->error);
    }
    parian_free(env, known);
    parian_reference_result_free(env, &truth);
    parian_receivers_free(env, &receivers);
    parian_texel_choice_free(env, &choice);
    return r;
}

/* ---- pictures
 * ------------------------------------------------------------------------------------------------
 */
static parian_result write_map(const parian_env *env, const error_maps *maps, const char *kind,
                               uint32_t width, uint32_t height, const float *value)
{
    char name[2 * PARIAN_LABEL_MAX + 32];
    snprintf(name, sizeof name, "%s-%s", maps->slug, kind);
    const parian_error_map map = {.width = width,
                                  .height = height,
                                  .value = value,
                                  .limit = maps->limit,
                                  .is_signed = 1,
                                  .title = "(B - truth) / mean truth, mean of RGB"};
    return parian_error_map_write(env, maps->folder, name, &map);
}

static parian_result draw_atlas(const parian_env *env, const error_maps *maps, uint32_t b)
{
    const parian_body *body = &parian_relit_bodies(maps->c->relit)[b];
    size_t side = body->atlas_size;
    float *value = NULL;
    char kind[32] = "atlas";
    if (!PARIAN_NEW(env, value, side * side)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a map of %zu x %zu texels", side,
                           side);
    }
    for (size_t i = 0; i < side * side; i++) {
        value[i] = NAN;
    }
    for (uint32_t t = 0; t < body->texel_count; t++) {
        value[body->texel_index[t]] = maps->error[maps->first_texel[b] + t];
    }
    if (maps->c->relit->info.body_count > 1) {
        snprintf(kind, sizeof kind, "atlas-%u", b);
    }
    parian_result r = write_map(env, maps, kind, (uint32_t)side, (uint32_t)side, value);
    parian_free(env, value);
    return r;
}

/* The transfer surface as a mesh of doubles. */
static parian_result copy_surface(const parian_env *env, const parian_body *body, parian_mesh *mesh)
{
    if (!PARIAN_NEW(env, mesh->position, body->vertex_count) ||
        !PARIAN_NEW(env, mesh->triangle, body->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u triangles", body->triangle_count);
    }
    mesh->vertex_count = body->vertex_count;
    mesh->triangle_count = body->triangle_count;
    for (size_t i = 0; i < (size_t)body->vertex_count * 3; i++) {
        mesh->position[i / 3][i % 3] = body->vertex_position[i / 3][i % 3];
    }
    memcpy(mesh->triangle, body->triangle, body->triangle_count * sizeof *body->triangle);
    return PARIAN_OK;
}

static parian_result trace_surfaces(const parian_env *env, const parian_relit *relit,
                                    parian_rays **rays)
{
    uint32_t count = relit->info.body_count;
    parian_mesh *mesh = NULL;
    const parian_mesh **list = NULL;
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW0(env, mesh, count) || !PARIAN_NEW(env, list, count)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %u surfaces", count);
    }
    for (uint32_t b = 0; r == PARIAN_OK && b < count; b++) {
        list[b] = &mesh[b];
        r = copy_surface(env, &parian_relit_bodies(relit)[b], &mesh[b]);
    }
    r = r == PARIAN_OK ? parian_rays_create(env, list, count, rays) : r;
    for (uint32_t b = 0; mesh && b < count; b++) {
        parian_mesh_free(env, &mesh[b]);
    }
    parian_free(env, mesh);
    parian_free(env, list);
    return r;
}

/* The texel that shows at a hit, or the nearest one around it that owns surface. */
static float value_at(const error_maps *maps, const parian_ray_hit *hit)
{
    const parian_body *body = &parian_relit_bodies(maps->c->relit)[hit->mesh];
    double uv[2] = {0, 0};
    int side = (int)body->atlas_size, best = 2 * SEARCH_TEXELS * SEARCH_TEXELS + 1;
    float value = NAN;
    for (int k = 0; k < 3; k++) {
        uv[0] += hit->barycentric[k] * body->corner_uv[hit->triangle][k][0];
        uv[1] += hit->barycentric[k] * body->corner_uv[hit->triangle][k][1];
    }
    int u = (int)floor(uv[0]), v = (int)floor(uv[1]);
    for (int y = -SEARCH_TEXELS; y <= SEARCH_TEXELS; y++) {
        for (int x = -SEARCH_TEXELS; x <= SEARCH_TEXELS; x++) {
            bool in = u + x >= 0 && v + y >= 0 && u + x < side && v + y < side;
            uint32_t t = in ? body->texel_at[(v + y) * side + u + x] : UINT32_MAX;
            if (t != UINT32_MAX && x * x + y * y < best) {
                best = x * x + y * y;
                value = maps->error[maps->first_texel[hit->mesh] + t];
            }
        }
    }
    return value;
}

typedef struct object_picture {
    const error_maps *maps;
    const parian_rays *rays;
    parian_view_camera camera;
    double right[3], up[3], back[3];
    uint32_t size;
    float *value;
} object_picture;

static void draw_row(void *context, size_t y)
{
    const object_picture *picture = context;
    double slope = tan(0.5 * picture->camera.fov_deg * PI / 180), size = picture->size;
    for (uint32_t x = 0; x < picture->size; x++) {
        parian_ray ray = {.length = INFINITY, .mesh = PARIAN_RAY_NONE, .triangle = PARIAN_RAY_NONE};
        parian_ray_hit hit;
        double a = slope * (2 * (x + 0.5) / size - 1),
               b = slope * (1 - 2 * ((double)y + 0.5) / size), square = 0;
        for (int c = 0; c < 3; c++) {
            ray.origin[c] = picture->camera.eye[c];
            ray.direction[c] = a * picture->right[c] + b * picture->up[c] - picture->back[c];
            square += ray.direction[c] * ray.direction[c];
        }
        for (int c = 0; c < 3; c++) {
            ray.direction[c] /= sqrt(square);
        }
        bool met = parian_rays_nearest(picture->rays, &ray, PARIAN_RAY_NONE, &hit);
        picture->value[y * picture->size + x] = met ? value_at(picture->maps, &hit) : NAN;
    }
}

static parian_result draw_object(const parian_env *env, const error_maps *maps)
{
    object_picture picture = {.maps = maps, .size = maps->run->options->picture_size};
    parian_rays *rays = NULL;
    parian_result r =
        parian_relit_camera(env, maps->c->relit, maps->run->options->camera, &picture.camera);
    if (r == PARIAN_OK && !PARIAN_NEW(env, picture.value, (size_t)picture.size * picture.size)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for a picture");
    }
    r = r == PARIAN_OK ? trace_surfaces(env, maps->c->relit, &rays) : r;
    if (r == PARIAN_OK) {
        picture.rays = rays;
        parian_view_camera_axes(&picture.camera, picture.right, picture.up, picture.back);
        parian_par(env, picture.size, draw_row, &picture);
        r = write_map(env, maps, "object", picture.size, picture.size, picture.value);
    }
    parian_rays_destroy(rays);
    parian_free(env, picture.value);
    return r;
}

parian_result parian_measure_maps(const parian_env *env, const parian_measure_run *run,
                                  const parian_measure_case *c)
{
    error_maps maps = {.run = run, .c = c};
    uint32_t bodies = c->relit->info.body_count;
    if (bodies > 64) {
        return parian_fail(env, PARIAN_E_UNSUPPORTED, "%s: maps of %u bodies, at most 64 are drawn",
                           c->asset->label, bodies);
    }
    for (uint32_t b = 0; b < bodies; b++) {
        maps.first_texel[b + 1] =
            maps.first_texel[b] + parian_relit_bodies(c->relit)[b].texel_count;
    }
    parian_measure_slug(c->asset->label, c->lights->name, maps.slug);
    if (!parian_measure_path(run, "maps", maps.folder) ||
        !PARIAN_NEW(env, maps.error, c->relit->info.texel_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for error maps");
    }
    parian_result r = parian_folder_create(env, maps.folder);
    r = r == PARIAN_OK ? find_errors(env, &maps) : r;
    for (uint32_t b = 0; r == PARIAN_OK && b < bodies; b++) {
        r = draw_atlas(env, &maps, b);
    }
    r = r == PARIAN_OK ? draw_object(env, &maps) : r;
    parian_free(env, maps.error);
    return r;
}
