/* glb_write.c - writes a scene of meshes, media and lights as binary glTF 2.0.
 *
 * SPDX-License-Identifier: MIT
 */
#include "glb_write.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"

enum {
    JSON_MAX = 1 << 16,
    FLOAT = 5126,
    UINT32 = 5125,
    ARRAY_BUFFER = 34962,
    ELEMENT_BUFFER = 34963
};
static const uint32_t GLB_MAGIC = 0x46546C67, CHUNK_JSON = 0x4E4F534A, CHUNK_BIN = 0x004E4942;

/* JSON text that grows in a buffer of fixed size; JSON_MAX holds the largest scene there can be. */
typedef struct text {
    char data[JSON_MAX];
    size_t size;
} text;

void glb_scene_free(const parian_env *env, glb_scene *scene)
{
    for (uint32_t i = 0; i < scene->part_count; i++) {
        model_mesh_free(env, &scene->part[i].mesh);
    }
    memset(scene, 0, sizeof *scene);
}

__attribute__((format(printf, 2, 3))) static void put(text *t, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int added = vsnprintf(t->data + t->size, JSON_MAX - t->size, format, args);
    va_end(args);
    if (added > 0) {
        t->size += (size_t)added;
        t->size = t->size < JSON_MAX ? t->size : JSON_MAX - 1;
    }
}

/* A comma before every element but the first. */
static const char *comma(uint32_t index)
{
    return index ? "," : "";
}

static size_t vertex_bytes(const glb_part *part)
{
    return part->mesh.vertex_count * 3 * sizeof(float);
}

static size_t index_bytes(const glb_part *part)
{
    return part->mesh.triangle_count * 3 * sizeof(uint32_t);
}

static size_t part_bytes(const glb_part *part)
{
    return vertex_bytes(part) * (part->mesh.normal ? 2 : 1) + index_bytes(part);
}

static size_t put_view(text *t, bool first, size_t offset, size_t size, int target)
{
    put(t, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":%d}", first ? "" : ",",
        offset, size, target);
    return offset + size;
}

static void put_views(text *t, const glb_scene *scene)
{
    size_t offset = 0;
    put(t, ",\"bufferViews\":[");
    for (uint32_t i = 0; i < scene->part_count; i++) {
        const glb_part *part = &scene->part[i];
        offset = put_view(t, i == 0, offset, vertex_bytes(part), ARRAY_BUFFER);
        if (part->mesh.normal) {
            offset = put_view(t, false, offset, vertex_bytes(part), ARRAY_BUFFER);
        }
        offset = put_view(t, false, offset, index_bytes(part), ELEMENT_BUFFER);
    }
    put(t, "],\"buffers\":[{\"byteLength\":%zu}]", offset);
}

/* The accessor of positions carries their bounds, as the format demands. */
static void put_positions(text *t, uint32_t view, const model_mesh *mesh)
{
    float lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const float p[3] = {(float)mesh->position[v].x, (float)mesh->position[v].y,
                            (float)mesh->position[v].z};
        for (int a = 0; a < 3; a++) {
            lower[a] = fminf(lower[a], p[a]);
            upper[a] = fmaxf(upper[a], p[a]);
        }
    }
    put(t,
        "%s{\"bufferView\":%u,\"componentType\":%d,\"count\":%u,\"type\":\"VEC3\","
        "\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]}",
        comma(view), view, FLOAT, mesh->vertex_count, (double)lower[0], (double)lower[1],
        (double)lower[2], (double)upper[0], (double)upper[1], (double)upper[2]);
}

