/* block_codec.h - codes and decodes one block of a chunk: byte transforms and zstd.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_BLOCK_CODEC_H
#define PARIAN_BLOCK_CODEC_H

#include "parian/format.h"

/* What one thread needs for it: a zstd context and room for a transformed block. */
typedef struct parian_block_coder {
    void *context; /* ZSTD_CCtx or ZSTD_DCtx; its memory is malloc's */
    uint8_t *transformed;
} parian_block_coder;

/* size_max: bytes of the largest block that it will meet. Errors: PARIAN_E_NOMEM. */
parian_result parian_block_encoder_create(const parian_env *env, size_t size_max,
                                          parian_block_coder *coder);
parian_result parian_block_decoder_create(const parian_env *env, size_t size_max,
                                          parian_block_coder *coder);
void parian_block_encoder_destroy(const parian_env *env, parian_block_coder *coder);
void parian_block_decoder_destroy(const parian_env *env, parian_block_coder *coder);

/* Code size bytes (1 to PARIAN_BLOCK_SIZE, whole elements) into coded [size]. *coded_size is less
 * than size, or equal to it where coding saves nothing and the plain bytes are to be stored.
 * Errors: PARIAN_E_NOMEM. */
parian_result parian_block_encode(parian_block_coder *coder, parian_codec codec,
                                  size_t element_size, int level, const uint8_t *plain, size_t size,
                                  uint8_t *coded, size_t *coded_size);

/* Decode one zstd frame into exactly size bytes. Returns 0 or the number of the violated rule. */
int parian_block_decode(parian_block_coder *coder, parian_codec codec, size_t element_size,
                        const uint8_t *coded, size_t coded_size, uint8_t *plain, size_t size);

#endif
