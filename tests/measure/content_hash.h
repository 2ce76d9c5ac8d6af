/* content_hash.h - names of cached results, made from everything that they depend on.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_CONTENT_HASH_H
#define PARIAN_MEASURE_CONTENT_HASH_H

#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

enum { PARIAN_HASH_TEXT_MAX = 33 }; /* 32 hexadecimal digits: XXH3-128 */

typedef struct parian_content_hash parian_content_hash;

/* Errors: PARIAN_E_NOMEM. */
parian_result parian_content_hash_begin(const parian_env *env, parian_content_hash **hash);
/* Every piece counts with its size, so that moving bytes from one piece to the next changes the
 * hash. */
void parian_content_hash_add(parian_content_hash *hash, const void *data, size_t size);
void parian_content_hash_text(parian_content_hash *hash, const char *text);
void parian_content_hash_number(parian_content_hash *hash, double number);
void parian_content_hash_count(parian_content_hash *hash, uint64_t count);
/* The bytes of a file, not its name. Errors: PARIAN_E_IO. */
parian_result parian_content_hash_file(const parian_env *env, parian_content_hash *hash,
                                       const char *path);
/* Write the digits and free the hash; text may be NULL. */
void parian_content_hash_end(parian_content_hash *hash, char text[PARIAN_HASH_TEXT_MAX]);

#endif
