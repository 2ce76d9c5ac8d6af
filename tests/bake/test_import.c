/* test_import.c - OBJ, PLY, STL and OFF: what is read, and what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/stages/import.h"

static parian_result import_bytes(const char *name, const void *bytes, size_t size,
                                  parian_source_scene *scene)
{
    const char *path = test_scratch(name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
    memset(scene, 0, sizeof *scene);
    return parian_import(test_env(1), path, scene);
}

static parian_result import_text(const char *name, const char *text, parian_source_scene *scene)
{
    return import_bytes(name, text, strlen(text), scene);
}

static void expect_mesh(const char *name, const char *text, uint32_t vertices, uint32_t triangles,
                        double area)
{
    parian_source_scene scene;
    assert_int_equal(import_text(name, text, &scene), PARIAN_OK);
    assert_false(scene.is_scene);
    assert_int_equal(scene.part_count, 1);
    assert_int_equal(scene.parts[0].material, UINT32_MAX);
    assert_int_equal(scene.parts[0].mesh.vertex_count, vertices);
    assert_int_equal(scene.parts[0].mesh.triangle_count, triangles);
    /* positions are single precision inside the reader */
    assert_true(fabs(parian_mesh_area(&scene.parts[0].mesh) - area) < 1e-6 * (area + 1));
    parian_source_scene_free(NULL, &scene);
}

static void expect_result(const char *name, const char *text, parian_result expected)
{
    parian_source_scene scene;
    parian_result found = import_text(name, text, &scene);
    if (found != expected) {
        fail_msg("%s gave %d, expected %d:\n%s", name, found, expected, text);
    }
    parian_source_scene_free(NULL, &scene);
}

static void read_obj(void **state)
{
    (void)state;
    expect_mesh("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 3, 1, 0.5);
    expect_mesh("b.OBJ",
                "# c\r\nmtllib none.mtl\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\n"
                "vn 0 0 1\r\nusemtl x\r\nf 1/1/1 2/1/1 3/1/1 4/1/1 # quad\r\n",
                4, 2, 1);
    expect_mesh("c.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nf -3 -2 \\\n -1\nv 0 0 5\nf -1//1 1//1 2//1",
                4, 2, 7);
    /* more than two faces at an edge, and a face twice: kept for the surface stage */
    expect_mesh(
        "d.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 3\n", 5, 4,
        2);
    /* a concave polygon: an arrow whose notch must not be covered */
    expect_mesh("e.obj", "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\n", 4, 2, 1);
    expect_mesh("f.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 2 3 3\n", 3, 1, 0.5);
}

static void refuse_obj(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n",
        "v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n",
        "v 0 0 0\nv 1 0 -inf\nv 0 1 0\nf 1 2 3\n", "v 0 0 0\nv 1 0 1e60\nv 0 1 0\nf 1 2 3\n",
        "v 0 0 0\nv 1 0 0x\nv 0 1 0\nf 1 2 3\n",
        /* cut inside the last line */
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/1/1 3/1",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/1/1 3/1/",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 1 "};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        expect_result("bad.obj", bad[i], PARIAN_E_FORMAT);
    }
}

static void read_off(void **state)
{
    (void)state;
    expect_mesh("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", 4, 2, 1);
    expect_mesh("b.off", "# x\n\nOFF 3 2 0\n# y\n0 0 0\n1 0 0\n\n0 1 0\n3 0 1 2 255 0 0\n2 0 1\n",
                3, 1, 0.5);
    expect_mesh("c.off", "COFF\n3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n", 3,
                1, 0.5);
}

static void refuse_off(void **state)
{
    (void)state;
    static const char *const bad[] = {"",
                                      "OFF",
                                      "OFF\n3",
                                      "OFG\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                      "OFF\n353535235358 6 0\n0 0 0\n",
                                      "OFF\n3 999 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                      "OFF\n-3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                      "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                      "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                      "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 nan\n3 0 1 2\n",
                                      "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
                                      "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2000000000 0 1 2\n",
                                      "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        expect_result("bad.off", bad[i], PARIAN_E_FORMAT);
    }
    expect_result("bad.off", "OFF BINARY\n", PARIAN_E_UNSUPPORTED);
}

#define PLY_HEAD(vertices, faces)                                                                  \
    "ply\nformat ascii 1.0\ncomment c\nelement vertex " #vertices                                  \
    "\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\nelement "        \
    "face " #faces                                                                                 \
    "\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"

