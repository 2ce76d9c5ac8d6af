/* view_reference.c - a truth to compare with, and the colours of the difference.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_reference.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/picture.h"
#include "view_options.h"

/* ---- reading -----------------------------------------------------------------------------------
 */
static parian_result take_triples(const parian_env *env, const char *path, const parian_npy *array,
                                  size_t *count, float (**out)[3])
{
    if (array->rank != 2 || array->shape[1] != 3 || array->shape[0] < 1 ||
        array->shape[0] >= UINT32_MAX || (*count && array->shape[0] != *count)) {
        return parian_fail(env, PARIAN_E_FORMAT,
                           "%s: not an array of points with three numbers each, as many as there "
                           "are positions",
                           path);
    }
    if (!PARIAN_NEW(env, *out, array->shape[0])) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its points", path);
    }
    for (size_t i = 0; i < array->count; i++) {
        const float value = (float)array->value[i];
        if (!isfinite(value)) {
            return parian_fail(env, PARIAN_E_FORMAT, "%s: point %zu is not finite", path, i / 3);
        }
        (*out)[i / 3][i % 3] = value;
    }
    *count = array->shape[0];
    return PARIAN_OK;
}

static parian_result read_triples(const parian_env *env, const char *folder, const char *kind,
                                  const char *what, size_t *count, float (**out)[3])
{
    char name[64];
    parian_npy array = {0};
    snprintf(name, sizeof name, "%s_%s.npy", kind, what);
    char *path = parian_path_join(env, folder, name);
    parian_result result = path ? parian_npy_read(env, path, &array) : PARIAN_E_NOMEM;
    if (result == PARIAN_OK) {
        result = take_triples(env, path, &array, count, out);
    }
    parian_npy_free(env, &array);
    parian_free(env, path);
    return result;
}

static bool has_file(const parian_env *env, const char *folder, const char *name)
{
    struct stat found;
    char *path = parian_path_join(env, folder, name);
    const bool there = path && stat(path, &found) == 0;
    parian_free(env, path);
    return there;
}

static parian_result read_folder(const parian_env *env, const char *folder,
                                 parian_view_reference *reference)
{
    const bool receivers = has_file(env, folder, "receiver_position.npy");
    const char *kind = receivers ? "receiver" : "texel";
    const bool normals =
        has_file(env, folder, receivers ? "receiver_normal.npy" : "texel_normal.npy");
    if (!receivers && !has_file(env, folder, "texel_position.npy")) {
        return parian_fail(env, PARIAN_E_IO,
                           "%s: neither receiver_position.npy (parian-bake reference) nor "
                           "texel_position.npy (--dump) is there",
                           folder);
    }
    parian_result result =
        read_triples(env, folder, kind, "position", &reference->count, &reference->position);
    if (result == PARIAN_OK) {
        result =
            read_triples(env, folder, kind, "radiosity", &reference->count, &reference->radiosity);
    }
    if (result == PARIAN_OK && normals) {
        result = read_triples(env, folder, kind, "normal", &reference->count, &reference->normal);
    }
    for (size_t i = 0; i < reference->count && result == PARIAN_OK; i++) {
        const float *b = reference->radiosity[i];
        reference->mean += ((double)b[0] + (double)b[1] + (double)b[2]) / 3;
    }
    reference->mean /= reference->count ? (double)reference->count : 1;
    return result;
}

static parian_result read_picture(const parian_env *env, const char *path,
                                  parian_view_reference *reference)
{
    reference->encoded = parian_view_path_ends(path, ".png");
    return parian_picture_read_linear(env, path, &reference->width, &reference->height,
                                      &reference->pixel);
}

parian_result parian_view_reference_read(const parian_env *env, const char *path,
                                         parian_view_reference *reference)
{
    struct stat found;
    *reference = (parian_view_reference){0};
    const bool folder = stat(path, &found) == 0 && S_ISDIR(found.st_mode);
    parian_result result =
        folder ? read_folder(env, path, reference) : read_picture(env, path, reference);
    if (result != PARIAN_OK) {
        parian_view_reference_free(env, reference);
    }
    return result;
}

