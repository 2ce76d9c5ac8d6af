/* view_picture.c - pictures that the player makes itself: atlases laid flat, and errors against a
 * reference.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_picture.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "tool/picture.h"
#include "view_atlas.h"

void parian_view_picture_free(parian_view_app *app)
{
    parian_free(app->env, app->picture.radiance);
    parian_free(app->env, app->picture.srgb);
    app->picture = (parian_view_picture){0};
}

static parian_result make_room(parian_view_app *app, uint32_t width, uint32_t height)
{
    const size_t count = (size_t)width * height;
    parian_view_picture_free(app);
    if (!PARIAN_NEW(app->env, app->picture.radiance, count) ||
        !PARIAN_NEW(app->env, app->picture.srgb, count)) {
        parian_view_picture_free(app);
        return parian_fail(app->env, PARIAN_E_NOMEM, "no memory for a picture of %u x %u pixels",
                           width, height);
    }
    app->picture.width = width;
    app->picture.height = height;
    return PARIAN_OK;
}

enum { UNCOVERED = 40 }; /* grey, 8-bit code */

/* The identity below 0.76, then ever flatter towards 1; NaN is 0. */
static float shoulder(float value)
{
    const float start = 0.76f, room = 0.24f;
    return value <= start ? fmaxf(value, 0) : 1 - room * room / (value - start + room);
}

static void encode(parian_view_picture *picture, float exposure, bool curve)
{
    const size_t count = (size_t)picture->width * picture->height;
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            const float value = exposure * picture->radiance[i][c];
            picture->srgb[i][c] = parian_srgb_encode(curve ? shoulder(value) : value);
        }
        if (!(picture->radiance[i][3] > 0)) { /* what is not covered is told from what is dark */
            memset(picture->srgb[i], UNCOVERED, 3);
        }
        picture->srgb[i][3] = (uint8_t)lrintf(255 * fminf(fmaxf(picture->radiance[i][3], 0), 1));
    }
}

/* Factor that brings the mean of what is covered to 0.18. */
static float auto_exposure(const parian_view_picture *picture)
{
    double sum = 0, weight = 0;
    for (size_t i = 0; i < (size_t)picture->width * picture->height; i++) {
        const float *p = picture->radiance[i];
        sum += (double)p[3] * ((double)p[0] + (double)p[1] + (double)p[2]) / 3;
        weight += (double)p[3];
    }
    return sum > 0 ? (float)(0.18 * weight / sum) : 1;
}

parian_result parian_view_picture_atlas(parian_view_app *app, uint32_t width, uint32_t height)
{
    const bool charts = app->display == PARIAN_DISPLAY_ATLAS_CHARTS;
    parian_result result = make_room(app, width, height);
    if (result == PARIAN_OK) {
        result = parian_view_atlas_draw(app->env, app->scene, app->renderer, app->display, width,
                                        height, app->picture.radiance);
    }
    if (result != PARIAN_OK) {
        parian_view_picture_free(app);
        return result;
    }
    const float automatic = app->exposure_auto ? auto_exposure(&app->picture) : 1;
    encode(&app->picture, charts ? 1 : automatic * exp2f(app->exposure_ev), !charts);
    return PARIAN_OK;
}

static parian_result paint(parian_view_app *app, float (*position)[3], float (*normal)[3],
                           float (*radiosity)[3])
{
    const parian_texel_arrays arrays = {
        .position = position, .normal = normal, .radiosity = radiosity};
    const parian_view_points texels = {app->info.texel_count, (const float(*)[3])position,
                                       (const float(*)[3])normal};
    parian_result result = parian_renderer_read_texels(app->renderer, &arrays);
    if (result == PARIAN_OK) { /* the colours take the place of the positions */
        result = parian_view_reference_paint(app->env, &app->reference, &texels,
                                             (const float(*)[3])radiosity, app->error_scale,
                                             position, &app->error);
    }
    return result == PARIAN_OK
               ? parian_renderer_set_values(app->renderer, (const float(*)[3])position)
               : result;
}

parian_result parian_view_picture_paint_error(parian_view_app *app)
{
    float(*position)[3] = NULL, (*normal)[3] = NULL, (*radiosity)[3] = NULL;
    const uint64_t count = app->info.texel_count;
    parian_result result = PARIAN_OK;
    if (app->reference.count == 0) {
        return parian_fail(app->env, PARIAN_E_ARGUMENT, "the error view needs a --reference");
    }
    if (!app->error_stale) {
        return PARIAN_OK;
    }
    if (!PARIAN_NEW(app->env, position, count) || !PARIAN_NEW(app->env, normal, count) ||
        !PARIAN_NEW(app->env, radiosity, count)) {
        result = parian_fail(app->env, PARIAN_E_NOMEM, "no memory for the error of %llu texels",
                             (unsigned long long)count);
    } else {
        result = paint(app, position, normal, radiosity);
    }
    app->error_stale = result != PARIAN_OK;
    parian_free(app->env, position);
    parian_free(app->env, normal);
    parian_free(app->env, radiosity);
    return result;
}

static void decode(parian_view_picture *picture)
{
    for (size_t i = 0; i < (size_t)picture->width * picture->height; i++) {
        for (int c = 0; c < 3; c++) {
            picture->radiance[i][c] = parian_srgb_decode(picture->srgb[i][c]);
        }
    }
}

parian_result parian_view_picture_compare(parian_view_app *app, uint32_t width, uint32_t height)
{
    const parian_view_reference *reference = &app->reference;
    if (reference->width != width || reference->height != height) {
        return parian_fail(app->env, PARIAN_E_ARGUMENT,
                           "the reference is a picture of %u x %u pixels, this one is %u x %u",
                           reference->width, reference->height, width, height);
    }
    parian_result result = make_room(app, width, height);
    if (result == PARIAN_OK) {
        result = parian_renderer_read_picture(app->renderer,
                                              reference->encoded ? NULL : app->picture.radiance,
                                              reference->encoded ? app->picture.srgb : NULL);
    }
    if (result != PARIAN_OK) {
        parian_view_picture_free(app);
        return result;
    }
    if (reference->encoded) {
        decode(&app->picture);
    }
    parian_view_reference_compare(reference, (const float(*)[4])app->picture.radiance,
                                  app->error_scale, app->picture.radiance, &app->error);
    encode(&app->picture, 1, false);
    return PARIAN_OK;
}
