/* transfer_mesh_decimate.c - thins a dense source out by quadrics, in pieces that run side by side.
 *
 * The triangles are cut into pieces along a Hilbert curve; vertices where pieces meet, and those of
 * the border, stay. How many pieces there are depends on the mesh alone.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>

#include "bake/adapters/openmesh_decimate.h"
#include "bake/stages/transfer_mesh_parts.h"
#include "core/disjoint_sets.h"
#include "core/memory.h"

enum { PIECE_TRIANGLES = 32000 };

typedef struct decimate_job {
    const parian_env *env;
    const parian_mesh *source;
    const uint32_t (*neighbour)[3]; /* half-edges, as parian_triangle_neighbours gives them */
    const uint32_t *order;          /* [triangle_count] triangles along the curve */
    const uint32_t *place;          /* [triangle_count] where in order a triangle is */
    uint32_t piece_count;
    double share; /* of the vertices, to be left */
    uint32_t (*kept)[3];
    uint32_t *kept_count;  /* [piece_count] */
    parian_result *result; /* [piece_count] */
} decimate_job;

/* A piece: its own vertices, one for each fan of its triangles around a vertex of the source. */
typedef struct piece {
    parian_mesh mesh;
    uint32_t *parent; /* [3 * triangle_count] forest of corners that share a vertex */
    uint32_t *origin; /* [vertex_count] vertex of the source */
    bool *locked;
} piece;

static uint32_t piece_begin(const decimate_job *job, uint32_t index)
{
    return (uint32_t)((uint64_t)job->source->triangle_count * index / job->piece_count);
}

/* The half-edge of the piece across another one; PARIAN_NO_NEIGHBOUR at the rim of the piece. */
static uint32_t across(const decimate_job *job, uint32_t begin, uint32_t end, uint32_t i)
{
    uint32_t half = job->neighbour[job->order[begin + i / 3]][i % 3];
    if (half == PARIAN_NO_NEIGHBOUR) {
        return half;
    }
    uint32_t place = job->place[half / 3];
    return place < begin || place >= end ? PARIAN_NO_NEIGHBOUR : 3 * (place - begin) + half % 3;
}

static uint32_t next_corner(uint32_t i)
{
    return i % 3 == 2 ? i - 2 : i + 1;
}

static void join_corners(const decimate_job *job, uint32_t begin, uint32_t end, piece *out)
{
    uint32_t corner_count = 3 * (end - begin);
    for (uint32_t i = 0; i < corner_count; i++) {
        out->parent[i] = i;
    }
    for (uint32_t i = 0; i < corner_count; i++) {
        uint32_t other = across(job, begin, end, i);
        if (other != PARIAN_NO_NEIGHBOUR) {
            parian_set_join(out->parent, i, next_corner(other));
            parian_set_join(out->parent, next_corner(i), other);
        }
    }
}

static void number_vertices(const decimate_job *job, uint32_t begin, uint32_t end, piece *out)
{
    const parian_mesh *source = job->source;
    uint32_t *local = &out->mesh.triangle[0][0];
    for (uint32_t i = 0; i < 3 * (end - begin); i++) {
        uint32_t root = parian_set_root(out->parent, i);
        if (root != i) {
            local[i] = local[root];
            continue;
        }
        uint32_t v = out->mesh.vertex_count++;
        uint32_t origin = source->triangle[job->order[begin + i / 3]][i % 3];
        local[i] = v;
        out->origin[v] = origin;
        out->locked[v] = false;
        memcpy(out->mesh.position[v], source->position[origin], sizeof out->mesh.position[0]);
    }
}

/* Lock the rim and what is next to it; returns how many vertices are locked. The rim itself is
 * marked in the forest of corners, which is not needed any more. */
