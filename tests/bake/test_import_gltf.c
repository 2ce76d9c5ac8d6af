/* test_import_gltf.c - glTF scenes: nodes, materials, lights, and documents that lie.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/stages/import.h"

/* Four corners of a unit square (float VEC3, bytes 0-47), indices 0 1 2 0 2 3 (u16, bytes 48-59),
 * padded to 64; then the strip order 0 1 3 2 (u8, bytes 60-63). */
#define BUFFER                                                                                     \
    "{\"byteLength\":64,\"uri\":\"data:application/octet-stream;base64,"                           \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMAAAEDAg==\"}"
#define VIEWS                                                                                      \
    "{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12},"         \
    "{\"buffer\":0,\"byteOffset\":60,\"byteLength\":4}"
#define ACCESSORS                                                                                  \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                     \
    "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"                   \
    "{\"bufferView\":2,\"componentType\":5121,\"count\":4,\"type\":\"SCALAR\"}"
#define SQUARE "{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0}"

typedef struct document {
    const char *nodes, *primitives, *materials, *accessors, *views, *rest;
} document;

static parian_result import_text(const char *text, parian_source_scene *scene)
{
    const char *path = test_scratch("scene.gltf");
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    memset(scene, 0, sizeof *scene);
    return parian_import(test_env(1), path, scene);
}

static parian_result import_document(const document *d, parian_source_scene *scene)
{
    char text[8192];
    int length = snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],"
        "\"meshes\":[{\"name\":\"m\",\"primitives\":[%s]}],\"materials\":[%s],\"accessors\":[%s],"
        "\"bufferViews\":[%s],\"buffers\":[" BUFFER "]%s}",
        d->nodes ? d->nodes : "{\"mesh\":0,\"name\":\"n\"}", d->primitives ? d->primitives : SQUARE,
        d->materials ? d->materials : "{\"name\":\"plain\"}",
        d->accessors ? d->accessors : ACCESSORS, d->views ? d->views : VIEWS,
        d->rest ? d->rest : "");
    assert_true(length > 0 && (size_t)length < sizeof text);
    return import_text(text, scene);
}

/* Sum of the triangles' vector areas. */
static void vector_area(const parian_mesh *mesh, double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const double *a = mesh->position[mesh->triangle[t][0]],
                     *b = mesh->position[mesh->triangle[t][1]];
        const double *c = mesh->position[mesh->triangle[t][2]];
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            sum[k] += 0.5 * ((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]));
        }
    }
}

static void expect_area(const document *d, double x, double y, double z)
{
    parian_source_scene scene;
    double found[3];
    assert_int_equal(import_document(d, &scene), PARIAN_OK);
    assert_int_equal(scene.part_count, 1);
    vector_area(&scene.parts[0].mesh, found);
    assert_true(fabs(found[0] - x) < 1e-6 && fabs(found[1] - y) < 1e-6 &&
                fabs(found[2] - z) < 1e-6);
    parian_source_scene_free(NULL, &scene);
}

static void primitives(void **state)
{
    (void)state;
    expect_area(&(document){0}, 0, 0, 1);
    expect_area(
        &(document){.primitives = "{\"attributes\":{\"POSITION\":0},\"indices\":2,\"mode\":5}"}, 0,
        0, 1);
    /* as a fan, 0 1 3 2 turns back: +1/2 and then -1/2 */
    expect_area(
        &(document){.primitives = "{\"attributes\":{\"POSITION\":0},\"indices\":2,\"mode\":6}"}, 0,
        0, 0);
    /* without indices: the first three corners */
    expect_area(&(document){.primitives = "{\"attributes\":{\"POSITION\":0}}"}, 0, 0, 0.5);
    /* lines are left out */
    expect_area(&(document){.primitives = SQUARE ",{\"attributes\":{\"POSITION\":0},\"mode\":1}"},
                0, 0, 1);
    /* two primitives of one material are one part */
    expect_area(&(document){.primitives = SQUARE "," SQUARE}, 0, 0, 2);
}

