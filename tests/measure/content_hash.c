/* content_hash.c - XXH3-128 over pieces, as text.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/content_hash.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include <xxhash.h>

#include "core/memory.h"
#include "tool/files.h"

struct parian_content_hash {
    XXH3_state_t *state;
    parian_env env;
};

parian_result parian_content_hash_begin(const parian_env *env, parian_content_hash **hash)
{
    parian_content_hash *made = parian_zalloc(env, 1, sizeof *made);
    if (!made || !(made->state = XXH3_createState())) {
        parian_free(env, made);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a hash");
    }
    made->env = env ? *env : (parian_env){0};
    XXH3_128bits_reset(made->state);
    *hash = made;
    return PARIAN_OK;
}

void parian_content_hash_add(parian_content_hash *hash, const void *data, size_t size)
{
    uint64_t count = size;
    XXH3_128bits_update(hash->state, &count, sizeof count);
    if (size > 0) {
        XXH3_128bits_update(hash->state, data, size);
    }
}

void parian_content_hash_text(parian_content_hash *hash, const char *text)
{
    parian_content_hash_add(hash, text, strlen(text));
}

void parian_content_hash_number(parian_content_hash *hash, double number)
{
    parian_content_hash_add(hash, &number, sizeof number);
}

void parian_content_hash_count(parian_content_hash *hash, uint64_t count)
{
    parian_content_hash_add(hash, &count, sizeof count);
}

parian_result parian_content_hash_file(const parian_env *env, parian_content_hash *hash,
                                       const char *path)
{
    uint64_t value = 0;
    parian_result r = parian_file_hash(env, path, &value);
    if (r == PARIAN_OK) {
        parian_content_hash_count(hash, value);
    }
    return r;
}

void parian_content_hash_end(parian_content_hash *hash, char text[PARIAN_HASH_TEXT_MAX])
{
    if (!hash) {
        return;
    }
    if (text) {
        XXH128_hash_t value = XXH3_128bits_digest(hash->state);
        snprintf(text, PARIAN_HASH_TEXT_MAX, "%016" PRIx64 "%016" PRIx64, (uint64_t)value.high64,
                 (uint64_t)value.low64);
    }
    XXH3_freeState(hash->state);
    parian_env env = hash->env;
    parian_free(&env, hash);
}
