/* nasty.h - damaged files are put together in a growing block of bytes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ASSETS_NASTY_H
#define PARIAN_ASSETS_NASTY_H

#include <stdbool.h>
#include <stddef.h>

#include "model_mesh.h"

typedef struct blob {
    const parian_env *env;
    unsigned char *data;
    size_t size, capacity;
    bool failed; /* no memory: further additions do nothing */
} blob;

void blob_add(blob *b, const void *data, size_t size);
void blob_release(blob *b);
void blob_add_u32(blob *b, uint32_t value);
void blob_add_f32(blob *b, float value);
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void blob_print(blob *b, const char *format, ...);
/* A uniform number in [0, 1) for this index; the same everywhere. */
double blob_random(uint32_t index);

/* A generator fills the blob; `ball` is a small closed sphere of radius 1 to start from. */
typedef struct nasty_entry {
    const char *name;
    /* What a bake with --scale 50mm must answer: 3 refuses, 0 bakes (with a warning), -1 either. */
    int status;
    void (*make)(blob *b, const model_mesh *ball);
} nasty_entry;

extern const nasty_entry nasty_model_table[], nasty_glb_table[];
extern const size_t nasty_model_count, nasty_glb_count;

#endif
