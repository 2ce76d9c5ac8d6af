/* view_camera.c - where the player looks from: framing, --camera, and the motions of the mouse.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_camera.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/options.h"
#include "view_vector.h"

enum { FILE_SIZE_MAX = 1 << 20 };
static const double PI = 3.14159265358979323846;
static const double DEFAULT_YAW = 25, DEFAULT_PITCH = 12, DEFAULT_FOV = 32;
static const double MARGIN = 1.1;           /* of the framing, around the bodies */
static const double POLE_COSINE = 0.9995;   /* how near to straight up or down one can look */
static const double COORDINATE_LIMIT = 1e9; /* metres */

static double radians(double degrees)
{
    return degrees * PI / 180;
}

/* ---- extent ------------------------------------------------------------------------------------
 */
static double enclose(const float lower[3], const float upper[3], double centre[3])
{
    double half[3];
    for (int c = 0; c < 3; c++) {
        centre[c] = 0.5 * ((double)lower[c] + (double)upper[c]);
        half[c] = 0.5 * ((double)upper[c] - (double)lower[c]);
    }
    double radius = vector_length(half);
    return radius > 0 && isfinite(radius) ? radius : 1;
}

parian_view_extent parian_view_extent_of(const parian_scene_info *info)
{
    parian_view_extent extent;
    extent.body_radius = enclose(info->body_lower, info->body_upper, extent.body_centre);
    extent.radius = enclose(info->lower, info->upper, extent.centre);
    for (int c = 0; c < 3; c++) {
        extent.body_lower[c] = info->body_lower[c];
        extent.body_upper[c] = info->body_upper[c];
    }
    return extent;
}

/* ---- making ------------------------------------------------------------------------------------
 */
void parian_view_camera_axes(const parian_view_camera *camera, double right[3], double up[3],
                             double back[3])
{
    const double other[3] = {0, 0, 1};
    vector_add_scaled(camera->eye, -1, camera->target, back);
    vector_normalize(back);
    vector_cross(camera->up, back, right);
    if (vector_length(right) < 1e-9) { /* looking along up */
        vector_cross(other, back, right);
    }
    if (vector_length(right) < 1e-9) { /* and that is z */
        right[0] = 1;
    }
    vector_normalize(right);
    vector_cross(back, right, up);
}

static void place_orbit(parian_view_camera *camera, double yaw_deg, double pitch_deg,
                        double distance)
{
    const double yaw = radians(yaw_deg), pitch = radians(pitch_deg);
    const double from[3] = {sin(yaw) * cos(pitch), sin(pitch), cos(yaw) * cos(pitch)};
    vector_add_scaled(camera->target, distance, from, camera->eye);
    camera->up[0] = camera->up[2] = 0;
    camera->up[1] = 1;
    if (fabs(from[1]) >
        POLE_COSINE) { /* straight from above or below: the top of the picture is away */
        camera->up[0] = -sin(yaw) * from[1];
        camera->up[1] = 0;
        camera->up[2] = -cos(yaw) * from[1];
    }
}

/* The nearest eye that sees every point: with t the slope of the picture's edge, each point asks
 * for eye_z t + eye_x >= x + z t and eye_z t - eye_x >= -x + z t, and the same in y. */
void parian_view_camera_fit(parian_view_camera *camera, const float (*point)[3], size_t count,
                            const double depth_centre[3], double aspect)
{
    double axis[3][3], eye[3] = {0, 0, 0},
                       most[2][2] = {{-INFINITY, -INFINITY}, {-INFINITY, -INFINITY}};
    const double tan_y = tan(0.5 * radians(camera->fov_deg)) / MARGIN;
    const double slope[2] = {tan_y * aspect, tan_y};
    parian_view_camera_axes(camera, axis[0], axis[1], axis[2]);
    for (size_t i = 0; i < count; i++) {
        const double p[3] = {point[i][0], point[i][1], point[i][2]};
        const double depth = vector_dot(p, axis[2]);
        for (int k = 0; k < 2; k++) {
            const double across = vector_dot(p, axis[k]);
            most[k][0] = fmax(most[k][0], depth * slope[k] + across);
            most[k][1] = fmax(most[k][1], depth * slope[k] - across);
        }
    }
    if (count == 0) {
        return;
    }
    const double depth = fmax((most[0][0] + most[0][1]) / (2 * slope[0]),
                              (most[1][0] + most[1][1]) / (2 * slope[1]));
    vector_add_scaled(eye, 0.5 * (most[0][0] - most[0][1]), axis[0], eye);
    vector_add_scaled(eye, 0.5 * (most[1][0] - most[1][1]), axis[1], eye);
    vector_add_scaled(eye, depth, axis[2], eye);
    const double distance = depth - vector_dot(depth_centre, axis[2]);
    if (distance > 0) {
        memcpy(camera->eye, eye, sizeof eye);
        vector_add_scaled(eye, -distance, axis[2], camera->target);
    }
}

