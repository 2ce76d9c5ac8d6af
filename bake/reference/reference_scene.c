/* reference_scene.c - makes the scene of a reference from a model, from an asset, or from surfaces
 * at hand.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/reference_scene.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "bake/pipeline/named_env.h"
#include "bake/reference/rays.h"
#include "bake/stages/surface.h"
#include "core/body_file.h"
#include "core/memory.h"
#include "tool/lights_file.h"

/* ---- from surfaces ---- */

static parian_result find_closed(const parian_env *env, parian_reference_body *body)
{
    const parian_mesh *mesh = &body->mesh;
    uint32_t(*neighbour)[3] = NULL;
    if (!PARIAN_NEW(env, neighbour, mesh->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the edges of %u triangles",
                           mesh->triangle_count);
    }
    parian_result r = parian_triangle_neighbours(env, mesh->vertex_count, mesh->triangle_count,
                                                 (const uint32_t(*)[3])mesh->triangle, neighbour);
    body->closed = r == PARIAN_OK && mesh->triangle_count > 0;
    for (uint32_t h = 0; body->closed && h / 3 < mesh->triangle_count; h++) {
        body->closed = neighbour[h / 3][h % 3] != PARIAN_NO_NEIGHBOUR;
    }
    parian_free(env, neighbour);
    return r;
}

static void add_to_box(const parian_mesh *mesh, double lower[3], double upper[3])
{
    double low[3], high[3];
    if (mesh->triangle_count == 0) {
        return;
    }
    parian_mesh_bounds(mesh, low, high);
    for (int k = 0; k < 3; k++) {
        lower[k] = fmin(lower[k], low[k]);
        upper[k] = fmax(upper[k], high[k]);
    }
}

static parian_result find_extent(const parian_env *env, parian_reference_scene *scene)
{
    for (int k = 0; k < 3; k++) {
        scene->lower[k] = INFINITY;
        scene->upper[k] = -INFINITY;
    }
    for (uint32_t b = 0; b < scene->body_count; b++) {
        add_to_box(&scene->bodies[b].mesh, scene->lower, scene->upper);
    }
    for (int k = 0; k < 3; k++) {
        scene->extent = fmax(scene->extent, scene->upper[k] - scene->lower[k]);
    }
    for (uint32_t s = 0; s < scene->surrounding_count; s++) {
        add_to_box(&scene->surroundings[s], scene->lower, scene->upper);
    }
    if (!(scene->extent > 0 && isfinite(scene->extent))) {
        return parian_fail(env, PARIAN_E_FORMAT, "no body has a surface");
    }
    return PARIAN_OK;
}