static uint32_t lock_rim(const decimate_job *job, uint32_t begin, uint32_t end, piece *out)
{
    const uint32_t *local = &out->mesh.triangle[0][0];
    uint32_t count = 0, *on_rim = out->parent;
    memset(on_rim, 0, out->mesh.vertex_count * sizeof *on_rim);
    for (uint32_t i = 0; i < 3 * (end - begin); i++) {
        if (across(job, begin, end, i) == PARIAN_NO_NEIGHBOUR) {
            on_rim[local[i]] = 1;
            on_rim[local[next_corner(i)]] = 1;
        }
    }
    for (uint32_t t = 0; t < out->mesh.triangle_count; t++) {
        const uint32_t *c = out->mesh.triangle[t];
        for (int k = 0; k < 3 && (on_rim[c[0]] || on_rim[c[1]] || on_rim[c[2]]); k++) {
            count += !out->locked[c[k]];
            out->locked[c[k]] = true;
        }
    }
    return count;
}

static bool allocate_piece(const parian_env *env, uint32_t triangle_count, piece *out)
{
    size_t corner_count = 3 * (size_t)triangle_count;
    out->mesh.triangle_count = triangle_count;
    return PARIAN_NEW(env, out->parent, corner_count) &&
           PARIAN_NEW(env, out->origin, corner_count) &&
           PARIAN_NEW(env, out->locked, corner_count) &&
           PARIAN_NEW(env, out->mesh.position, corner_count) &&
           PARIAN_NEW(env, out->mesh.triangle, triangle_count);
}

static void free_piece(const parian_env *env, piece *out)
{
    parian_mesh_free(env, &out->mesh);
    parian_free(env, out->parent);
    parian_free(env, out->origin);
    parian_free(env, out->locked);
}

static void decimate_piece(void *context, size_t index)
{
    decimate_job *job = context;
    uint32_t begin = piece_begin(job, (uint32_t)index), end = piece_begin(job, (uint32_t)index + 1);
    piece work = {0};
    parian_result result = PARIAN_E_INTERRUPTED;
    if (parian_cancelled(job->env)) {
        goto done;
    }
    if (!allocate_piece(job->env, end - begin, &work)) {
        result = parian_fail(job->env, PARIAN_E_NOMEM, "transfer mesh: out of memory for a piece");
        goto done;
    }
    join_corners(job, begin, end, &work);
    number_vertices(job, begin, end, &work);
    uint32_t locked = lock_rim(job, begin, end, &work);
    result = parian_decimate(job->env, &work.mesh, work.locked,
                             locked + (uint32_t)(job->share * (work.mesh.vertex_count - locked)));
    for (uint32_t t = 0; result == PARIAN_OK && t < work.mesh.triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            job->kept[begin + t][k] = work.origin[work.mesh.triangle[t][k]];
        }
    }
    job->kept_count[index] = work.mesh.triangle_count;
done:
    free_piece(job->env, &work);
    job->result[index] = result;
}

static uint32_t count_borders(uint32_t triangle_count, const uint32_t (*neighbour)[3])
{
    uint32_t count = 0;
    for (size_t i = 0; i < 3 * (size_t)triangle_count; i++) {
        count += neighbour[i / 3][i % 3] == PARIAN_NO_NEIGHBOUR;
    }
    return count;
}

/* Close the gaps between the pieces' triangles, and drop the vertices that no triangle has. */
static parian_result gather(const parian_env *env, const decimate_job *job, parian_mesh *mesh)
{
    const parian_mesh *source = job->source;
    parian_mesh made = {.vertex_count = 0};
    uint32_t *renumber;
    for (uint32_t p = 0; p < job->piece_count; p++) {
        memmove(job->kept + made.triangle_count, job->kept + piece_begin(job, p),
                job->kept_count[p] * sizeof *job->kept);
        made.triangle_count += job->kept_count[p];
    }
    if (!PARIAN_NEW(env, renumber, source->vertex_count) ||
        !PARIAN_NEW(env, made.position, source->vertex_count) ||
        !PARIAN_NEW(env, made.triangle, made.triangle_count)) {
        parian_free(env, renumber);
        parian_mesh_free(env, &made);
        return parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for decimation");
    }
    memset(renumber, 0xFF, source->vertex_count * sizeof *renumber);
    for (uint32_t t = 0; t < made.triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            uint32_t v = job->kept[t][k];
            if (renumber[v] == 0xFFFFFFFFu) {
                renumber[v] = made.vertex_count++;
                memcpy(made.position[renumber[v]], source->position[v], sizeof made.position[0]);
            }
            made.triangle[t][k] = renumber[v];
        }
    }
    parian_free(env, renumber);
    *mesh = made;
    return PARIAN_OK;
}