static void read_ply(void **state)
{
    (void)state;
    expect_mesh("a.ply", PLY_HEAD(4, 1) "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3 2 0.5 0.5\n",
                4, 2, 1);
    static const char little[] =
        "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uchar ushort "
        "vertex_index\n"
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        "\3\0\0\1\0\2\0" /* the face comes first */
        "\0\0\0\0\0\0\0\0\0\0\0\0"
        "\0\0\x80\x3f\0\0\0\0\0\0\0\0"
        "\0\0\0\0\0\0\x80\x3f\0\0\0\0";
    parian_source_scene scene;
    assert_int_equal(import_bytes("b.ply", little, sizeof little - 1, &scene), PARIAN_OK);
    assert_true(fabs(parian_mesh_area(&scene.parts[0].mesh) - 0.5) < 1e-12);
    parian_source_scene_free(NULL, &scene);
    for (size_t cut = 0; cut + 1 < sizeof little - 1; cut++) {
        assert_int_equal(import_bytes("cut.ply", little, cut, &scene), PARIAN_E_FORMAT);
    }
    static const char big[] =
        "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n"
        "\0\0\0\0\0\0\0\0\0\0\0\0"
        "\x3f\x80\0\0\0\0\0\0\0\0\0\0"
        "\0\0\0\0\x3f\x80\0\0\0\0\0\0"
        "\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2";
    assert_int_equal(import_bytes("c.ply", big, sizeof big - 1, &scene), PARIAN_OK);
    assert_true(fabs(parian_mesh_area(&scene.parts[0].mesh) - 0.5) < 1e-12);
    parian_source_scene_free(NULL, &scene);
}

static void refuse_ply(void **state)
{
    (void)state;
    static const char *const bad[] = {"",
                                      "ply\n",
                                      "ply\nformat ascii 1.0\nend_header\n",
                                      PLY_HEAD(0, 0),
                                      PLY_HEAD(3, 1) "0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 3 0\n",
                                      PLY_HEAD(3, 1) "0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 -1 0\n",
                                      PLY_HEAD(3, 1) "0 0 0 9\n1 0 0 9\n0 1 nan 9\n3 0 1 2 0\n",
                                      PLY_HEAD(3, 1) "0 0 0 9\n1 0 0 9\n0 1 x 9\n3 0 1 2 0\n",
                                      PLY_HEAD(3, 1) "0 0 0 9\n1 0 0 9\n0 1 0 9\n255 0 1 2 0\n",
                                      PLY_HEAD(3, 2) "0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2 0\n",
                                      PLY_HEAD(999999999999, 1) "0 0 0 9\n",
                                      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float "
                                      "x\nproperty float y\nend_header\n0 0\n",
                                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float "
                                      "x\nproperty float x\nproperty float z\n"
                                      "element face 1\nproperty list uchar int "
                                      "vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        expect_result("bad.ply", bad[i], PARIAN_E_FORMAT);
    }
}

static const char stl_text[] =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
    "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";

static void read_stl(void **state)
{
    (void)state;
    expect_mesh("a.stl", stl_text, 3, 1, 0.5);
    uint8_t binary[84 + 50] = {0};
    const float corner[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    binary[80] = 1;
    memcpy(binary + 84 + 12, corner, sizeof corner);
    parian_source_scene scene;
    assert_int_equal(import_bytes("b.stl", binary, sizeof binary, &scene), PARIAN_OK);
    assert_int_equal(scene.parts[0].mesh.triangle_count, 1);
    parian_source_scene_free(NULL, &scene);
    for (size_t cut = 0; cut < sizeof binary; cut++) {
        assert_int_equal(import_bytes("cut.stl", binary, cut, &scene), PARIAN_E_FORMAT);
    }
    for (size_t cut = 0; cut < sizeof stl_text - 5; cut++) {
        assert_int_equal(import_bytes("cut.stl", stl_text, cut, &scene), PARIAN_E_FORMAT);
    }
    memset(binary + 96, 0xFF, 4); /* a NaN */
    assert_int_equal(import_bytes("c.stl", binary, sizeof binary, &scene), PARIAN_E_FORMAT);
}

static void refuse_names(void **state)
{
    (void)state;
    parian_source_scene scene = {0};
    expect_result("a.fbx", "x", PARIAN_E_UNSUPPORTED);
    expect_result("noextension", "x", PARIAN_E_UNSUPPORTED);
    assert_int_equal(parian_import(NULL, test_scratch("absent.ply"), &scene), PARIAN_E_IO);
    assert_int_equal(parian_import(NULL, NULL, &scene), PARIAN_E_ARGUMENT);
}

/* Each allocation in turn fails: the reader says so and leaks nothing. */
static void out_of_memory(void **state)
{
    (void)state;
    const char *path = test_scratch("memory.off");
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", file);
    fclose(file);
    for (size_t k = 0;; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_source_scene scene = {0};
        parian_result result = parian_import(&env, path, &scene);
        parian_source_scene_free(&env, &scene);
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK) {
            assert_true(k > 5);
            break;
        }
        assert_int_equal(result, PARIAN_E_NOMEM);
        assert_true(k < 1000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(read_obj),      cmocka_unit_test(refuse_obj),
        cmocka_unit_test(read_off),      cmocka_unit_test(refuse_off),
        cmocka_unit_test(read_ply),      cmocka_unit_test(refuse_ply),
        cmocka_unit_test(read_stl),      cmocka_unit_test(refuse_names),
        cmocka_unit_test(out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