static void fit_box(parian_view_camera *camera, const parian_view_extent *extent, double aspect)
{
    float corner[8][3];
    for (unsigned i = 0; i < 8; i++) {
        for (int c = 0; c < 3; c++) {
            corner[i][c] = (float)(i >> c & 1 ? extent->body_upper[c] : extent->body_lower[c]);
        }
    }
    parian_view_camera_fit(camera, (const float(*)[3])corner, 8, extent->body_centre, aspect);
}

typedef struct orbit_text {
    double yaw, pitch, distance;
    bool has_distance, in_metres;
} orbit_text;

static bool parse_angle(const char **at, double *angle)
{
    char *end;
    *angle = strtod(*at, &end);
    bool ok = end != *at && fabs(*angle) <= 36000 && (*end == ',' || *end == '\0');
    *at = *end == ',' ? end + 1 : end;
    return ok;
}

/* The text behind "orbit:". */
static bool parse_orbit(const char *text, orbit_text *orbit)
{
    *orbit = (orbit_text){.distance = 0};
    if (!parse_angle(&text, &orbit->yaw) || *text == '\0' || !parse_angle(&text, &orbit->pitch)) {
        return false;
    }
    if (*text == '\0') {
        return text[-1] != ',';
    }
    orbit->has_distance = true;
    if (parian_parse_length(text, &orbit->distance) == PARIAN_OK) {
        orbit->in_metres = true;
        return orbit->distance <= COORDINATE_LIMIT;
    }
    char *end;
    orbit->distance = strtod(text, &end);
    return end != text && *end == '\0' && orbit->distance > 0 && orbit->distance <= 1e6;
}

parian_result parian_view_camera_check(const parian_env *env, const char *text)
{
    orbit_text orbit;
    if (text && strncmp(text, "orbit:", 6) == 0 && !parse_orbit(text + 6, &orbit)) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "--camera: '%s' is not orbit:YAW,PITCH[,DIST] with degrees and a distance above 0",
            text);
    }
    return PARIAN_OK;
}

bool parian_view_camera_is_open(const char *text)
{
    orbit_text orbit;
    return !text || (strncmp(text, "orbit:", 6) == 0 && parse_orbit(text + 6, &orbit) &&
                     !orbit.has_distance);
}

/* ---- camera files ------------------------------------------------------------------------------
 */
static parian_result read_vector(const parian_env *env, const char *path, const cJSON *root,
                                 const char *key, bool required, double out[3])
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, key);
    if (!item && !required) {
        return PARIAN_OK;
    }
    const cJSON *element =
        cJSON_IsArray(item) && cJSON_GetArraySize(item) == 3 ? item->child : NULL;
    for (int c = 0; c < 3; c++, element = element->next) {
        if (!cJSON_IsNumber(element) || !(fabs(element->valuedouble) <= COORDINATE_LIMIT)) {
            return parian_fail(env, PARIAN_E_FORMAT, "%s: '%s' is not three numbers of at most %g",
                               path, key, COORDINATE_LIMIT);
        }
        out[c] = element->valuedouble;
    }
    return PARIAN_OK;
}

parian_result parian_view_camera_read_members(const parian_env *env, const char *path,
                                              const cJSON *root, parian_view_camera *camera)
{
    double between[3];
    const cJSON *fov = cJSON_GetObjectItemCaseSensitive(root, "fov_deg");
    parian_result result = read_vector(env, path, root, "eye", true, camera->eye);
    if (result == PARIAN_OK) {
        result = read_vector(env, path, root, "target", false, camera->target);
    }
    if (result == PARIAN_OK) {
        result = read_vector(env, path, root, "up", false, camera->up);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    if (fov && (!cJSON_IsNumber(fov) || !(fov->valuedouble >= 0.1 && fov->valuedouble <= 170))) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: 'fov_deg' is not a number of 0.1 to 170",
                           path);
    }
    camera->fov_deg = fov ? fov->valuedouble : camera->fov_deg;
    vector_add_scaled(camera->eye, -1, camera->target, between);
    if (!(vector_length(between) > 0) || !(vector_length(camera->up) > 0)) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: 'eye' is at 'target', or 'up' has no length",
                           path);
    }
    return PARIAN_OK;
}

