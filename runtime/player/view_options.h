/* view_options.h - the command line of parian-view.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_OPTIONS_H
#define PARIAN_VIEW_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"
#include "tool/options.h"
#include "view_display.h"

typedef enum parian_view_gl {
    PARIAN_VIEW_GL_ANY = 0,
    PARIAN_VIEW_GL_CORE = 1,
    PARIAN_VIEW_GL_ES = 2
} parian_view_gl;

typedef struct parian_view_options {
    parian_common_options common;
    const char *asset;
    bool headless, cpu, no_specular;
    int gl;                                                    /* parian_view_gl */
    parian_view_display displays[PARIAN_DISPLAY_COUNT];        /* of --view */
    size_t display_count;                                      /* at least 1 */
    const char *lights_file, *camera, *image, *dump, *timings; /* NULL when not given */
    const char *camera_path, *reference;
    parian_string_list lights;          /* of --light */
    uint32_t frames, turntable, refine; /* 0 when not given */
    double error_scale;                 /* of the error view, over the mean of the reference */
    uint32_t width, height;
    bool exposure_auto;
    double exposure_ev;
    const char *medium;   /* name or file; NULL: as baked */
    double size_factor;   /* 0: as baked */
    double tint[3];       /* zeros: none */
    int tone;             /* parian_tone */
    double roughness;     /* 0: the renderer's default */
    double background[3]; /* negative: in proportion to the lights */
    /* As typed, until they are checked. */
    const char *size_text, *exposure_text, *background_text, *method_text, *view_text, *tint_text;
} parian_view_options;

/* Parse; mistakes are told on stderr. After --help or --version options->common says so. */
parian_result parian_view_options_parse(int argc, char **argv, parian_view_options *options);

/* Check the values that have a form of their own, before any work. Errors: PARIAN_E_ARGUMENT,
 * PARIAN_E_UNSUPPORTED (a method that is not built yet). */
parian_result parian_view_options_check(const parian_env *env, parian_view_options *options);

/* True when a path names a picture of this kind (".png", ".exr"), in any case. */
bool parian_view_path_ends(const char *path, const char *ending);

#endif