static void transforms(void **state)
{
    (void)state;
    expect_area(&(document){.nodes = "{\"mesh\":0,\"scale\":[2,3,5]}"}, 0, 0, 6);
    /* a quarter turn about x takes z to -y */
    expect_area(&(document){.nodes = "{\"mesh\":0,\"rotation\":[0.70710678118,0,0,0.70710678118]}"},
                0, -1, 0);
    /* a mirror keeps the outside outside */
    expect_area(&(document){.nodes = "{\"mesh\":0,\"scale\":[-1,1,1]}"}, 0, 0, 1);
    expect_area(
        &(document){.nodes = "{\"mesh\":0,\"matrix\":[0,2,0,0, -2,0,0,0, 0,0,2,0, 7,8,9,1]}"}, 0, 0,
        4);
    /* scale outside, rotation inside: x is stretched after the turn about z */
    document nested = {.nodes = "{\"children\":[1],\"scale\":[3,1,1]},"
                                "{\"mesh\":0,\"translation\":[1,0,0],"
                                "\"rotation\":[0,0,0.70710678118,0.70710678118]}"};
    expect_area(&nested, 0, 0, 3);
    parian_source_scene scene;
    assert_int_equal(import_document(&nested, &scene), PARIAN_OK);
    double lower[3], upper[3];
    parian_mesh_bounds(&scene.parts[0].mesh, lower, upper);
    assert_true(fabs(lower[0]) < 1e-6 && fabs(upper[0] - 3) < 1e-6 && fabs(upper[1] - 1) < 1e-6);
    parian_source_scene_free(NULL, &scene);
}

static void instances(void **state)
{
    (void)state;
    document d = {.nodes = "{\"children\":[1,2]},{\"mesh\":0,\"name\":\"a\"},"
                           "{\"mesh\":0,\"name\":\"b\",\"translation\":[0,0,4]}"};
    parian_source_scene scene;
    assert_int_equal(import_document(&d, &scene), PARIAN_OK);
    assert_true(scene.is_scene);
    assert_int_equal(scene.part_count, 2);
    assert_string_equal(scene.parts[0].name, "a");
    assert_string_equal(scene.parts[1].name, "b");
    assert_string_equal(scene.parts[1].mesh_name, "m");
    assert_int_equal(scene.material_count, 1);
    assert_true(fabs(scene.parts[1].mesh.position[0][2] - 4) < 1e-12);
    parian_source_scene_free(NULL, &scene);
}

static void read_material(const char *extensions, parian_source_material *material)
{
    char text[1024];
    parian_source_scene scene;
    snprintf(text, sizeof text,
             "{\"name\":\"w\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.1,0.2,0.3,1]},"
             "\"extensions\":{%s}}",
             extensions);
    document d = {.materials = text, .nodes = "{\"mesh\":0,\"scale\":[10,10,10]}"};
    assert_int_equal(import_document(&d, &scene), PARIAN_OK);
    *material = scene.materials[scene.parts[0].material];
    parian_source_scene_free(NULL, &scene);
}

