/* view_outputs.c - writes pictures, and the per-texel arrays of --dump.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/picture.h"
#include "view_app.h"

/* The picture of the last draw, whoever made it. Either may be NULL. */
static parian_result read_picture(parian_view_app *app, float (*radiance)[4], uint8_t (*srgb)[4])
{
    const parian_view_picture *own = &app->picture;
    const size_t count = (size_t)own->width * own->height;
    if (count == 0) {
        return parian_renderer_read_picture(app->renderer, radiance, srgb);
    }
    if (radiance) {
        memcpy(radiance, own->radiance, count * sizeof *radiance);
    }
    if (srgb) {
        memcpy(srgb, own->srgb, count * sizeof *srgb);
    }
    return PARIAN_OK;
}

static parian_result write_exr(parian_view_app *app, const char *path, uint32_t width,
                               uint32_t height)
{
    float(*radiance)[4];
    if (!PARIAN_NEW(app->env, radiance, (size_t)width * height)) {
        return parian_fail(app->env, PARIAN_E_NOMEM, "no memory for a picture of %u x %u", width,
                           height);
    }
    parian_result result = read_picture(app, radiance, NULL);
    if (result == PARIAN_OK) {
        result = parian_exr_write(app->env, path, width, height, (const float(*)[4])radiance);
    }
    parian_free(app->env, radiance);
    return result;
}

static parian_result write_png(parian_view_app *app, const char *path, uint32_t width,
                               uint32_t height)
{
    uint8_t(*srgb)[4];
    if (!PARIAN_NEW(app->env, srgb, (size_t)width * height)) {
        return parian_fail(app->env, PARIAN_E_NOMEM, "no memory for a picture of %u x %u", width,
                           height);
    }
    parian_result result = read_picture(app, NULL, srgb);
    for (size_t i = 0; i < (size_t)width * height && result == PARIAN_OK; i++) {
        srgb[i][3] =
            255; /* the background is part of the picture; coverage goes to the EXR alone */
    }
    if (result == PARIAN_OK) {
        result = parian_png_write(app->env, path, width, height, (const uint8_t(*)[4])srgb);
    }
    parian_free(app->env, srgb);
    return result;
}

parian_result parian_view_write_image(parian_view_app *app, const char *path, uint32_t width,
                                      uint32_t height)
{
    return parian_view_path_ends(path, ".exr") ? write_exr(app, path, width, height)
                                               : write_png(app, path, width, height);
}

/* ---- arrays ------------------------------------------------------------------------------------
 */
enum { DUMP_COUNT = 7 };
static const struct {
    const char *name;
    uint32_t width; /* numbers of a texel */
} dumps[DUMP_COUNT] = {
    {"texel_position.npy", 3},        {"texel_normal.npy", 3},    {"texel_area.npy", 1},
    {"texel_irradiance.npy", 3},      {"texel_radiosity.npy", 3}, {"texel_radiosity_local.npy", 3},
    {"texel_radiosity_global.npy", 3}};

static parian_result write_arrays(parian_view_app *app, const char *folder,
                                  float *const data[DUMP_COUNT])
{
    const uint64_t count = app->info.texel_count;
    parian_result result = parian_folder_create(app->env, folder);
    for (int i = 0; i < DUMP_COUNT && result == PARIAN_OK; i++) {
        const uint64_t shape[2] = {count, dumps[i].width};
        result = parian_npy_write(app->env, folder, dumps[i].name, PARIAN_ELEMENT_F32,
                                  dumps[i].width > 1 ? 2 : 1, shape, data[i]);
    }
    return result;
}

parian_result parian_view_write_dump(parian_view_app *app, const char *folder)
{
    float *data[DUMP_COUNT] = {NULL};
    parian_result result = PARIAN_OK;
    for (int i = 0; i < DUMP_COUNT && result == PARIAN_OK; i++) {
        data[i] = parian_alloc(app->env, app->info.texel_count, dumps[i].width * sizeof(float));
        result = data[i] ? PARIAN_OK
                         : parian_fail(app->env, PARIAN_E_NOMEM, "no memory for %s", dumps[i].name);
    }
    if (result == PARIAN_OK) {
        const parian_texel_arrays arrays = {.position = (float(*)[3])data[0],
                                            .normal = (float(*)[3])data[1],
                                            .area = data[2],
                                            .irradiance = (float(*)[3])data[3],
                                            .radiosity = (float(*)[3])data[4],
                                            .radiosity_local = (float(*)[3])data[5],
                                            .radiosity_global = (float(*)[3])data[6]};
        result = parian_renderer_read_texels(app->renderer, &arrays);
    }
    if (result == PARIAN_OK) {
        result = write_arrays(app, folder, data);
    }
    for (int i = 0; i < DUMP_COUNT; i++) {
        parian_free(app->env, data[i]);
    }
    return result;
}