static parian_result make_rays(const parian_env *env, parian_reference_scene *scene)
{
    uint32_t count = scene->body_count + scene->surrounding_count;
    const parian_mesh **meshes = NULL;
    if (!PARIAN_NEW(env, meshes, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u meshes", count);
    }
    for (uint32_t b = 0; b < scene->body_count; b++) {
        meshes[b] = &scene->bodies[b].mesh;
    }
    for (uint32_t s = 0; s < scene->surrounding_count; s++) {
        meshes[scene->body_count + s] = &scene->surroundings[s];
    }
    parian_result r = parian_rays_create(env, meshes, count, &scene->rays);
    parian_free(env, meshes);
    return r;
}

static parian_result copy_lights(const parian_env *env, const parian_light *lights, uint32_t count,
                                 parian_reference_scene *scene)
{
    if (!PARIAN_NEW(env, scene->lights, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u lights", count);
    }
    if (count > 0) {
        memcpy(scene->lights, lights, count * sizeof *lights);
    }
    scene->light_count = count;
    return parian_light_sampler_create(env, scene->lights, count, &scene->sampler);
}

static parian_result complete_bodies(const parian_env *env, parian_reference_scene *scene)
{
    parian_result r = PARIAN_OK;
    for (uint32_t b = 0; r == PARIAN_OK && b < scene->body_count; b++) {
        parian_reference_body *body = &scene->bodies[b];
        r = find_closed(env, body);
        if (r == PARIAN_OK && !body->mesh.corner_normal) {
            r = parian_mesh_make_corner_normals(env, &body->mesh, PARIAN_CREASE_DEG);
        }
    }
    return r;
}

parian_result parian_reference_scene_make(const parian_env *env, parian_reference_body *bodies,
                                          uint32_t body_count, parian_mesh *surroundings,
                                          uint32_t surrounding_count, const parian_light *lights,
                                          uint32_t light_count, parian_reference_scene *scene)
{
    parian_reference_scene made = {.body_count = body_count,
                                   .surrounding_count = surrounding_count,
                                   .bodies = bodies,
                                   .surroundings = surroundings};
    parian_result r = find_extent(env, &made);
    if (r == PARIAN_OK) {
        r = make_rays(env, &made); /* checks coordinates and indices */
    }
    if (r == PARIAN_OK) {
        r = complete_bodies(env, &made);
    }
    if (r == PARIAN_OK) {
        r = copy_lights(env, lights, light_count, &made);
    }
    if (r != PARIAN_OK) {
        parian_reference_scene_free(env, &made);
        return r;
    }
    *scene = made;
    return PARIAN_OK;
}

/* ---- what both kinds of input gather ---- */

typedef struct scene_parts {
    uint32_t body_count, surrounding_count;
    parian_reference_body *bodies;
    parian_mesh *surroundings;
} scene_parts;

static parian_result allocate_parts(const parian_env *env, uint32_t bodies, uint32_t surroundings,
                                    scene_parts *parts)
{
    if (!PARIAN_NEW0(env, parts->bodies, bodies) ||
        !PARIAN_NEW0(env, parts->surroundings, surroundings)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u bodies", bodies);
    }
    parts->body_count = bodies;
    parts->surrounding_count = surroundings;
    return PARIAN_OK;
}

/* Make the scene of what was gathered, or free it. */
static parian_result use_parts(const parian_env *env, parian_result r, scene_parts *parts,
                               const parian_light *lights, uint32_t light_count,
                               parian_reference_scene *scene)
{
    if (r == PARIAN_OK) {
        return parian_reference_scene_make(env, parts->bodies, parts->body_count,
                                           parts->surroundings, parts->surrounding_count, lights,
                                           light_count, scene);
    }
    parian_reference_scene half = {.body_count = parts->body_count,
                                   .surrounding_count = parts->surrounding_count,
                                   .bodies = parts->bodies,
                                   .surroundings = parts->surroundings};
    parian_reference_scene_free(env, &half);
    return r;
}

/* ---- from a model ---- */

static parian_result import_source(const parian_env *env, const parian_bake_desc *desc,
                                   parian_source_scene *source, parian_selection *selection)
{
    parian_result r = parian_import(env, desc->input, source);
    if (r == PARIAN_OK) {
        r = parian_select_bodies(env, desc, source, selection);
    }
    if (r == PARIAN_OK) {
        r = parian_scale_scene(env, desc, selection, source);
    }
    return r;
}

static void take_mesh(parian_mesh *to, parian_mesh *from)
{
    *to = *from;
    *from = (parian_mesh){0};
}

/* The surface as a bake sees it before it is decimated. */
static parian_result take_body(const parian_env *env, const char *file, parian_source_part *part,
                               bool several, const parian_medium *medium,
                               parian_reference_body *body)
{
    const parian_env none = {0};
    parian_named_env named;
    parian_surface_report report;
    parian_named_env_init(&named, env ? env : &none, file, part->name, several);
    memcpy(body->name, part->name, sizeof body->name);
    body->medium = *medium;
    take_mesh(&body->mesh, &part->mesh);
    parian_result r = parian_stage_surface(&named.env, &body->mesh, &report);
    if (r == PARIAN_OK) {
        r = parian_mesh_make_corner_normals(env, &body->mesh, PARIAN_CREASE_DEG);
    }
    return r;
}

static parian_result gather_model(const parian_env *env, const parian_bake_desc *desc,
                                  parian_source_scene *source, const parian_selection *selection,
                                  scene_parts *parts)
{
    uint32_t body = 0, surrounding = 0;
    parian_result r = allocate_parts(env, selection->body_count,
                                     source->part_count - selection->body_count, parts);
    for (uint32_t p = 0; r == PARIAN_OK && p < source->part_count; p++) {
        if (selection->is_body[p]) {
            r = take_body(env, desc->input, &source->parts[p], source->part_count > 1,
                          &selection->medium[p], &parts->bodies[body++]);
        } else {
            take_mesh(&parts->surroundings[surrounding++], &source->parts[p].mesh);
        }
    }
    return r;
}

static parian_result load_model(const parian_env *env, const parian_bake_desc *desc,
                                const parian_light *lights, uint32_t light_count,
                                parian_reference_scene *scene)
{
    parian_source_scene source = {0};
    parian_selection selection = {0};
    scene_parts parts = {0};
    parian_result r = import_source(env, desc, &source, &selection);
    if (r == PARIAN_OK) {
        r = gather_model(env, desc, &source, &selection, &parts);
    }
    r = use_parts(env, r, &parts, lights ? lights : source.lights,
                  lights ? light_count : source.light_count, scene);
    parian_selection_free(env, &selection);
    parian_source_scene_free(env, &source);
    return r;
}

/* ---- from an asset ---- */

static parian_result widen_mesh(const parian_env *env, uint32_t vertex_count,
                                uint32_t triangle_count, const float (*position)[3],
                                const uint32_t (*triangle)[3], const float (*corner_normal)[3][3],
                                parian_mesh *mesh)
{
    if (!PARIAN_NEW(env, mesh->position, vertex_count) ||
        !PARIAN_NEW(env, mesh->triangle, triangle_count) ||
        !PARIAN_NEW(env, mesh->corner_normal, triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u triangles", triangle_count);
    }
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
    for (uint32_t v = 0; v < vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            mesh->position[v][k] = (double)position[v][k];
        }
    }
    if (triangle_count > 0) {
        memcpy(mesh->triangle, triangle, triangle_count * sizeof *triangle);
        memcpy(mesh->corner_normal, corner_normal, triangle_count * sizeof *corner_normal);
    }
    return PARIAN_OK;
}

static parian_result gather_asset(const parian_env *env, const parian_scene_data *data,
                                  scene_parts *parts)
{
    parian_result r = allocate_parts(env, data->body_count, data->surrounding_count, parts);
    for (uint32_t b = 0; r == PARIAN_OK && b < data->body_count; b++) {
        const parian_body *from = &data->bodies[b];
        parian_reference_body *to = &parts->bodies[b];
        memcpy(to->name, from->name, sizeof to->name);
        to->medium = from->medium;
        to->fit_fdr = from->fit_fdr;
        r = widen_mesh(env, from->vertex_count, from->triangle_count,
                       (const float(*)[3])from->vertex_position,
                       (const uint32_t(*)[3])from->triangle,
                       (const float(*)[3][3])from->corner_normal, &to->mesh);
    }
    for (uint32_t s = 0; r == PARIAN_OK && s < data->surrounding_count; s++) {
        const parian_surrounding *from = &data->surroundings[s];
        r = widen_mesh(env, from->vertex_count, from->triangle_count,
                       (const float(*)[3])from->vertex_position,
                       (const uint32_t(*)[3])from->triangle,
                       (const float(*)[3][3])from->corner_normal, &parts->surroundings[s]);
    }
    return r;
}

static parian_result read_asset(const parian_env *env, const char *path, parian_scene_data *data)
{
    parian_reader *reader = NULL;
    parian_result r = parian_reader_open(env, path, NULL, &reader);
    if (r == PARIAN_OK) {
        r = parian_scene_data_read(env, reader, data);
    }
    parian_reader_close(reader);
    return r;
}

/* The asset's own lights. Their pictures could not outlive this function, and writers store none.
 */
static parian_result read_own_lights(const parian_env *env, const char *path,
                                     const parian_scene_data *data, parian_light_set *set)
{
    if (!data->lights_json) {
        return PARIAN_OK;
    }
    parian_result r = parian_lights_parse(env, data->lights_json, NULL, set);
    for (size_t i = 0; r == PARIAN_OK && i < set->count; i++) {
        if (set->light[i].image.pixel) {
            r = parian_fail(env, PARIAN_E_UNSUPPORTED,
                            "%s: light %zu has a picture, expected none in an asset", path, i);
        }
    }
    return r;
}

static parian_result load_asset(const parian_env *env, const parian_bake_desc *desc,
                                const parian_light *lights, uint32_t light_count,
                                parian_reference_scene *scene)
{
    parian_scene_data data = {0};
    parian_light_set own = {0};
    scene_parts parts = {0};
    if (desc->material_count > 0 || desc->scale_m > 0 || desc->unit_m > 0) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "%s: an asset has its own media and size; those given are ignored", desc->input);
    }
    parian_result r = read_asset(env, desc->input, &data);
    if (r == PARIAN_OK && !lights) {
        r = read_own_lights(env, desc->input, &data, &own);
    }
    if (r == PARIAN_OK) {
        r = gather_asset(env, &data, &parts);
    }
    r = use_parts(env, r, &parts, lights ? lights : own.light,
                  lights ? light_count : (uint32_t)own.count, scene);
    parian_light_set_free(env, &own);
    parian_scene_data_free(env, &data);
    return r;
}

static bool is_asset(const char *path)
{
    static const char extension[] = ".parian";
    size_t length = strlen(path), tail = sizeof extension - 1;
    return length > tail && strcasecmp(path + length - tail, extension) == 0;
}

parian_result parian_reference_scene_load(const parian_env *env, const parian_bake_desc *desc,
                                          const parian_light *lights, uint32_t light_count,
                                          parian_reference_scene *scene)
{
    return is_asset(desc->input) ? load_asset(env, desc, lights, light_count, scene)
                                 : load_model(env, desc, lights, light_count, scene);
}
