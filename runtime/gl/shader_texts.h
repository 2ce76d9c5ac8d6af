/* shader_texts.h - the embedded files of runtime/shaders, by name without extension.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_GL_SHADER_TEXTS_H
#define PARIAN_GL_SHADER_TEXTS_H

#include <stddef.h>

typedef struct parian_shader_text {
    const char *name, *text;
} parian_shader_text;

extern const parian_shader_text parian_shader_texts[];
extern const size_t parian_shader_text_count;

#endif