static void materials(void **state)
{
    (void)state;
    parian_source_material m;
    read_material("\"KHR_materials_ior\":{\"ior\":1.3}", &m);
    assert_true(!m.has_volume && !m.has_scatter && m.ior == 1.3 && isinf(m.attenuation_distance));
    assert_true(m.base_color[1] == 0.2f && m.base_color_picture == -1);
#define VOLUME                                                                                     \
    "\"KHR_materials_volume\":{\"attenuationDistance\":0.25,\"attenuationColor\":[0.5,0.6,0.7]}"
    static const struct {
        const char *scatter;
        bool new_draft;
        double green, anisotropy;
    } cases[] = {
        {"\"KHR_materials_volume_scatter\":{\"multiscatterColor\":[0.1,0.5,0.9]}", false, 0.5, 0},
        {"\"KHR_materials_volume_scatter\":{\"multiscatterColorFactor\":[0.1,0.5,0.9],"
         "\"scatterAnisotropy\":0.3}",
         false, 0.5, 0.3},
        {"\"KHR_materials_scatter\":{\"multiscatterColor\":[0.1,0.5,0.9],\"scatterStrengthFactor\":"
         "0.5}",
         true, 0.25, 0},
        {"\"KHR_materials_scatter\":{\"multiscatterColorFactor\":[0.1,0.5,0.9],\"scatterFactor\":1,"
         "\"scatterAnisotropy\":-0.5}",
         true, 0.5, -0.5},
        {"\"KHR_materials_scatter\":{}", true, 1, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[512];
        snprintf(text, sizeof text, VOLUME ",%s", cases[i].scatter);
        read_material(text, &m);
        assert_true(m.has_volume && m.has_scatter && m.new_draft == cases[i].new_draft);
        assert_true(fabs(m.multiscatter_color[1] - cases[i].green) < 1e-12);
        assert_true(m.scatter_anisotropy == cases[i].anisotropy && m.ior == 1.5);
        /* in world space: the node's scale of 10 does not change it */
        assert_true(m.attenuation_distance == 0.25 && m.attenuation_color[2] == 0.7);
    }
}

static void lights(void **state)
{
    (void)state;
    document d = {
        .nodes = "{\"mesh\":0,\"children\":[1,2,3]},"
                 "{\"translation\":[1,2,3],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},"
                 "{\"rotation\":[0.70710678118,0,0,0.70710678118],\"extensions\":{\"KHR_lights_"
                 "punctual\":"
                 "{\"light\":1}}},{\"extensions\":{\"KHR_lights_punctual\":{\"light\":2}}}",
        .rest =
            ",\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":{\"KHR_lights_punctual\":"
            "{\"lights\":[{\"type\":\"point\",\"color\":[1,0.5,0.25],\"intensity\":8},"
            "{\"type\":\"directional\",\"intensity\":3},"
            "{\"type\":\"spot\",\"spot\":{\"innerConeAngle\":0.1,\"outerConeAngle\":0.5}}]}}"};
    parian_source_scene scene;
    assert_int_equal(import_document(&d, &scene), PARIAN_OK);
    assert_int_equal(scene.light_count, 3);
    const parian_light *l = scene.lights;
    assert_true(l[0].type == PARIAN_LIGHT_POINT && l[0].position[2] == 3 && l[0].color[1] == 4);
    /* -z turned a quarter about x is +y */
    assert_true(l[1].type == PARIAN_LIGHT_DIRECTIONAL && fabsf(l[1].direction[1] - 1) < 1e-6f);
    assert_true(l[1].color[0] == 3);
    assert_true(l[2].type == PARIAN_LIGHT_SPOT && fabsf(l[2].outer_deg - 28.6479f) < 1e-3f);
    assert_true(fabsf(l[2].inner_deg - 5.72958f) < 1e-4f && l[2].direction[2] == -1);
    parian_source_scene_free(NULL, &scene);
}

static void textures(void **state)
{
    (void)state;
    /* a 1x1 red PNG in a data URI; a second image that is missing */
    static const char png[] =
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAEl"
        "FTkSuQmCC";
    char rest[512];
    parian_source_scene scene;
    snprintf(rest, sizeof rest,
             ",\"textures\":[{\"source\":0},{\"source\":1}],\"images\":[{\"uri\":\"data:image/"
             "png;base64,%s\"},"
             "{\"uri\":\"absent.png\"}]",
             png);
    document d = {.rest = rest,
                  .materials = "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}},"
                               "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1}}}",
                  .primitives =
                      SQUARE ",{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":1}"};
    assert_int_equal(import_document(&d, &scene), PARIAN_OK);
    assert_int_equal(scene.part_count, 2);
    assert_int_equal(scene.picture_count, 1);
    assert_int_equal(scene.materials[0].base_color_picture, 0);
    assert_int_equal(scene.materials[1].base_color_picture, -1);
    assert_true(scene.pictures[0].width == 1 && scene.pictures[0].pixel[0][0] == 255);
    assert_int_equal(scene.pictures[0].pixel[0][1], 0);
    parian_source_scene_free(NULL, &scene);
}

static void sparse(void **state)
{
    (void)state;
    /* corner 2 is replaced by corner 0's values: half of the square falls together */
    document d = {.accessors =
                      "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\","
                      "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,\"byteOffset\":4,"
                      "\"componentType\":5123},\"values\":{\"bufferView\":0}}},"
                      "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}"};
    expect_area(&d, 0, 0, 0);
}

static void refuse(const document *d, parian_result expected, int line)
{
    parian_source_scene scene;
    parian_result found = import_document(d, &scene);
    if (found != expected) {
        fail_msg("case %d gave %d, expected %d", line, found, expected);
    }
    parian_source_scene_free(NULL, &scene);
}

static void refuse_documents(void **state)
{
    (void)state;
    const document bad[] = {
        {.accessors = "{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"}"},
        {.accessors = "{\"bufferView\":0,\"byteOffset\":44,\"componentType\":5126,\"count\":1,"
                      "\"type\":\"VEC3\"}"},
        {.accessors =
             "{\"bufferView\":0,\"componentType\":5126,\"count\":4294967297,\"type\":\"VEC3\"},"
             "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}"},
        {.accessors = "{\"bufferView\":9,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
                      "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}"},
        {.accessors = "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
                      "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}"},
        {.accessors = "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
                      "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}"},
        {.views = "{\"buffer\":0,\"byteLength\":4800},{\"buffer\":0,\"byteOffset\":48,"
                  "\"byteLength\":12}"},
        {.views =
             "{\"buffer\":3,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12}"},
        {.views = "{\"buffer\":0,\"byteOffset\":18446744073709551600,\"byteLength\":48}"},
        {.primitives = "{\"attributes\":{\"NORMAL\":0},\"indices\":1}"},
        {.primitives = "{\"indices\":1}"},
        {.primitives = "{\"attributes\":{\"POSITION\":77},\"indices\":1}"},
        {.primitives = "{\"attributes\":{\"POSITION\":0},\"indices\":77}"},
        {.primitives = "{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":5}"},
        {.primitives =
             "{\"attributes\":{\"POSITION\":0},\"extensions\":{\"KHR_draco_mesh_compression\":"
             "{\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}}"},
        {.primitives =
             "{\"attributes\":{\"POSITION\":0},\"extensions\":{\"KHR_draco_mesh_compression\":"
             "{\"bufferView\":99,\"attributes\":{\"POSITION\":0}}}}"},
        {.nodes = "{\"mesh\":4}"},
        {.nodes = "{\"mesh\":0,\"children\":[0]}"},
        {.nodes = "{\"mesh\":0,\"children\":[7]}"},
        {.nodes = "{\"mesh\":0,\"scale\":[1e200,1e200,1e200]}"},
        {.nodes = "{\"name\":\"empty\"}"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        /* 2^32 + 1 elements are over a limit; the rest is wrong */
        refuse(&bad[i], i == 2 ? PARIAN_E_LIMIT : PARIAN_E_FORMAT, (int)i);
    }
    refuse(&(document){.rest = ",\"extensionsRequired\":[\"EXT_meshopt_compression\"]"},
           PARIAN_E_UNSUPPORTED, 100);
    refuse(&(document){.rest = ",\"extensionsRequired\":[\"KHR_materials_volume\"]"}, PARIAN_OK,
           101);
}

static void refuse_texts(void **state)
{
    (void)state;
    static char nested[4096];
    static const char *const bad[] = {
        "",
        "{",
        "[]",
        "{\"asset\":{}}",
        "glTF",
        "{\"meshes\":3}",
        nested,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,"
        "\"uri\":\"absent.bin\"}]}"};
    memset(nested, '[', sizeof nested - 1);
    parian_source_scene scene;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(import_text(bad[i], &scene), PARIAN_E_FORMAT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(primitives),   cmocka_unit_test(transforms),
        cmocka_unit_test(instances),    cmocka_unit_test(materials),
        cmocka_unit_test(lights),       cmocka_unit_test(textures),
        cmocka_unit_test(sparse),       cmocka_unit_test(refuse_documents),
        cmocka_unit_test(refuse_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
