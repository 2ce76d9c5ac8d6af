/* path_checkpoint.c - writes and reads the state of a run; native byte order, guarded by two
 * checksums.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_checkpoint.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include <xxhash.h>

#include "core/memory.h"
#include "tool/files.h"

static const char MAGIC[8] = {'P', 'R', 'N', 'P', 'A', 'T', 'H', '1'};

typedef struct checkpoint_head {
    char magic[8];
    uint64_t settings; /* parian_path_hash */
    uint64_t checksum; /* of what follows the head */
    uint64_t count;
    parian_path_counters now;
} checkpoint_head;

parian_result parian_path_state_make(const parian_env *env, size_t count, parian_path_state *state)
{
    *state = (parian_path_state){.count = count};
    if (!PARIAN_NEW0(env, state->adjoint, count) || !PARIAN_NEW0(env, state->forward, count)) {
        parian_path_state_free(env, state);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu receivers", count);
    }
    return PARIAN_OK;
}

void parian_path_state_free(const parian_env *env, parian_path_state *state)
{
    if (state) {
        parian_free(env, state->adjoint);
        parian_free(env, state->forward);
        *state = (parian_path_state){0};
    }
}

/* ---- what a run depends on ---- */

static void add(XXH3_state_t *hash, const void *data, size_t size)
{
    XXH3_64bits_update(hash, data, size);
}

static void add_mesh(XXH3_state_t *hash, const parian_mesh *mesh)
{
    add(hash, &mesh->vertex_count, sizeof mesh->vertex_count);
    add(hash, &mesh->triangle_count, sizeof mesh->triangle_count);
    add(hash, mesh->position, mesh->vertex_count * sizeof *mesh->position);
    add(hash, mesh->triangle, mesh->triangle_count * sizeof *mesh->triangle);
}

static void add_body(XXH3_state_t *hash, const parian_reference_body *body)
{
    const parian_medium *m = &body->medium;
    const parian_medium_field *f = body->field;
    uint32_t flags = (m->reduced_only ? 1u : 0) | (f ? 2u : 0);
    add_mesh(hash, &body->mesh);
    add(hash, m->sigma_s_prime, sizeof m->sigma_s_prime);
    add(hash, m->sigma_a, sizeof m->sigma_a);
    add(hash, m->g, sizeof m->g);
    add(hash, &m->eta, sizeof m->eta);
    add(hash, &flags, sizeof flags);
    if (f) {
        size_t count = (size_t)f->size[0] * f->size[1] * f->size[2];
        add(hash, f->size, sizeof f->size);
        add(hash, f->lower, sizeof f->lower);
        add(hash, f->upper, sizeof f->upper);
        add(hash, f->sigma_s, count * sizeof *f->sigma_s);
        add(hash, f->sigma_a, count * sizeof *f->sigma_a);
    }
}

static void add_light(XXH3_state_t *hash, const parian_light *light)
{
    uint32_t type = (uint32_t)light->type;
    const parian_light_image *image = &light->image;
    add(hash, &type, sizeof type);
    add(hash, light->position, sizeof light->position);
    add(hash, light->direction, sizeof light->direction);
    add(hash, light->up, sizeof light->up);
    add(hash, light->color, sizeof light->color);
    add(hash, &light->inner_deg, sizeof light->inner_deg);
    add(hash, &light->outer_deg, sizeof light->outer_deg);
    add(hash, light->axis_u, sizeof light->axis_u);
    add(hash, light->axis_v, sizeof light->axis_v);
    add(hash, &light->rotation_deg, sizeof light->rotation_deg);
    if (image->pixel) {
        add(hash, &image->width, sizeof image->width);
        add(hash, &image->height, sizeof image->height);
        add(hash, image->pixel, (size_t)image->width * image->height * sizeof *image->pixel);
    }
}

static void add_settings(XXH3_state_t *hash, const parian_path_desc *desc)
{
    uint64_t numbers[3] = {desc->samples, desc->seed, (uint64_t)desc->walk};
    double lengths[2] = {desc->standard_error, desc->patch};
    add(hash, numbers, sizeof numbers);
    add(hash, lengths, sizeof lengths);
}

