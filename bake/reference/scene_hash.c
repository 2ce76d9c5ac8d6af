/* scene_hash.c - feeds a scene's arrays to XXH3, each after its count, so that no two scenes look
 * alike.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/scene_hash.h"

#include <xxhash.h>

#include "core/memory.h"

static void add(XXH3_state_t *hash, const void *data, size_t size)
{
    if (size > 0) {
        XXH3_128bits_update(hash, data, size);
    }
}

static void add_count(XXH3_state_t *hash, uint64_t count)
{
    add(hash, &count, sizeof count);
}

static void add_mesh(XXH3_state_t *hash, const parian_mesh *mesh)
{
    add_count(hash, mesh->vertex_count);
    add_count(hash, mesh->triangle_count);
    add_count(hash, mesh->corner_normal != NULL);
    add(hash, mesh->position, mesh->vertex_count * sizeof *mesh->position);
    add(hash, mesh->triangle, mesh->triangle_count * sizeof *mesh->triangle);
    if (mesh->corner_normal) {
        add(hash, mesh->corner_normal, mesh->triangle_count * sizeof *mesh->corner_normal);
    }
}

static void add_medium(XXH3_state_t *hash, const parian_medium *medium)
{
    add(hash, medium->sigma_s_prime, sizeof medium->sigma_s_prime);
    add(hash, medium->sigma_a, sizeof medium->sigma_a);
    add(hash, medium->g, sizeof medium->g);
    add(hash, &medium->eta, sizeof medium->eta);
    add_count(hash, medium->reduced_only);
}

static void add_field(XXH3_state_t *hash, const parian_medium_field *field)
{
    add_count(hash, field != NULL);
    if (field) {
        size_t nodes = (size_t)field->size[0] * field->size[1] * field->size[2];
        add(hash, field->size, sizeof field->size);
        add(hash, field->lower, sizeof field->lower);
        add(hash, field->upper, sizeof field->upper);
        add(hash, field->sigma_s, nodes * sizeof *field->sigma_s);
        add(hash, field->sigma_a, nodes * sizeof *field->sigma_a);
    }
}

static void add_light(XXH3_state_t *hash, const parian_light *light)
{
    const parian_light_image *image = &light->image;
    add_count(hash, (uint64_t)light->type);
    add(hash, light->position, sizeof light->position);
    add(hash, light->direction, sizeof light->direction);
    add(hash, light->up, sizeof light->up);
    add(hash, light->color, sizeof light->color);
    add(hash, light->axis_u, sizeof light->axis_u);
    add(hash, light->axis_v, sizeof light->axis_v);
    add(hash, &light->inner_deg, sizeof light->inner_deg);
    add(hash, &light->outer_deg, sizeof light->outer_deg);
    add(hash, &light->rotation_deg, sizeof light->rotation_deg);
    add_count(hash, image->pixel != NULL);
    if (image->pixel) {
        add_count(hash, image->width);
        add(hash, image->pixel, (size_t)image->width * image->height * sizeof *image->pixel);
    }
}

static void add_scene(XXH3_state_t *hash, const parian_reference_scene *scene)
{
    add_count(hash, scene->body_count);
    for (uint32_t b = 0; b < scene->body_count; b++) {
        add_mesh(hash, &scene->bodies[b].mesh);
        add_medium(hash, &scene->bodies[b].medium);
        add_field(hash, scene->bodies[b].field);
    }
    add_count(hash, scene->surrounding_count);
    for (uint32_t s = 0; s < scene->surrounding_count; s++) {
        add_mesh(hash, &scene->surroundings[s]);
    }
    add_count(hash, scene->light_count);
    for (uint32_t l = 0; l < scene->light_count; l++) {
        add_light(hash, &scene->lights[l]);
    }
}

static void add_receivers(XXH3_state_t *hash, const parian_receivers *receivers)
{
    size_t n = receivers->count;
    add_count(hash, n);
    add(hash, receivers->position, n * sizeof *receivers->position);
    add(hash, receivers->normal, n * sizeof *receivers->normal);
    add(hash, receivers->smooth_normal, n * sizeof *receivers->smooth_normal);
    add(hash, receivers->area, n * sizeof *receivers->area);
    add(hash, receivers->body, n * sizeof *receivers->body);
    add(hash, receivers->triangle, n * sizeof *receivers->triangle);
    add(hash, receivers->barycentric, n * sizeof *receivers->barycentric);
}

parian_result parian_reference_scene_hash(const parian_env *env,
                                          const parian_reference_scene *scene,
                                          const parian_receivers *receivers, uint64_t hash[2])
{
    XXH3_state_t *state = XXH3_createState();
    if (!state) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a checksum");
    }
    XXH3_128bits_reset(state);
    add_scene(state, scene);
    add_receivers(state, receivers);
    XXH128_hash_t digest = XXH3_128bits_digest(state);
    hash[0] = digest.low64;
    hash[1] = digest.high64;
    XXH3_freeState(state);
    return PARIAN_OK;
}
