/* nasty_models.c - small damaged OBJ, OFF, PLY and STL files, and the writer of them all.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "models.h"
#include "nasty.h"
#include "tool/files.h"

enum { BALL_CUTS = 6, LINE_MAX_SIZE = 512, SOUP_TRIANGLES = 100, BAND_STEPS = 60 };

void blob_add(blob *b, const void *data, size_t size)
{
    if (b->failed) {
        return;
    }
    if (size > b->capacity - b->size) {
        size_t capacity = 2 * b->capacity + size + 4096;
        unsigned char *grown;
        if (!PARIAN_NEW(b->env, grown, capacity)) {
            b->failed = true;
            return;
        }
        if (b->size) {
            memcpy(grown, b->data, b->size);
        }
        parian_free(b->env, b->data);
        b->data = grown;
        b->capacity = capacity;
    }
    if (size) { /* an empty file has no data at all */
        memcpy(b->data + b->size, data, size);
    }
    b->size += size;
}

void blob_release(blob *b)
{
    parian_free(b->env, b->data);
    *b = (blob){.env = b->env};
}

void blob_add_u32(blob *b, uint32_t value)
{
    const unsigned char byte[4] = {(unsigned char)value, (unsigned char)(value >> 8),
                                   (unsigned char)(value >> 16), (unsigned char)(value >> 24)};
    blob_add(b, byte, sizeof byte);
}

void blob_add_f32(blob *b, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    blob_add_u32(b, bits);
}

void blob_print(blob *b, const char *format, ...)
{
    char line[LINE_MAX_SIZE];
    va_list args;
    va_start(args, format);
    int size = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    blob_add(b, line, size > 0 ? (size_t)size : 0);
}

double blob_random(uint32_t index)
{
    uint64_t h = (index + 1) * 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
    return (double)((h ^ (h >> 31)) >> 11) / 9007199254740992.0;
}

static void obj_vertices(blob *b, const model_mesh *mesh, double dx)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        blob_print(b, "v %.9g %.9g %.9g\n", mesh->position[v].x + dx, mesh->position[v].y,
                   mesh->position[v].z);
    }
}

static void obj_faces(blob *b, const model_mesh *mesh, uint32_t base)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangle[t];
        blob_print(b, "f %u %u %u\n", base + v[0] + 1, base + v[1] + 1, base + v[2] + 1);
    }
}

static void off_head(blob *b, const model_mesh *mesh)
{
    blob_print(b, "OFF\n%u %u 0\n", mesh->vertex_count, mesh->triangle_count);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        blob_print(b, "%.9g %.9g %.9g\n", mesh->position[v].x, mesh->position[v].y,
                   mesh->position[v].z);
    }
}

static void off_face(blob *b, const uint32_t v[3], bool flipped)
{
    blob_print(b, "3 %u %u %u\n", v[0], flipped ? v[2] : v[1], flipped ? v[1] : v[2]);
}

static void ply_head(blob *b, const char *format, uint64_t vertices, uint64_t faces)
{
    blob_print(b,
               "ply\nformat %s 1.0\nelement vertex %llu\nproperty float x\nproperty float "
               "y\nproperty float z\n"
               "element face %llu\nproperty list uchar int vertex_indices\nend_header\n",
               format, (unsigned long long)vertices, (unsigned long long)faces);
}

static void ply_vertices(blob *b, const model_mesh *mesh, double dx)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        blob_print(b, "%.9g %.9g %.9g\n", mesh->position[v].x + dx, mesh->position[v].y,
                   mesh->position[v].z);
    }
}

static void ply_faces(blob *b, const model_mesh *mesh, uint32_t first, uint32_t base)
{
    for (uint32_t t = first; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangle[t];
        blob_print(b, "3 %u %u %u\n", base + v[0], base + v[1], base + v[2]);
    }
}

static void nan_inf(blob *b, const model_mesh *ball)
{
    (void)ball;
    blob_print(b, "v inf nan +inf\nv nan -nan -Inf\nv 3.00 NaN -NaN\nf 1 2 3\n");
}

