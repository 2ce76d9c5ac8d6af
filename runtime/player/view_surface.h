/* view_surface.h - a picture that stays on the GPU between frames, so that the panel can be drawn
 * anew over it without shading.
 *
 * In the thread of the GL context. GL state is left with the default framebuffer bound.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_SURFACE_H
#define PARIAN_VIEW_SURFACE_H

#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_view_surface parian_view_surface;

/* Errors: PARIAN_E_NOMEM, PARIAN_E_UNSUPPORTED (a missing function, named). */
parian_result parian_view_surface_create(const parian_env *env,
                                         void *(*get_proc_address)(const char *name),
                                         parian_view_surface **surface);
void parian_view_surface_destroy(parian_view_surface *surface);

/* Make it width x height pixels; nothing when it is. What it showed is lost. */
void parian_view_surface_resize(parian_view_surface *surface, uint32_t width, uint32_t height);
/* Name of the framebuffer to draw to; row 0 is at the bottom. */
uint32_t parian_view_surface_framebuffer(const parian_view_surface *surface);
/* Replace the picture: [height * width], rows from top to bottom; a scratch of its size is made. */
parian_result parian_view_surface_upload(parian_view_surface *surface, const uint8_t (*srgb)[4]);
/* Copy it to a window of width x height pixels, right of column x, stretched where it is smaller;
 * dark grey where there is no picture. */
void parian_view_surface_show(const parian_view_surface *surface, uint32_t x, uint32_t width,
                              uint32_t height);
/* Read the window as it is, before the buffers are swapped: [height * width], rows from top to
 * bottom. Errors: PARIAN_E_NOMEM. */
parian_result parian_view_surface_read_window(const parian_view_surface *surface, uint32_t width,
                                              uint32_t height, uint8_t (*srgb)[4]);

#endif
