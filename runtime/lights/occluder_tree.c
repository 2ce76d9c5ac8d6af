/* occluder_tree.c - builds the boxes of what casts shadows.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lights/occluder_tree.h"

#include <string.h>

#include "core/memory.h"
#include "vec3.h"

/* A leaf holds at most LEAF_MAX triangles; beyond DEPTH_MAX boxes are halved by number, so that no
 * mesh makes a deep tree. */
enum { BIN_COUNT = 16, LEAF_MAX = 4, DEPTH_MAX = 40 };

/* What one step costs: a box takes one read, a triangle three and more arithmetic. */
static const float BOX_COST = 1.0f, TRIANGLE_COST = 1.2f;

/* A box of boxes that is larger than this share of the one around it parts too little. */
static const float KEPT_SHARE = 0.6f;

typedef struct tree_box {
    float lower[3], upper[3];
} tree_box;

typedef struct tree_builder {
    const float (*position)[3];
    const uint32_t (*triangle)[3];
    tree_box *box;             /* [triangle_count] */
    uint32_t *order;           /* [triangle_count] triangles, sorted as boxes are cut */
    float corner[3], scale[3]; /* to the grid of boxes */
    parian_occluder_tree *tree;
} tree_builder;

static void clear_box(tree_box *box)
{
    vec3_set(box->lower, INFINITY);
    vec3_set(box->upper, -INFINITY);
}

static void grow_box(tree_box *box, const tree_box *by)
{
    for (int c = 0; c < 3; c++) {
        box->lower[c] = fminf(box->lower[c], by->lower[c]);
        box->upper[c] = fmaxf(box->upper[c], by->upper[c]);
    }
}

/* Half the surface of a box; 0 for an empty one. */
static float box_area(const tree_box *box)
{
    float side[3];
    vec3_sub(side, box->upper, box->lower);
    return side[0] >= 0.0f ? side[0] * side[1] + side[1] * side[2] + side[2] * side[0] : 0.0f;
}

static float centre_of(const tree_builder *builder, uint32_t triangle, int axis)
{
    return 0.5f * (builder->box[triangle].lower[axis] + builder->box[triangle].upper[axis]);
}

/* ---- where to cut ---- */

typedef struct tree_cut {
    int axis; /* -1: a leaf is cheaper */
    float place;
    float cost;
} tree_cut;

static uint32_t bin_of(float centre, float low, float scale)
{
    float at = (centre - low) * scale;
    return at <= 0.0f ? 0 : at >= BIN_COUNT - 1 ? BIN_COUNT - 1 : (uint32_t)at;
}

static void try_axis(const tree_builder *builder, uint32_t first, uint32_t count, int axis,
                     float low, float high, tree_cut *best)
{
    tree_box box[BIN_COUNT], left;
    uint32_t in_bin[BIN_COUNT] = {0}, on_left = 0;
    float right_cost[BIN_COUNT], scale = BIN_COUNT / (high - low);
    for (int b = 0; b < BIN_COUNT; b++) {
        clear_box(&box[b]);
    }
    for (uint32_t i = first; i < first + count; i++) {
        uint32_t t = builder->order[i], b = bin_of(centre_of(builder, t, axis), low, scale);
        grow_box(&box[b], &builder->box[t]);
        in_bin[b]++;
    }
    clear_box(&left);
    for (uint32_t b = BIN_COUNT, n = 0; b-- > 1;) {
        grow_box(&left, &box[b]);
        n += in_bin[b];
        right_cost[b] = box_area(&left) * (float)n;
    }
    clear_box(&left);
    for (int b = 1; b < BIN_COUNT; b++) {
        grow_box(&left, &box[b - 1]);
        on_left += in_bin[b - 1];
        float cost = box_area(&left) * (float)on_left + right_cost[b];
        if (on_left > 0 && on_left < count && cost < best->cost) {
            *best = (tree_cut){axis, low + (float)b / scale, cost};
        }
    }
}

static tree_cut find_cut(const tree_builder *builder, uint32_t first, uint32_t count,
                         const tree_box *box)
{
    tree_cut best = {-1, 0.0f, INFINITY};
    for (int axis = 0; axis < 3; axis++) {
        float low = INFINITY, high = -INFINITY;
        for (uint32_t i = first; i < first + count; i++) {
            float centre = centre_of(builder, builder->order[i], axis);
            low = fminf(low, centre);
            high = fmaxf(high, centre);
        }
        if (high > low && isfinite(BIN_COUNT / (high - low))) {
            try_axis(builder, first, count, axis, low, high, &best);
        }
    }
    float area = box_area(box), leaf = TRIANGLE_COST * (float)count * area;
    bool dear = 2.0f * BOX_COST * area + TRIANGLE_COST * best.cost >= leaf;
    if (count <= LEAF_MAX && dear) {
        best.axis = -1;
    }
    return best;
}