static void one_nan(blob *b, const model_mesh *ball)
{
    obj_vertices(b, ball, 0);
    blob_print(b, "v 0 nan 0\n");
    obj_faces(b, ball, 0);
    blob_print(b, "f 1 2 %u\n", ball->vertex_count + 1);
}

static void all_degenerate(blob *b, const model_mesh *ball)
{
    (void)ball;
    blob_print(b, "v 0 0 0\nv 0 0 0\nv 0 0 0\nv 1 1 1\nv 2 2 2\nf 3 2 1\nf 1 4 5\n");
}

static void oom_header(blob *b, const model_mesh *ball)
{
    (void)ball;
    blob_print(b, "OFF\n353535235358 6 0\n-0.5 -0.5 0.5\n0.5 -0.5 0.5\n-0.5 0.5 0.5\n3 0 1 2\n");
}

static void oom_ply(blob *b, const model_mesh *ball)
{
    (void)ball;
    ply_head(b, "binary_little_endian", 4000000000u, 4000000000u);
    blob_add_f32(b, 1);
}

static void truncated_obj(blob *b, const model_mesh *ball)
{
    obj_vertices(b, ball, 0);
    obj_faces(b, ball, 0);
    b->size -= b->failed ? 0 : 7; /* in the middle of the last face */
}

static void truncated_ply(blob *b, const model_mesh *ball)
{
    ply_head(b, "binary_little_endian", ball->vertex_count, ball->triangle_count);
    for (uint32_t v = 0; v < ball->vertex_count / 2; v++) {
        blob_add_f32(b, (float)ball->position[v].x);
        blob_add_f32(b, (float)ball->position[v].y);
        blob_add_f32(b, (float)ball->position[v].z);
    }
}

static void truncated_off(blob *b, const model_mesh *ball)
{
    off_head(b, ball);
    off_face(b, ball->triangle[0], false);
}

static void stl_triangle(blob *b, const vec3 p[3])
{
    for (int i = 0; i < 3; i++) {
        blob_add_f32(b, 0);
    }
    for (int i = 0; i < 3; i++) {
        blob_add_f32(b, (float)p[i].x);
        blob_add_f32(b, (float)p[i].y);
        blob_add_f32(b, (float)p[i].z);
    }
    blob_add(b, "\0\0", 2);
}

static void stl_head(blob *b, uint32_t count)
{
    char head[80] = "damaged on purpose";
    blob_add(b, head, sizeof head);
    blob_add_u32(b, count);
}

static void random_soup(blob *b, const model_mesh *ball)
{
    (void)ball;
    stl_head(b, SOUP_TRIANGLES);
    for (uint32_t t = 0; t < SOUP_TRIANGLES; t++) {
        vec3 p[3];
        for (uint32_t k = 0; k < 3; k++) {
            p[k] = v3(blob_random(9 * t + 3 * k), blob_random(9 * t + 3 * k + 1),
                      blob_random(9 * t + 3 * k + 2));
        }
        stl_triangle(b, p);
    }
}

static void lying_stl(blob *b, const model_mesh *ball)
{
    const vec3 p[3] = {ball->position[0], ball->position[1], ball->position[2]};
    stl_head(b, 4000000000u);
    stl_triangle(b, p);
}

/* A band with half a twist: one side, one border. */
static void moebius(blob *b, const model_mesh *ball)
{
    (void)ball;
    for (uint32_t i = 0; i < BAND_STEPS; i++) {
        double a = 2 * M_PI * i / BAND_STEPS;
        for (int side = -1; side <= 1; side += 2) {
            double r = 1 + 0.3 * side * cos(a / 2);
            blob_print(b, "v %.9g %.9g %.9g\n", r * cos(a), 0.3 * side * sin(a / 2), r * sin(a));
        }
    }
    for (uint32_t i = 0; i < BAND_STEPS; i++) {
        uint32_t low = 2 * i + 1, high = 2 * i + 2;
        bool last = i + 1 == BAND_STEPS; /* where the twist closes, the sides change places */
        uint32_t next_low = last ? 2 : low + 2, next_high = last ? 1 : high + 2;
        blob_print(b, "f %u %u %u %u\n", low, next_low, next_high, high);
    }
}