static parian_result read_camera_file(const parian_env *env, const char *path,
                                      parian_view_camera *camera)
{
    uint8_t *data;
    size_t size;
    parian_result result = parian_file_read(env, path, FILE_SIZE_MAX, &data, &size);
    if (result != PARIAN_OK) {
        return result;
    }
    cJSON *root = memchr(data, 0, size) ? NULL : cJSON_ParseWithOpts((const char *)data, NULL, 1);
    result = cJSON_IsObject(root)
                 ? parian_view_camera_read_members(env, path, root, camera)
                 : parian_fail(env, PARIAN_E_FORMAT, "%s: not a JSON object", path);
    cJSON_Delete(root);
    parian_free(env, data);
    return result;
}

parian_result parian_view_camera_make(const parian_env *env, const char *text,
                                      const parian_view_extent *extent, double aspect,
                                      parian_view_camera *camera)
{
    orbit_text orbit = {.yaw = DEFAULT_YAW, .pitch = DEFAULT_PITCH};
    *camera = (parian_view_camera){.up = {0, 1, 0}, .fov_deg = DEFAULT_FOV};
    memcpy(camera->target, extent->body_centre, sizeof camera->target);
    if (text && strncmp(text, "orbit:", 6) != 0) {
        return read_camera_file(env, text, camera);
    }
    parian_result result = parian_view_camera_check(env, text);
    if (result != PARIAN_OK) {
        return result;
    }
    if (text) {
        parse_orbit(text + 6, &orbit);
    }
    const double unit = orbit.in_metres ? 1 : extent->body_radius;
    place_orbit(camera, orbit.yaw, orbit.pitch,
                orbit.has_distance ? orbit.distance * unit : 3 * unit);
    if (!orbit.has_distance) {
        fit_box(camera, extent, aspect);
    }
    return PARIAN_OK;
}

/* ---- matrices ----------------------------------------------------------------------------------
 */
parian_camera parian_view_camera_matrices(const parian_view_camera *camera,
                                          const parian_view_extent *extent, double aspect)
{
    parian_camera out;
    double axis[3][3], to_centre[3];
    memset(&out, 0, sizeof out);
    parian_view_camera_axes(camera, axis[0], axis[1], axis[2]);
    for (int row = 0; row < 3; row++) {
        for (int c = 0; c < 3; c++) {
            out.view[c * 4 + row] = (float)axis[row][c];
        }
        out.view[12 + row] = (float)-vector_dot(axis[row], camera->eye);
    }
    out.view[15] = 1;
    vector_add_scaled(extent->centre, -1, camera->eye, to_centre);
    const double depth = -vector_dot(to_centre, axis[2]), margin = 1.01 * extent->radius;
    const double far_plane = fmax(depth + margin, 1e-3 * extent->radius);
    const double near_plane = fmax(depth - margin, 1e-3 * far_plane);
    const double focal = 1 / tan(0.5 * radians(camera->fov_deg));
    out.projection[0] = (float)(focal / aspect);
    out.projection[5] = (float)focal;
    out.projection[10] = (float)((far_plane + near_plane) / (near_plane - far_plane));
    out.projection[11] = -1;
    out.projection[14] = (float)(2 * far_plane * near_plane / (near_plane - far_plane));
    return out;
}

/* ---- motions -----------------------------------------------------------------------------------
 */
void parian_view_camera_orbit(parian_view_camera *camera, double yaw, double pitch)
{
    double right[3], up[3], back[3], pole[3], arm[3], turned[3];
    memcpy(pole, camera->up, sizeof pole);
    vector_normalize(pole);
    parian_view_camera_axes(camera, right, up, back);
    vector_add_scaled(camera->eye, -1, camera->target, arm);
    memcpy(turned, arm, sizeof turned);
    vector_rotate(right, -pitch, turned);
    double cosine = vector_dot(turned, pole) / vector_length(turned);
    if (fabs(cosine) < POLE_COSINE) {
        memcpy(arm, turned, sizeof arm);
    }
    vector_rotate(pole, yaw, arm);
    vector_add_scaled(camera->target, 1, arm, camera->eye);
}

void parian_view_camera_pan(parian_view_camera *camera, double right_share, double up_share)
{
    double right[3], up[3], back[3], arm[3];
    parian_view_camera_axes(camera, right, up, back);
    vector_add_scaled(camera->eye, -1, camera->target, arm);
    const double height = 2 * vector_length(arm) * tan(0.5 * radians(camera->fov_deg));
    for (int c = 0; c < 3; c++) {
        const double move = height * (right_share * right[c] + up_share * up[c]);
        camera->eye[c] += move;
        camera->target[c] += move;
    }
}

void parian_view_camera_zoom(parian_view_camera *camera, double factor)
{
    double arm[3];
    vector_add_scaled(camera->eye, -1, camera->target, arm);
    const double distance = vector_length(arm) * factor;
    if (distance > 1e-6 && distance < COORDINATE_LIMIT) {
        vector_add_scaled(camera->target, factor, arm, camera->eye);
    }
}
