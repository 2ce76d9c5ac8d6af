/* nasty_glb.c - small damaged binary glTF files: lengths, counts, indices and texts that lie.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "nasty.h"

enum { NESTING = 20000 };
static const uint32_t MAGIC = 0x46546C67, CHUNK_JSON = 0x4E4F534A, CHUNK_BIN = 0x004E4942;

/* What is wrong with a file; zero is a sound file. */
typedef struct damage {
    uint32_t length_added;        /* to the length in the header */
    uint32_t chunk_added;         /* to the length of the JSON chunk */
    uint32_t count_added;         /* to the number of vertices of the accessor */
    uint32_t offset_added;        /* to the offset of the index view */
    uint32_t index_added;         /* to the last index */
    uint32_t bytes_cut;           /* from the end of the file */
    float first_coordinate_added; /* an infinity or NaN */
    const char *node;             /* instead of the node's text */
} damage;

static void glb_json(blob *b, const model_mesh *ball, const damage *d)
{
    const uint32_t vertex_bytes = 12 * ball->vertex_count, index_bytes = 12 * ball->triangle_count;
    blob_print(
        b,
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],",
        d->node ? d->node : "{\"mesh\":0}");
    blob_print(b,
               "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],");
    blob_print(
        b,
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\","
        "\"min\":[-1,-1,-1],\"max\":[1,1,1]},",
        ball->vertex_count + d->count_added);
    blob_print(b, "{\"bufferView\":1,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}],",
               3 * ball->triangle_count);
    blob_print(b,
               "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%u},{\"buffer\":0,\"byteOffset\":%u,"
               "\"byteLength\":%u}],",
               vertex_bytes, vertex_bytes + d->offset_added, index_bytes);
    blob_print(b, "\"buffers\":[{\"byteLength\":%u}]}", vertex_bytes + index_bytes);
    while (b->size % 4) {
        blob_add(b, " ", 1);
    }
}

static void make_glb(blob *b, const model_mesh *ball, const damage *d)
{
    const uint32_t bytes = 12 * (ball->vertex_count + ball->triangle_count);
    blob json = {.env = b->env};
    glb_json(&json, ball, d);
    blob_add_u32(b, MAGIC);
    blob_add_u32(b, 2);
    blob_add_u32(b, 28 + (uint32_t)json.size + bytes + d->length_added);
    blob_add_u32(b, (uint32_t)json.size + d->chunk_added);
    blob_add_u32(b, CHUNK_JSON);
    blob_add(b, json.data, json.size);
    blob_add_u32(b, bytes);
    blob_add_u32(b, CHUNK_BIN);
    for (uint32_t v = 0; v < ball->vertex_count; v++) {
        blob_add_f32(b, (float)ball->position[v].x + (v == 0 ? d->first_coordinate_added : 0));
        blob_add_f32(b, (float)ball->position[v].y);
        blob_add_f32(b, (float)ball->position[v].z);
    }
    for (uint32_t i = 0; i < 3 * ball->triangle_count; i++) {
        bool last = i + 1 == 3 * ball->triangle_count;
        blob_add_u32(b, ball->triangle[i / 3][i % 3] + (last ? d->index_added : 0));
    }
    b->size -= b->failed ? 0 : d->bytes_cut;
    b->failed |= json.failed;
    blob_release(&json);
}

static void infinite_bounds(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.first_coordinate_added = INFINITY});
}

static void nan_position(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.first_coordinate_added = NAN});
}

static void lying_length(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.length_added = 1u << 30});
}

static void lying_chunk(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.chunk_added = 0x7FFFFFF0});
}

static void lying_accessor(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.count_added = 3000000000u});
}

static void lying_view(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.offset_added = 4000000000u});
}

static void bad_index(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.index_added = 4000000000u});
}

static void truncated(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.bytes_cut = 12 * ball->triangle_count});
}

static void zero_scale(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.node = "{\"mesh\":0,\"scale\":[0,0,0]}"});
}

static void infinite_node(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.node = "{\"mesh\":0,\"translation\":[1e999,0,0]}"});
}

static void node_cycle(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.node = "{\"mesh\":0,\"children\":[0]}"});
}

static void missing_mesh(blob *b, const model_mesh *ball)
{
    make_glb(b, ball, &(damage){.node = "{\"mesh\":77}"});
}

/* JSON brackets opened and never closed: a parser that recurses without a limit runs out of stack.
 */
static void deep_json(blob *b, const model_mesh *ball)
{
    (void)ball;
    blob_add_u32(b, MAGIC);
    blob_add_u32(b, 2);
    blob_add_u32(b, 20 + NESTING);
    blob_add_u32(b, NESTING);
    blob_add_u32(b, CHUNK_JSON);
    for (int i = 0; i < NESTING; i++) {
        blob_add(b, "[", 1);
    }
}

const nasty_entry nasty_glb_table[] = {
    {"infinite_bounds.glb", 3, infinite_bounds},
    {"nan_position.glb", 3, nan_position},
    {"lying_length.glb", 3, lying_length},
    {"lying_chunk.glb", 3, lying_chunk},
    {"lying_accessor.glb", 3, lying_accessor},
    {"lying_view.glb", 3, lying_view},
    {"bad_index.glb", 3, bad_index},
    {"truncated.glb", 3, truncated},
    {"zero_scale.glb", 3, zero_scale},
    {"infinite_node.glb", 3, infinite_node},
    {"node_cycle.glb", -1, node_cycle},
    {"missing_mesh.glb", 3, missing_mesh},
    {"deep_json.glb", 3, deep_json},
};
const size_t nasty_glb_count = sizeof nasty_glb_table / sizeof nasty_glb_table[0];