static void put_accessors_and_meshes(text *t, const glb_scene *scene)
{
    uint32_t view = 0;
    put(t, ",\"accessors\":[");
    for (uint32_t i = 0; i < scene->part_count; i++) {
        const model_mesh *mesh = &scene->part[i].mesh;
        put_positions(t, view++, mesh);
        if (mesh->normal) {
            put(t, ",{\"bufferView\":%u,\"componentType\":%d,\"count\":%u,\"type\":\"VEC3\"}", view,
                FLOAT, mesh->vertex_count);
            view++;
        }
        put(t, ",{\"bufferView\":%u,\"componentType\":%d,\"count\":%u,\"type\":\"SCALAR\"}", view,
            UINT32, 3 * mesh->triangle_count);
        view++;
    }
    put(t, "],\"meshes\":[");
    view = 0;
    for (uint32_t i = 0; i < scene->part_count; i++) {
        const glb_part *part = &scene->part[i];
        put(t, "%s{\"name\":\"%s\",\"primitives\":[{\"attributes\":{\"POSITION\":%u", comma(i),
            part->name, view++);
        if (part->mesh.normal) {
            put(t, ",\"NORMAL\":%u", view++);
        }
        put(t, "},\"indices\":%u,\"material\":%u}]}", view++, i);
    }
    put(t, "]");
}

static void put_color(text *t, const char *name, const double color[3])
{
    put(t, "\"%s\":[%.9g,%.9g,%.9g]", name, color[0], color[1], color[2]);
}

static void put_medium(text *t, const model_medium *medium)
{
    gltf_medium gltf = gltf_medium_from(medium);
    put(t,
        ",\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},"
        "\"KHR_materials_ior\":{\"ior\":%.9g},\"KHR_materials_volume\":{\"thicknessFactor\":0.01,"
        "\"attenuationDistance\":%.9g,",
        medium->eta, gltf.attenuation_distance_m);
    put_color(t, "attenuationColor", gltf.attenuation_color);
    put(t, "},\"KHR_materials_scatter\":{");
    put_color(t, "multiscatterColorFactor", gltf.multiscatter_color);
    put(t, ",\"scatterAnisotropy\":%.9g}}", medium->g);
}

static void put_materials(text *t, const glb_scene *scene)
{
    put(t, ",\"materials\":[");
    for (uint32_t i = 0; i < scene->part_count; i++) {
        const glb_part *part = &scene->part[i];
        put(t,
            "%s{\"name\":\"%s\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[%.9g,%.9g,%.9g,1],"
            "\"metallicFactor\":0,\"roughnessFactor\":%.9g}",
            comma(i), part->material_name, part->base_color[0], part->base_color[1],
            part->base_color[2], part->roughness);
        if (part->medium) {
            put_medium(t, part->medium);
        }
        put(t, "}");
    }
    put(t, "]");
}

/* glTF wants a colour of at most 1 and an intensity. */
static void put_lights(text *t, const glb_scene *scene)
{
    put(t, ",\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[");
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const glb_light *light = &scene->light[i];
        double intensity = fmax(light->color[0], fmax(light->color[1], light->color[2]));
        put(t, "%s{\"name\":\"%s\",\"type\":\"%s\",\"color\":[%.9g,%.9g,%.9g],\"intensity\":%.9g}",
            comma(i), light->name, light->directional ? "directional" : "point",
            light->color[0] / intensity, light->color[1] / intensity, light->color[2] / intensity,
            intensity);
    }
    put(t, "]}}");
}

/* The quaternion that turns -z, where a glTF light looks, into direction d. */
static void put_rotation(text *t, vec3 d)
{
    vec3 to = v3_normalize(d), axis = v3_cross(v3(0, 0, -1), to);
    double w = 1 - to.z;
    if (w < 1e-9) { /* the opposite direction: half a turn about y */
        put(t, "\"rotation\":[0,1,0,0]");
        return;
    }
    double length = sqrt(v3_dot(axis, axis) + w * w);
    put(t, "\"rotation\":[%.9g,%.9g,%.9g,%.9g]", axis.x / length, axis.y / length, axis.z / length,
        w / length);
}