/* Move what lies before the cut to the front; how many those are. */
static uint32_t partition(const tree_builder *builder, uint32_t first, uint32_t count,
                          const tree_cut *cut)
{
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t t = builder->order[first + i];
        if (centre_of(builder, t, cut->axis) < cut->place) {
            builder->order[first + i] = builder->order[first + left];
            builder->order[first + left++] = t;
        }
    }
    return left;
}

/* ---- boxes in order ---- */

static void write_triangle(const tree_builder *builder, uint32_t triangle)
{
    float(*to)[4] = builder->tree->element + builder->tree->element_count;
    const uint32_t *corner = builder->triangle[triangle];
    memset(to, 0, 3 * sizeof *to);
    vec3_copy(to[0], builder->position[corner[0]]);
    vec3_sub(to[1], builder->position[corner[1]], to[0]);
    vec3_sub(to[2], builder->position[corner[2]], to[0]);
    builder->tree->element_count += 3;
}

/* Steps of the grid around a box; a hundredth of a step is more than the walk rounds. */
static void write_box(const tree_builder *builder, const tree_box *box, float to[4])
{
    const float last = PARIAN_OCCLUDER_GRID - 1;
    for (int c = 0; c < 3; c++) {
        float low = floorf((box->lower[c] - builder->corner[c]) * builder->scale[c] - 0.01f);
        float high = ceilf((box->upper[c] - builder->corner[c]) * builder->scale[c] + 0.01f);
        to[c] = fmaxf(low, 0.0f) + PARIAN_OCCLUDER_GRID * fminf(high, last);
    }
}

/* around: half the surface of the box that holds these triangles. */
static void write_boxes(const tree_builder *builder, uint32_t first, uint32_t count, int depth,
                        float around)
{
    tree_box box;
    uint32_t at = builder->tree->element_count;
    clear_box(&box);
    for (uint32_t i = first; i < first + count; i++) {
        grow_box(&box, &builder->box[builder->order[i]]);
    }
    tree_cut cut = find_cut(builder, first, count, &box);
    bool leaf = count == 1 || (count <= LEAF_MAX && cut.axis < 0);
    bool kept = leaf || box_area(&box) <= KEPT_SHARE * around;
    float *to = builder->tree->element[at];
    if (kept) {
        write_box(builder, &box, to);
        around = box_area(&box);
        builder->tree->element_count++;
    }
    if (leaf) {
        for (uint32_t i = first; i < first + count; i++) {
            write_triangle(builder, builder->order[i]);
        }
    } else {
        uint32_t left =
            cut.axis >= 0 && depth < DEPTH_MAX ? partition(builder, first, count, &cut) : count / 2;
        left = left > 0 && left < count ? left : count / 2;
        write_boxes(builder, first, left, depth + 1, around);
        write_boxes(builder, first + left, count - left, depth + 1, around);
    }
    if (kept) {
        to[3] = (leaf ? -1.0f : 1.0f) * (float)builder->tree->element_count;
    }
}

typedef struct caster_mesh {
    uint32_t vertex_count, triangle_count;
    const float (*position)[3];
    const uint32_t (*triangle)[3];
} caster_mesh;

static caster_mesh mesh_of(const parian_scene_data *scene, uint32_t index)
{
    if (index < scene->body_count) {
        const parian_body *body = &scene->bodies[index];
        return (caster_mesh){body->vertex_count, body->triangle_count,
                             (const float(*)[3])body->vertex_position,
                             (const uint32_t(*)[3])body->triangle};
    }
    const parian_surrounding *piece = &scene->surroundings[index - scene->body_count];
    return (caster_mesh){piece->vertex_count, piece->triangle_count,
                         (const float(*)[3])piece->vertex_position,
                         (const uint32_t(*)[3])piece->triangle};
}

static void find_boxes(tree_builder *builder, const caster_mesh *mesh)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        clear_box(&builder->box[t]);
        for (int k = 0; k < 3; k++) {
            const float *p = mesh->position[mesh->triangle[t][k]];
            tree_box corner;
            vec3_copy(corner.lower, p);
            vec3_copy(corner.upper, p);
            grow_box(&builder->box[t], &corner);
        }
        builder->order[t] = t;
    }
}

