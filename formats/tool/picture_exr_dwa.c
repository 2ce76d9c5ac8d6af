/* picture_exr_dwa.c - reads DWA-compressed OpenEXR, which OpenEXRCore 3.1 cannot, through the
 * library's older C interface to half-float RGBA.
 *
 * SPDX-License-Identifier: MIT
 */
#include <ImfCRgbaFile.h>

#include "core/memory.h"
#include "tool/picture_internal.h"

typedef struct dwa_window {
    int left, top, right, bottom;
} dwa_window;

static parian_result read_pixels(const parian_env *env, const char *path, ImfInputFile *file,
                                 const dwa_window *window, size_t width, size_t height,
                                 float (*rgb)[3])
{
    ImfRgba *row;
    parian_result result = PARIAN_OK;
    if (!PARIAN_NEW(env, row, width)) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for a row of %zu pixels", path,
                           width);
    }
    for (size_t y = 0; y < height && result == PARIAN_OK; y++) {
        /* The library addresses pixels from the origin of the display; a stride of 0 keeps it to
         * one row. */
        if (!ImfInputSetFrameBuffer(
                file, (ImfRgba *)((uintptr_t)row - sizeof *row * (uintptr_t)window->left), 1, 0) ||
            !ImfInputReadPixels(file, window->top + (int)y, window->top + (int)y)) {
            result = parian_fail(env, PARIAN_E_FORMAT, "%s: not a valid OpenEXR picture: %s", path,
                                 ImfErrorMessage());
        }
        for (size_t x = 0; x < width && result == PARIAN_OK; x++) {
            float *to = rgb[y * width + x];
            to[0] = ImfHalfToFloat(row[x].r);
            to[1] = ImfHalfToFloat(row[x].g);
            to[2] = ImfHalfToFloat(row[x].b);
        }
    }
    parian_free(env, row);
    return result;
}

parian_result parian_exr_read_dwa(const parian_env *env, const char *path, uint32_t *width,
                                  uint32_t *height, float (**out)[3])
{
    dwa_window window;
    ImfInputFile *file = ImfOpenInputFile(path);
    if (!file) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: not a valid OpenEXR picture: %s", path,
                           ImfErrorMessage());
    }
    ImfHeaderDataWindow(ImfInputHeader(file), &window.left, &window.top, &window.right,
                        &window.bottom);
    const int64_t across = (int64_t)window.right - window.left + 1,
                  down = (int64_t)window.bottom - window.top + 1;
    parian_result result = parian_picture_check_size(env, path, across > 0 ? (uint64_t)across : 0,
                                                     down > 0 ? (uint64_t)down : 0);
    float(*rgb)[3] =
        result == PARIAN_OK ? parian_alloc(env, (size_t)across * (size_t)down, sizeof *rgb) : NULL;
    if (result == PARIAN_OK) {
        result = rgb ? read_pixels(env, path, file, &window, (size_t)across, (size_t)down, rgb)
                     : parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its pixels", path);
    }
    ImfCloseInputFile(file);
    if (result != PARIAN_OK) {
        parian_free(env, rgb);
        return result;
    }
    *width = (uint32_t)across;
    *height = (uint32_t)down;
    *out = rgb;
    return PARIAN_OK;
}