static void put_nodes(text *t, const glb_scene *scene)
{
    put(t, ",\"scene\":0,\"scenes\":[{\"nodes\":[");
    for (uint32_t i = 0; i < scene->part_count + scene->light_count; i++) {
        put(t, "%s%u", comma(i), i);
    }
    put(t, "]}],\"nodes\":[");
    for (uint32_t i = 0; i < scene->part_count; i++) {
        put(t, "%s{\"name\":\"%s\",\"mesh\":%u}", comma(i), scene->part[i].name, i);
    }
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const glb_light *light = &scene->light[i];
        put(t, ",{\"name\":\"%s\",", light->name);
        if (light->directional) {
            put_rotation(t, light->at);
        } else {
            put(t, "\"translation\":[%.9g,%.9g,%.9g]", light->at.x, light->at.y, light->at.z);
        }
        put(t, ",\"extensions\":{\"KHR_lights_punctual\":{\"light\":%u}}}", i);
    }
    put(t, "]");
}

static void put_scene(text *t, const glb_scene *scene)
{
    bool scatters = false;
    for (uint32_t i = 0; i < scene->part_count; i++) {
        scatters |= scene->part[i].medium != NULL;
    }
    put(t,
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"parian-models\"},\"extensionsUsed\":[%s%s%"
        "s]",
        scatters ? "\"KHR_materials_transmission\",\"KHR_materials_ior\",\"KHR_materials_volume\","
                   "\"KHR_materials_scatter\""
                 : "",
        scatters && scene->light_count ? "," : "",
        scene->light_count ? "\"KHR_lights_punctual\"" : "");
    put_nodes(t, scene);
    put_materials(t, scene);
    put_accessors_and_meshes(t, scene);
    put_views(t, scene);
    if (scene->light_count) {
        put_lights(t, scene);
    }
    put(t, "}");
    while (t->size % 4) {
        put(t, " ");
    }
}

static uint8_t *store_u32(uint8_t *to, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        *to++ = (uint8_t)(value >> 8 * i);
    }
    return to;
}

static uint8_t *store_vectors(uint8_t *to, const vec3 *from, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const float value[3] = {(float)from[i].x, (float)from[i].y, (float)from[i].z};
        for (int a = 0; a < 3; a++) {
            uint32_t bits;
            memcpy(&bits, &value[a], sizeof bits);
            to = store_u32(to, bits);
        }
    }
    return to;
}

static uint8_t *store_part(uint8_t *to, const model_mesh *mesh)
{
    to = store_vectors(to, mesh->position, mesh->vertex_count);
    if (mesh->normal) {
        to = store_vectors(to, mesh->normal, mesh->vertex_count);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            to = store_u32(to, mesh->triangle[t][k]);
        }
    }
    return to;
}

parian_result glb_write(const parian_env *env, const char *path, const glb_scene *scene)
{
    size_t buffer = 0;
    uint8_t *file = NULL;
    text *json;
    if (!PARIAN_NEW0(env, json, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to write %s", path);
    }
    put_scene(json, scene);
    for (uint32_t i = 0; i < scene->part_count; i++) {
        buffer += part_bytes(&scene->part[i]);
    }
    size_t size = 12 + 8 + json->size + 8 + buffer;
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW(env, file, size)) {
        parian_fail(env, result, "no memory for %zu bytes of %s", size, path);
        goto done;
    }
    uint8_t *to = store_u32(store_u32(store_u32(file, GLB_MAGIC), 2), (uint32_t)size);
    to = store_u32(store_u32(to, (uint32_t)json->size), CHUNK_JSON);
    memcpy(to, json->data, json->size);
    to = store_u32(store_u32(to + json->size, (uint32_t)buffer), CHUNK_BIN);
    for (uint32_t i = 0; i < scene->part_count; i++) {
        to = store_part(to, &scene->part[i].mesh);
    }
    result = parian_file_write(env, path, file, size);
done:
    parian_free(env, json);
    parian_free(env, file);
    return result;
}
