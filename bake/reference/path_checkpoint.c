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

#include "bake/reference/scene_hash.h"
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

parian_result parian_path_hash(const parian_env *env, const parian_reference_scene *scene,
                               const parian_receivers *receivers, const parian_path_desc *desc,
                               uint64_t *hash)
{
    struct {
        uint64_t scene[2], samples, seed, walk;
        double standard_error, patch;
    } all = {.samples = desc->samples,
             .seed = desc->seed,
             .walk = (uint64_t)desc->walk,
             .standard_error = desc->standard_error,
             .patch = desc->patch};
    parian_result r = parian_reference_scene_hash(env, scene, receivers, all.scene);
    if (r == PARIAN_OK) {
        *hash = XXH3_64bits(&all, sizeof all);
    }
    return r;
}

static void add(XXH3_state_t *hash, const void *data, size_t size)
{
    XXH3_64bits_update(hash, data, size);
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
