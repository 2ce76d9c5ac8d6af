/* import.c - reads a model file into a source scene: checks, libraries, triangles.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/import.h"

#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "bake/adapters/gltf_import.h"
#include "bake/adapters/openmesh_import.h"
#include "bake/stages/import_check.h"
#include "bake/stages/import_polygons.h"
#include "core/memory.h"
#include "tool/files.h"

static const uint64_t file_size_max = (uint64_t)4 << 30;

void parian_source_scene_free(const parian_env *env, parian_source_scene *scene)
{
    if (!scene) {
        return;
    }
    for (uint32_t i = 0; scene->parts && i < scene->part_count; i++) {
        parian_mesh_free(env, &scene->parts[i].mesh);
    }
    for (uint32_t i = 0; scene->pictures && i < scene->picture_count; i++) {
        parian_free(env, scene->pictures[i].pixel);
    }
    parian_free(env, scene->parts);
    parian_free(env, scene->materials);
    parian_free(env, scene->pictures);
    parian_free(env, scene->lights);
    memset(scene, 0, sizeof *scene);
}

/* The formats that go through OpenMesh, and the check before it. */
static const struct mesh_format {
    const char *extension;
    parian_result (*check)(const parian_model_bytes *file, parian_plain_file *plain);
} mesh_formats[] = {{"obj", parian_check_obj},
                    {"ply", parian_check_ply},
                    {"stl", parian_check_stl},
                    {"off", parian_check_off}};

/* The base name of a path without its extension. */
static void name_part(const char *path, char name[PARIAN_NAME_MAX])
{
    const char *slash = strrchr(path, '/');
    const char *begin = slash ? slash + 1 : path;
    const char *dot = strrchr(begin, '.');
    size_t length = dot && dot > begin ? (size_t)(dot - begin) : strlen(begin);
    length = length < PARIAN_NAME_MAX - 1 ? length : PARIAN_NAME_MAX - 1;
    memcpy(name, begin, length);
    name[length] = '\0';
}

static parian_result make_part(const parian_env *env, const char *path,
                               const parian_polygons *polygons, parian_source_scene *scene)
{
    parian_source_scene made = {.part_count = 1};
    if (!PARIAN_NEW0(env, made.parts, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: out of memory", path);
    }
    made.parts[0].material = UINT32_MAX;
    name_part(path, made.parts[0].name);
    parian_result result = parian_triangulate(env, path, polygons, &made.parts[0].mesh);
    if (result != PARIAN_OK) {
        parian_source_scene_free(env, &made);
        return result;
    }
    *scene = made;
    return PARIAN_OK;
}

static parian_result import_mesh(const parian_env *env, const char *path,
                                 const struct mesh_format *format, parian_source_scene *scene)
{
    parian_plain_file plain = {.env = env};
    parian_polygons polygons = {0};
    uint8_t *data = NULL;
    size_t size = 0;
    parian_result result = parian_file_read(env, path, file_size_max, &data, &size);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_model_bytes file = {path, (const char *)data, size};
    result = format->check(&file, &plain);
    parian_free(env, data);
    if (result == PARIAN_OK) {
        result = parian_openmesh_read(env, path, format->extension, plain.binary, plain.data,
                                      plain.size, &polygons);
    }
    parian_free(env, plain.data);
    if (result == PARIAN_OK) {
        result = make_part(env, path, &polygons, scene);
    }
    parian_polygons_free(env, &polygons);
    return result;
}

static parian_result import_gltf(const parian_env *env, const char *path,
                                 parian_source_scene *scene)
{
    uint8_t *data = NULL;
    size_t size = 0;
    parian_result result = parian_file_read(env, path, file_size_max, &data, &size);
    if (result == PARIAN_OK) {
        result = parian_gltf_read(env, path, data, size, scene);
    }
    parian_free(env, data);
    return result;
}

/* A pipe or device has no size to check counts against, and cannot be read twice. */
static parian_result check_regular(const parian_env *env, const char *path)
{
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode)) {
        return parian_fail(env, PARIAN_E_IO,
                           "cannot read '%s': it is a pipe or device, a file was expected", path);
    }
    return PARIAN_OK;
}

parian_result parian_import(const parian_env *env, const char *path, parian_source_scene *scene)
{
    if (!path || !scene) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "import: no path or no scene given");
    }
    parian_result regular = check_regular(env, path);
    if (regular != PARIAN_OK) {
        return regular;
    }
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash ? slash : path, '.');
    const char *extension = dot ? dot + 1 : "";
    if (strcasecmp(extension, "glb") == 0 || strcasecmp(extension, "gltf") == 0) {
        return import_gltf(env, path, scene);
    }
    for (size_t i = 0; i < sizeof mesh_formats / sizeof mesh_formats[0]; i++) {
        if (strcasecmp(extension, mesh_formats[i].extension) == 0) {
            return import_mesh(env, path, &mesh_formats[i], scene);
        }
    }
    return parian_fail(env, PARIAN_E_UNSUPPORTED,
                       "%s: unknown extension '%s', expected .glb .gltf .obj .ply .stl or .off",
                       path, extension);
}