static void mixed_orientation(blob *b, const model_mesh *ball)
{
    off_head(b, ball);
    for (uint32_t t = 0; t < ball->triangle_count; t++) {
        off_face(b, ball->triangle[t], blob_random(t) < 0.5);
    }
}

static void inside_out(blob *b, const model_mesh *ball)
{
    off_head(b, ball);
    for (uint32_t t = 0; t < ball->triangle_count; t++) {
        off_face(b, ball->triangle[t], true);
    }
}

static void no_faces(blob *b, const model_mesh *ball)
{
    (void)ball;
    ply_head(b, "ascii", 0, 0);
}

static void nothing(blob *b, const model_mesh *ball)
{
    (void)ball;
    blob_add(b, "", 0);
}

static void unreferenced(blob *b, const model_mesh *ball)
{
    ply_head(b, "ascii", 2 * ball->vertex_count, ball->triangle_count);
    ply_vertices(b, ball, 0);
    ply_vertices(b, ball, 1e6);
    ply_faces(b, ball, 0, 0);
}

static void open_ball(blob *b, const model_mesh *ball)
{
    ply_head(b, "ascii", ball->vertex_count, ball->triangle_count - 40);
    ply_vertices(b, ball, 0);
    ply_faces(b, ball, 40, 0);
}

static void two_parts(blob *b, const model_mesh *ball)
{
    ply_head(b, "ascii", 2 * ball->vertex_count, 2 * ball->triangle_count);
    ply_vertices(b, ball, 0);
    ply_vertices(b, ball, 2.5);
    ply_faces(b, ball, 0, 0);
    ply_faces(b, ball, 0, ball->vertex_count);
}

static void bad_index(blob *b, const model_mesh *ball)
{
    ply_head(b, "ascii", ball->vertex_count, 1);
    ply_vertices(b, ball, 0);
    blob_print(b, "3 0 1 1000000\n");
}

static void bad_index_obj(blob *b, const model_mesh *ball)
{
    obj_vertices(b, ball, 0);
    blob_print(b, "f 1 2 -99999\nf 0 1 2\nf 1 2 99999999999999999999\n");
}

static void self_intersecting(blob *b, const model_mesh *ball)
{
    obj_vertices(b, ball, 0);
    obj_vertices(b, ball, 0.8);
    obj_faces(b, ball, 0);
    obj_faces(b, ball, ball->vertex_count);
}

static void duplicate_faces(blob *b, const model_mesh *ball)
{
    obj_vertices(b, ball, 0);
    obj_faces(b, ball, 0);
    obj_faces(b, ball, 0);
}

/* Every triangle with vertices of its own, as exporters that split them write. */
static void duplicate_vertices(blob *b, const model_mesh *ball)
{
    for (uint32_t t = 0; t < ball->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            vec3 p = ball->position[ball->triangle[t][k]];
            blob_print(b, "v %.9g %.9g %.9g\n", p.x, p.y, p.z);
        }
        blob_print(b, "f %u %u %u\n", 3 * t + 1, 3 * t + 2, 3 * t + 3);
    }
}

/* Two tetrahedra that share an edge: four faces meet there. */
static void nonmanifold_edge(blob *b, const model_mesh *ball)
{
    (void)ball;
    blob_print(b, "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 0.5 1\nv -1 0 0\nv -1 0.5 -1\n"
                  "f 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\nf 1 2 5\nf 1 5 6\nf 1 6 2\nf 2 6 5\n");
}

/* Two tetrahedra that share a vertex. */
static void touching_vertex(blob *b, const model_mesh *ball)
{
    (void)ball;
    blob_print(b, "v 0 0 0\nv 1 1 0\nv 1 1 1\nv 0 1 1\nv 1 -1 0\nv 1 -1 1\nv 0 -1 1\n"
                  "f 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 4\nf 1 5 6\nf 1 6 7\nf 1 7 5\nf 5 7 6\n");
}

