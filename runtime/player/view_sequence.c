/* view_sequence.c - pictures in a row: names of their files, and the camera of each frame.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_sequence.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"
#include "view_vector.h"

enum { FILE_SIZE_MAX = 1 << 22, KEYS_MAX = 10000, FRAMES_MAX = 1000000, NAME_MAX_BYTES = 4096 };
static const double FRAMES_PER_TIME = 25;

/* ---- names -------------------------------------------------------------------------------------
 */
bool parian_view_sequence_is_wanted(const parian_view_options *o)
{
    return o->turntable || o->camera_path || o->display_count > 1;
}

static bool append(char *name, size_t size, size_t *length, const char *text)
{
    const size_t more = strlen(text);
    if (*length + more >= size) {
        return false;
    }
    memcpy(name + *length, text, more + 1);
    *length += more;
    return true;
}

/* The text behind a '%': what stands for it, and how long it is in the pattern; 0 if unknown. */
static size_t expand(const char *at, uint32_t number, const char *view, char text[64])
{
    int digits = 0;
    size_t length = 0;
    if (at[0] == '%' || at[0] == 's') {
        snprintf(text, 64, "%s", at[0] == 's' ? view : "%");
        return 1;
    }
    if (at[0] == '0' && at[1] >= '1' && at[1] <= '9') {
        digits = at[1] - '0';
        length = 2;
    }
    snprintf(text, 64, "%0*u", digits, number);
    return at[length] == 'd' ? length + 1 : 0;
}

bool parian_view_sequence_name(const char *pattern, uint32_t number, const char *view, char *name,
                               size_t size)
{
    size_t length = 0;
    bool ok = size > 0;
    if (ok) {
        name[0] = '\0';
    }
    for (const char *at = pattern; *at && ok;) {
        char text[64] = {at[0], '\0'};
        size_t used = 1;
        if (*at == '%') {
            const size_t known = expand(at + 1, number, view, text);
            ok = known > 0;
            used += known;
        }
        ok = ok && append(name, size, &length, text);
        at += used;
    }
    return ok;
}

/* Whether other numbers, or other views, have other names. */
static parian_result check_pattern(const parian_env *env, const parian_view_options *o)
{
    char first[NAME_MAX_BYTES], other[NAME_MAX_BYTES];
    if (!parian_view_sequence_name(o->image, 0, "a", first, sizeof first)) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "--image: '%s' is not a name with %%d, %%04d, %%s or %%%% in it",
                           o->image);
    }
    parian_view_sequence_name(o->image, 1, "a", other, sizeof other);
    if ((o->turntable || o->camera_path) && strcmp(first, other) == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "--image: '%s' needs a %%d or %%04d for the number of the frame",
                           o->image);
    }
    parian_view_sequence_name(o->image, 0, "b", other, sizeof other);
    if (o->display_count > 1 && strcmp(first, other) == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "--image: '%s' needs a %%s for the name of the view", o->image);
    }
    return PARIAN_OK;
}

parian_result parian_view_sequence_check(const parian_env *env, const parian_view_options *o)
{
    if (!parian_view_sequence_is_wanted(o)) {
        return PARIAN_OK;
    }
    if (o->turntable && o->camera_path) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "--turntable and --camera-path exclude each other");
    }
    if (!o->image || strcmp(o->image, "-") == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "a sequence of pictures needs an --image such as out-%%04d.png");
    }
    if ((o->turntable && o->frames) || (o->timings && (o->turntable || o->camera_path))) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "%s does not go with %s",
                           o->timings ? "--timings" : "--frames",
                           o->turntable ? "--turntable" : "--camera-path");
    }
    return check_pattern(env, o);
}

/* ---- keyframes ---------------------------------------------------------------------------------
 */
void parian_view_path_free(const parian_env *env, parian_view_path *path)
{
    parian_free(env, path->time);
    parian_free(env, path->key);
    *path = (parian_view_path){0};
}

static parian_result read_key(const parian_env *env, const char *file, const cJSON *item,
                              const parian_view_camera *start, parian_view_path *path)
{
    const size_t i = path->count;
    const cJSON *time = cJSON_GetObjectItemCaseSensitive(item, "time");
    char where[NAME_MAX_BYTES];
    snprintf(where, sizeof where, "%.3900s: keyframe %zu", file, i);
    path->key[i] = *start;
    path->time[i] = time ? time->valuedouble : (double)i;
    if (!cJSON_IsObject(item) || (time && !cJSON_IsNumber(time)) || !(fabs(path->time[i]) <= 1e6) ||
        (i > 0 && !(path->time[i] > path->time[i - 1]))) {
        return parian_fail(env, PARIAN_E_FORMAT,
                           "%s: not an object with a 'time' above that of the one before", where);
    }
    path->count++;
    return parian_view_camera_read_members(env, where, item, &path->key[i]);
}