parian_result parian_path_hash(const parian_env *env, const parian_reference_scene *scene,
                               const parian_receivers *receivers, const parian_path_desc *desc,
                               uint64_t *hash)
{
    XXH3_state_t *state = XXH3_createState();
    if (!state) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a checksum");
    }
    XXH3_64bits_reset(state);
    for (uint32_t b = 0; b < scene->body_count; b++) {
        add_body(state, &scene->bodies[b]);
    }
    for (uint32_t s = 0; s < scene->surrounding_count; s++) {
        add_mesh(state, &scene->surroundings[s]);
    }
    for (uint32_t l = 0; l < scene->light_count; l++) {
        add_light(state, &scene->lights[l]);
    }
    add(state, receivers->body, receivers->count * sizeof *receivers->body);
    add(state, receivers->triangle, receivers->count * sizeof *receivers->triangle);
    add(state, receivers->barycentric, receivers->count * sizeof *receivers->barycentric);
    add_settings(state, desc);
    *hash = XXH3_64bits_digest(state);
    XXH3_freeState(state);
    return PARIAN_OK;
}

/* ---- the file ---- */

static parian_result checksum_of(const parian_env *env, const checkpoint_head *head,
                                 const parian_path_state *state, uint64_t *checksum)
{
    XXH3_state_t *hash = XXH3_createState();
    if (!hash) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a checksum");
    }
    XXH3_64bits_reset(hash);
    add(hash, &head->now, sizeof head->now);
    add(hash, state->adjoint, state->count * sizeof *state->adjoint);
    add(hash, state->forward, state->count * sizeof *state->forward);
    *checksum = XXH3_64bits_digest(hash);
    XXH3_freeState(hash);
    return PARIAN_OK;
}

parian_result parian_path_checkpoint_write(const parian_env *env, const char *path, uint64_t hash,
                                           const parian_path_state *state)
{
    checkpoint_head head = {.settings = hash, .count = state->count, .now = state->now};
    memcpy(head.magic, MAGIC, sizeof MAGIC);
    parian_result r = checksum_of(env, &head, state, &head.checksum);
    if (r != PARIAN_OK) {
        return r;
    }
    parian_piece piece[3] = {{&head, sizeof head},
                             {state->adjoint, state->count * sizeof *state->adjoint},
                             {state->forward, state->count * sizeof *state->forward}};
    return parian_file_write_pieces(env, path, piece, 3);
}

static parian_result take_over(const parian_env *env, const char *path, uint64_t hash,
                               const uint8_t *data, size_t size, parian_path_state *state)
{
    checkpoint_head head;
    size_t array = state->count * sizeof *state->adjoint;
    uint64_t checksum = 0;
    if (size < sizeof head || memcmp(data, MAGIC, sizeof MAGIC) != 0) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: not a path tracing checkpoint", path);
    }
    memcpy(&head, data, sizeof head);
    if (head.settings != hash || head.count != state->count) {
        return parian_fail(
            env, PARIAN_E_FORMAT,
            "%s: the checkpoint is of another scene, other receivers, lights or settings", path);
    }
    if (size != sizeof head + 2 * array) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: %zu bytes, expected %zu", path, size,
                           sizeof head + 2 * array);
    }
    memcpy(state->adjoint, data + sizeof head, array);
    memcpy(state->forward, data + sizeof head + array, array);
    parian_result r = checksum_of(env, &head, state, &checksum);
    if (r == PARIAN_OK && checksum != head.checksum) {
        r = parian_fail(env, PARIAN_E_FORMAT, "%s: the checkpoint is damaged: wrong checksum",
                        path);
    }
    state->now = head.now;
    return r;
}

parian_result parian_path_checkpoint_read(const parian_env *env, const char *path, uint64_t hash,
                                          parian_path_state *state)
{
    uint8_t *data = NULL;
    size_t size = 0, expected = sizeof(checkpoint_head) + 2 * state->count * sizeof *state->adjoint;
    if (access(path, F_OK) != 0 && errno == ENOENT) {
        return PARIAN_OK;
    }
    parian_result r = parian_file_read(env, path, (uint64_t)expected + 1, &data, &size);
    if (r == PARIAN_E_LIMIT) {
        return PARIAN_E_FORMAT; /* larger than this run's; said by the reader */
    }
    if (r == PARIAN_OK) {
        r = take_over(env, path, hash, data, size, state);
        parian_free(env, data);
    }
    return r;
}