static void needles(blob *b, const model_mesh *ball)
{
    (void)ball;
    blob_print(b, "v 0 0 0\nv 1000000 0 0\nv 1000000 1e-6 0\nv 500000 0 1e-7\nf 1 3 2\nf 1 2 4\nf "
                  "2 3 4\nf 3 1 4\n");
}

static void huge_coordinates(blob *b, const model_mesh *ball)
{
    for (uint32_t v = 0; v < ball->vertex_count; v++) {
        vec3 p = ball->position[v];
        blob_print(b, "v %.9ge300 %.9ge300 %.9ge300\n", p.x, p.y, p.z);
    }
    obj_faces(b, ball, 0);
}

const nasty_entry nasty_model_table[] = {
    {"nan_inf.obj", 3, nan_inf},
    {"one_nan.obj", 3, one_nan},
    {"all_degenerate.obj", 3, all_degenerate},
    {"oom_header.off", 3, oom_header},
    {"oom_header.ply", 3, oom_ply},
    {"lying_count.stl", 3, lying_stl},
    {"truncated_midline.obj", -1, truncated_obj},
    {"truncated.ply", 3, truncated_ply},
    {"truncated.off", 3, truncated_off},
    {"random_soup.stl", -1, random_soup},
    {"moebius.obj", -1, moebius},
    {"mixed_orientation.off", 0, mixed_orientation},
    {"inside_out.off", 0, inside_out},
    {"empty.ply", 3, no_faces},
    {"nothing.obj", 3, nothing},
    {"unreferenced_vertices.ply", 0, unreferenced},
    {"open.ply", 0, open_ball},
    {"two_parts.ply", 0, two_parts},
    {"bad_index.ply", 3, bad_index},
    {"bad_index.obj", 3, bad_index_obj},
    {"self_intersecting.obj", 0, self_intersecting},
    {"duplicate_faces.obj", -1, duplicate_faces},
    {"duplicate_vertices.obj", 0, duplicate_vertices},
    {"nonmanifold_edge.obj", -1, nonmanifold_edge},
    {"touching_vertex.obj", -1, touching_vertex},
    {"needles.obj", -1, needles},
    {"huge_coordinates.obj", -1, huge_coordinates},
};
const size_t nasty_model_count = sizeof nasty_model_table / sizeof nasty_model_table[0];

static parian_result write_blob(const parian_env *env, const char *folder, const char *name,
                                const blob *b)
{
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/%s", folder, name);
    if (length < 0 || (size_t)length >= sizeof path) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "the folder's name is longer than %zu bytes",
                           sizeof path);
    }
    return b->failed ? parian_fail(env, PARIAN_E_NOMEM, "no memory for %s", path)
                     : parian_file_write(env, path, b->size ? b->data : (const unsigned char *)"",
                                         b->size);
}

/* Write the files of a table and note in `expected` what is to be made of each. */
static parian_result write_table(const parian_env *env, const char *folder,
                                 const nasty_entry *table, size_t count, const model_mesh *ball,
                                 blob *expected)
{
    parian_result result = PARIAN_OK;
    for (size_t i = 0; result == PARIAN_OK && i < count; i++) {
        blob b = {.env = env};
        table[i].make(&b, ball);
        result = write_blob(env, folder, table[i].name, &b);
        blob_release(&b);
        if (table[i].status < 0) {
            blob_print(expected, "%s any\n", table[i].name);
        } else {
            blob_print(expected, "%s %d\n", table[i].name, table[i].status);
        }
    }
    return result;
}

parian_result nasty_write(const parian_env *env, const char *folder)
{
    model_mesh ball;
    blob expected = {.env = env};
    parian_result result = model_mesh_sphere(env, 1, BALL_CUTS, &ball);
    if (result != PARIAN_OK) {
        return result;
    }
    result = write_table(env, folder, nasty_model_table, nasty_model_count, &ball, &expected);
    if (result == PARIAN_OK) {
        result = write_table(env, folder, nasty_glb_table, nasty_glb_count, &ball, &expected);
    }
    if (result == PARIAN_OK) {
        result = write_blob(env, folder, "expected.txt", &expected);
    }
    blob_release(&expected);
    model_mesh_free(env, &ball);
    return result;
}