void parian_view_reference_forget(const parian_env *env, parian_view_reference *reference)
{
    parian_free(env, reference->receiver_at);
    parian_free(env, reference->texel_at);
    reference->receiver_at = reference->texel_at = NULL;
}

void parian_view_reference_free(const parian_env *env, parian_view_reference *reference)
{
    parian_view_reference_forget(env, reference);
    parian_free(env, reference->position);
    parian_free(env, reference->normal);
    parian_free(env, reference->radiosity);
    parian_free(env, reference->pixel);
    *reference = (parian_view_reference){0};
}

/* ---- comparing ---------------------------------------------------------------------------------
 */
void parian_view_reference_color(double share, float color[3])
{
    const float away = (float)fmin(fabs(share), 1);
    color[0] = share < 0 ? 1 - away : 1;
    color[1] = 1 - away;
    color[2] = share > 0 ? 1 - away : 1;
}

static parian_result match(const parian_env *env, parian_view_reference *reference,
                           const parian_view_points *texels)
{
    const parian_view_points receivers = {reference->count, (const float(*)[3])reference->position,
                                          (const float(*)[3])reference->normal};
    if (reference->receiver_at) {
        return PARIAN_OK;
    }
    if (!PARIAN_NEW(env, reference->receiver_at, texels->count) ||
        !PARIAN_NEW(env, reference->texel_at, reference->count)) {
        parian_view_reference_forget(env, reference);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to match %zu points", reference->count);
    }
    parian_result result = parian_view_nearest(env, texels, &receivers, reference->receiver_at);
    if (result == PARIAN_OK) {
        result = parian_view_nearest(env, &receivers, texels, reference->texel_at);
    }
    if (result != PARIAN_OK) {
        parian_view_reference_forget(env, reference);
    }
    return result;
}

/* Sums of an error: of squares, and of the reference's squares. */
typedef struct error_sum {
    double off, whole;
} error_sum;

/* Adds a point and returns its difference, averaged over channels. */
static double add_point(error_sum *sum, const float *value, const float *truth)
{
    double difference = 0;
    for (int c = 0; c < 3; c++) {
        const double off = (double)value[c] - (double)truth[c];
        difference += off / 3;
        sum->off += off * off;
        sum->whole += (double)truth[c] * (double)truth[c];
    }
    return difference;
}

static double relative(const error_sum *sum)
{
    return sum->whole > 0 ? sqrt(sum->off / sum->whole) : 0;
}

parian_result parian_view_reference_paint(const parian_env *env, parian_view_reference *reference,
                                          const parian_view_points *texels,
                                          const float (*radiosity)[3], double scale,
                                          float (*color)[3], double *error)
{
    float(*point_color)[3];
    error_sum sum = {0, 0};
    parian_result result = match(env, reference, texels);
    if (result != PARIAN_OK) {
        return result;
    }
    if (!PARIAN_NEW(env, point_color, reference->count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the error at %zu points",
                           reference->count);
    }
    const double unit = scale * (reference->mean > 0 ? reference->mean : 1);
    for (size_t i = 0; i < reference->count; i++) {
        const double off =
            add_point(&sum, radiosity[reference->texel_at[i]], reference->radiosity[i]);
        parian_view_reference_color(off / unit, point_color[i]);
    }
    for (size_t t = 0; t < texels->count; t++) {
        memcpy(color[t], point_color[reference->receiver_at[t]], sizeof color[t]);
    }
    parian_free(env, point_color);
    *error = relative(&sum);
    return PARIAN_OK;
}

void parian_view_reference_compare(const parian_view_reference *reference, const float (*value)[4],
                                   double scale, float (*color)[4], double *error)
{
    const size_t count = (size_t)reference->width * reference->height;
    error_sum sum = {0, 0};
    double mean = 0;
    for (size_t i = 0; i < count; i++) {
        const float *p = reference->pixel[i];
        mean += ((double)p[0] + (double)p[1] + (double)p[2]) / 3 / (double)count;
    }
    for (size_t i = 0; i < count; i++) {
        const double off = add_point(&sum, value[i], reference->pixel[i]);
        parian_view_reference_color(off / (scale * (mean > 0 ? mean : 1)), color[i]);
        color[i][3] = 1;
    }
    *error = relative(&sum);
}