/* The grid has a step to spare on each side; a flat mesh gets steps of its largest side. */
static void write_grid(tree_builder *builder, uint32_t triangle_count)
{
    float(*to)[4] = builder->tree->element + builder->tree->element_count;
    tree_box all;
    float side[3];
    clear_box(&all);
    for (uint32_t t = 0; t < triangle_count; t++) {
        grow_box(&all, &builder->box[t]);
    }
    vec3_sub(side, all.upper, all.lower);
    float largest = fmaxf(fmaxf(side[0], side[1]), fmaxf(side[2], 1e-20f));
    for (int c = 0; c < 3; c++) {
        float step = fmaxf(side[c], 1e-3f * largest) / (PARIAN_OCCLUDER_GRID - 3);
        builder->corner[c] = to[0][c] = all.lower[c] - step;
        builder->scale[c] = to[1][c] = 1.0f / step;
    }
    builder->tree->element_count += 2;
}

static parian_result add_mesh(const parian_env *env, const caster_mesh *mesh,
                              parian_occluder_tree *tree)
{
    tree_builder builder = {.position = mesh->position, .triangle = mesh->triangle, .tree = tree};
    parian_result result = PARIAN_OK;
    if (!PARIAN_NEW(env, builder.box, mesh->triangle_count) ||
        !PARIAN_NEW(env, builder.order, mesh->triangle_count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory to sort %u triangles",
                             mesh->triangle_count);
    } else if (mesh->triangle_count > 0) {
        find_boxes(&builder, mesh);
        write_grid(&builder, mesh->triangle_count);
        write_boxes(&builder, 0, mesh->triangle_count, 0, INFINITY);
    }
    parian_free(env, builder.box);
    parian_free(env, builder.order);
    return result;
}

uint64_t parian_occluder_tree_room(const parian_scene_data *scene)
{
    uint64_t elements = 1;
    for (uint32_t m = 0; m < scene->body_count + scene->surrounding_count; m++) {
        /* A grid, a box for each triangle, and those above. */
        elements += 2 + 5 * (uint64_t)mesh_of(scene, m).triangle_count;
    }
    return (elements + PARIAN_OCCLUDER_ROW - 1) / PARIAN_OCCLUDER_ROW * PARIAN_OCCLUDER_ROW;
}

parian_result parian_occluder_tree_build(const parian_env *env, const parian_scene_data *scene,
                                         parian_occluder_tree *tree)
{
    parian_occluder_tree made = {.mesh_count = scene->body_count + scene->surrounding_count};
    uint64_t elements = parian_occluder_tree_room(scene);
    parian_result result = PARIAN_OK;
    if (elements > PARIAN_OCCLUDER_ELEMENT_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT,
                           "shadows of this scene need %llu elements, at most %d are possible",
                           (unsigned long long)elements, PARIAN_OCCLUDER_ELEMENT_MAX);
    }
    if (!PARIAN_NEW0(env, made.element, (size_t)elements) ||
        !PARIAN_NEW(env, made.first, (size_t)made.mesh_count + 1)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for shadows of %llu elements",
                             (unsigned long long)elements);
    }
    for (uint32_t m = 0; m < made.mesh_count && result == PARIAN_OK; m++) {
        caster_mesh mesh = mesh_of(scene, m);
        made.first[m] = made.element_count;
        result = add_mesh(env, &mesh, &made);
    }
    if (result != PARIAN_OK) {
        parian_occluder_tree_free(env, &made);
        return result;
    }
    made.first[made.mesh_count] = made.element_count;
    *tree = made;
    return PARIAN_OK;
}

parian_caster parian_caster_place(const parian_occluder_tree *tree, uint32_t mesh,
                                  const parian_placement *at)
{
    parian_caster caster = {.first = (float)tree->first[mesh], .end = (float)tree->first[mesh + 1]};
    for (int r = 0; r < 3; r++) {
        float *row = caster.row[r];
        if (!at) {
            row[r] = 1.0f;
            continue;
        }
        for (int c = 0; c < 3; c++) {
            row[c] = at->model[4 * r + c] / (at->scale * at->scale);
        }
        row[3] = -vec3_dot(row, &at->model[12]);
    }
    return caster;
}

void parian_occluder_tree_free(const parian_env *env, parian_occluder_tree *tree)
{
    if (tree) {
        parian_free(env, tree->element);
        parian_free(env, tree->first);
        memset(tree, 0, sizeof *tree);
    }
}