static parian_result read_keys(const parian_env *env, const char *file, const cJSON *root,
                               const parian_view_camera *start, parian_view_path *path)
{
    const cJSON *keys = cJSON_GetObjectItemCaseSensitive(root, "keyframes"), *item;
    const cJSON *frames = cJSON_GetObjectItemCaseSensitive(root, "frames");
    const int count = cJSON_GetArraySize(keys);
    parian_result result = PARIAN_OK;
    if (!cJSON_IsArray(keys) || count < 2 || count > KEYS_MAX) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: 'keyframes' is not a list of 2 to %d", file,
                           KEYS_MAX);
    }
    if (!PARIAN_NEW(env, path->time, count) || !PARIAN_NEW(env, path->key, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for %d keyframes", file, count);
    }
    cJSON_ArrayForEach(item, keys)
    {
        result = result == PARIAN_OK ? read_key(env, file, item, start, path) : result;
    }
    if (result != PARIAN_OK) {
        return result;
    }
    const double made =
        frames
            ? frames->valuedouble
            : fmin(fmax(FRAMES_PER_TIME * (path->time[count - 1] - path->time[0]), 2), FRAMES_MAX);
    if ((frames && !cJSON_IsNumber(frames)) || !(made >= 1 && made <= FRAMES_MAX)) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: 'frames' is not a number of 1 to %d", file,
                           FRAMES_MAX);
    }
    path->frames = (uint32_t)made;
    return PARIAN_OK;
}

parian_result parian_view_path_read(const parian_env *env, const char *file,
                                    const parian_view_camera *start, parian_view_path *path)
{
    uint8_t *data;
    size_t size;
    *path = (parian_view_path){0};
    parian_result result = parian_file_read(env, file, FILE_SIZE_MAX, &data, &size);
    if (result != PARIAN_OK) {
        return result;
    }
    cJSON *root = memchr(data, 0, size) ? NULL : cJSON_ParseWithOpts((const char *)data, NULL, 1);
    result = cJSON_IsObject(root)
                 ? read_keys(env, file, root, start, path)
                 : parian_fail(env, PARIAN_E_FORMAT, "%s: not a JSON object", file);
    cJSON_Delete(root);
    parian_free(env, data);
    if (result != PARIAN_OK) {
        parian_view_path_free(env, path);
    }
    return result;
}

/* ---- between keyframes -------------------------------------------------------------------------
 */
/* Slope at keyframe i of one coordinate: that of the line through its neighbours in time. */
static double slope(const parian_view_path *path, size_t i, size_t offset)
{
    const size_t a = i > 0 ? i - 1 : i, b = i + 1 < path->count ? i + 1 : i;
    const double *from = (const double *)((const char *)&path->key[a] + offset);
    const double *to = (const double *)((const char *)&path->key[b] + offset);
    return (*to - *from) / (path->time[b] - path->time[a]);
}

/* A coordinate (at an offset into the camera) between keyframes i and i + 1, cubic Hermite. */
static double cubic(const parian_view_path *path, size_t i, double u, size_t offset)
{
    const double step = path->time[i + 1] - path->time[i];
    const double a = *(const double *)((const char *)&path->key[i] + offset);
    const double b = *(const double *)((const char *)&path->key[i + 1] + offset);
    const double m = step * slope(path, i, offset), n = step * slope(path, i + 1, offset);
    const double u2 = u * u, u3 = u2 * u;
    return (2 * u3 - 3 * u2 + 1) * a + (u3 - 2 * u2 + u) * m + (3 * u2 - 2 * u3) * b +
           (u3 - u2) * n;
}

parian_view_camera parian_view_path_at(const parian_view_path *path, double share)
{
    const double first = path->time[0], last = path->time[path->count - 1];
    const double time = first + (last - first) * fmin(fmax(share, 0), 1);
    size_t i = 0;
    while (i + 2 < path->count && path->time[i + 1] <= time) {
        i++;
    }
    const parian_view_camera *a = &path->key[i], *b = &path->key[i + 1];
    const double u = (time - path->time[i]) / (path->time[i + 1] - path->time[i]);
    parian_view_camera camera = *a;
    for (size_t c = 0; c < 3; c++) {
        const size_t step = c * sizeof(double);
        camera.eye[c] = cubic(path, i, u, offsetof(parian_view_camera, eye) + step);
        camera.target[c] = cubic(path, i, u, offsetof(parian_view_camera, target) + step);
        camera.up[c] = (1 - u) * a->up[c] + u * b->up[c];
    }
    camera.fov_deg = (1 - u) * a->fov_deg + u * b->fov_deg;
    if (!(vector_length(camera.up) > 1e-6)) {
        memcpy(camera.up, a->up, sizeof camera.up);
    }
    return camera;
}