/* Whether the border is as long as before: a last check that the pieces still fit. */
static parian_result check_borders(const parian_env *env, const parian_mesh *mesh,
                                   uint32_t border_count, bool *intact)
{
    uint32_t(*neighbour)[3];
    if (!PARIAN_NEW(env, neighbour, mesh->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for decimation");
    }
    parian_result result =
        parian_triangle_neighbours(env, mesh->vertex_count, mesh->triangle_count,
                                   (const uint32_t(*)[3])mesh->triangle, neighbour);
    *intact = result == PARIAN_OK &&
              count_borders(mesh->triangle_count, (const uint32_t(*)[3])neighbour) == border_count;
    parian_free(env, neighbour);
    return result;
}

static parian_result run_pieces(const parian_env *env, decimate_job *job, parian_mesh *mesh)
{
    bool intact = false;
    parian_result result = PARIAN_OK;
    parian_mesh made = {0};
    parian_par(env, job->piece_count, decimate_piece, job);
    for (uint32_t p = 0; p < job->piece_count && result == PARIAN_OK; p++) {
        result = job->result[p];
    }
    if (result == PARIAN_OK) {
        result = gather(env, job, &made);
    }
    if (result == PARIAN_OK) {
        uint32_t borders = count_borders(job->source->triangle_count, job->neighbour);
        result = check_borders(env, &made, borders, &intact);
    }
    if (result == PARIAN_OK && intact) {
        *mesh = made;
    } else {
        parian_mesh_free(env, &made);
    }
    return result;
}

/* Triangles in the order of their centroids along a curve, and where each is in it. */
static parian_result order_triangles(const parian_env *env, const parian_mesh *mesh,
                                     uint32_t *order, uint32_t *place)
{
    double(*centroid)[3];
    if (!PARIAN_NEW(env, centroid, mesh->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for decimation");
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangle[t];
        for (int k = 0; k < 3; k++) {
            centroid[t][k] =
                (mesh->position[c[0]][k] + mesh->position[c[1]][k] + mesh->position[c[2]][k]) / 3.0;
        }
    }
    parian_result result =
        parian_transfer_curve(env, mesh->triangle_count, (const double(*)[3])centroid, order);
    for (uint32_t i = 0; result == PARIAN_OK && i < mesh->triangle_count; i++) {
        place[order[i]] = i;
    }
    parian_free(env, centroid);
    return result;
}

parian_result parian_transfer_decimate(const parian_env *env, const parian_mesh *source,
                                       uint32_t vertex_target, parian_mesh *mesh)
{
    parian_result result = PARIAN_E_NOMEM;
    uint32_t count = source->triangle_count, *order = NULL, *place = NULL;
    uint32_t(*neighbour)[3] = NULL;
    decimate_job job = {.env = env, .source = source};
    job.piece_count = (count + PIECE_TRIANGLES - 1) / PIECE_TRIANGLES;
    job.share = (double)vertex_target / source->vertex_count;
    if (!PARIAN_NEW(env, order, count) || !PARIAN_NEW(env, place, count) ||
        !PARIAN_NEW(env, neighbour, count) || !PARIAN_NEW(env, job.kept, count) ||
        !PARIAN_NEW(env, job.kept_count, job.piece_count) ||
        !PARIAN_NEW(env, job.result, job.piece_count)) {
        parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for decimation");
        goto done;
    }
    result = order_triangles(env, source, order, place);
    if (result == PARIAN_OK) {
        result = parian_triangle_neighbours(env, source->vertex_count, count,
                                            (const uint32_t(*)[3])source->triangle, neighbour);
    }
    if (result == PARIAN_OK) {
        job.order = order;
        job.place = place;
        job.neighbour = (const uint32_t(*)[3])neighbour;
        result = run_pieces(env, &job, mesh);
    }
done:
    parian_free(env, job.result);
    parian_free(env, job.kept_count);
    parian_free(env, job.kept);
    parian_free(env, neighbour);
    parian_free(env, place);
    parian_free(env, order);
    return result;
}
