/* transfer_mesh_remesh.c - remeshes one component to a wanted number of near-equilateral triangles.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

enum { ROUNDS_MIN = 3, ROUNDS_MAX = 12 };
static const double count_tolerance = 0.015;
/* A source with more than so many times the wanted vertices is decimated to so many times of them.
 */
static const double dense_from = 16.0, dense_to = 6.0;
static const double crease_deg = 60.0;
/* A rounded ridge turns by so much between the averages over so many edges squared on each side: it
 * has a radius below about 1.4 edges. */
static const double ridge_deg = 40.0, ridge_area = 2.0;
/* A crease shorter than this many edges of the transfer mesh is noise to it. */
static const double feature_edges = 6.0;
/* Remeshing leaves edges between 4/5 and 4/3 of the length asked for, and more of the short ones:
 * that many more vertices than equilateral triangles of that length would have. */
static const double count_excess = 1.16;

/* Exponents by which the edge length follows the count. It falls by itself from round to round, and
 * rises little, because only the longest edges are split. */
static const double exponent_down = 0.25, exponent_up = 1.5;

/* The edge length of an equilateral triangulation of part->area with part->target vertices. */
static double edge_for_target(const transfer_part *part)
{
    return sqrt(2.0 * part->area / (sqrt(3.0) * part->target));
}

/* Relax the mesh along the source after a round. */
static parian_result relax_round(const parian_env *env, const parian_closest *source,
                                 parian_remesher *remesher, double reach)
{
    parian_mesh mesh = {0};
    parian_remesher_features features = {0};
    parian_result result = parian_remesher_copy(env, remesher, &mesh, &features);
    if (result == PARIAN_OK) {
        result = parian_transfer_relax(env, source, &features, reach, &mesh);
    }
    if (result == PARIAN_OK) {
        parian_remesher_move(remesher, (const double(*)[3])mesh.position);
    }
    parian_remesher_features_free(env, &features);
    parian_mesh_free(env, &mesh);
    return result;
}

static bool is_met(uint32_t count, uint32_t target)
{
    double slack = count_tolerance * target;
    return fabs((double)count - target) <= (slack > 0.5 ? slack : 0.5);
}

/* Rounds of remeshing whose edge length follows the count; a round leaves alone what is within its
 * limits, so that the count answers slowly. */
static parian_result run_rounds(const parian_env *env, const parian_closest *source,
                                const transfer_part *part, parian_remesher *remesher)
{
    double edge = edge_for_target(part), length = edge * sqrt(count_excess);
    for (int round = 0; round < ROUNDS_MAX; round++) {
        if (parian_cancelled(env)) {
            return PARIAN_E_INTERRUPTED;
        }
        parian_result result = parian_remesher_run(env, remesher, length);
        if (result == PARIAN_OK) {
            result = relax_round(env, source, remesher, edge);
        }
        if (result != PARIAN_OK) {
            return result;
        }
        uint32_t count = parian_remesher_vertex_count(remesher);
        parian_log(env, PARIAN_LOG_DEBUG, "transfer mesh: round %d, edge %g m, %u vertices of %u",
                   round, length, count, part->target);
        if (round + 1 >= ROUNDS_MIN && is_met(count, part->target)) {
            break;
        }
        double ratio = (double)count / part->target;
        length *= pow(ratio, ratio > 1.0 ? exponent_down : exponent_up);
    }
    return PARIAN_OK;
}

static parian_result finish(const parian_env *env, const parian_closest *source,
                            parian_remesher *remesher, transfer_part *part)
{
    double reach = edge_for_target(part);
    parian_remesher_features features = {0};
    parian_result result = parian_remesher_repair(env, remesher);
    if (result == PARIAN_OK) {
        result = parian_remesher_copy(env, remesher, &part->result, &features);
    }
    if (result == PARIAN_OK) {
        result = parian_transfer_untangle(env, features.on, &part->result);
    }
    if (result == PARIAN_OK) {
        result = parian_transfer_relax(env, source, &features, reach, &part->result);
    }
    if (result == PARIAN_OK) {
        result = parian_transfer_fit(env, source, features.on, reach, &part->result);
    }
    if (result == PARIAN_OK) {
        result = parian_transfer_untangle(env, features.on, &part->result);
    }
    parian_remesher_features_free(env, &features);
    return result;
}

/* What the rounds begin with: the source, or where that is much denser, a decimated copy. */
static parian_result begin(const parian_env *env, const transfer_part *part,
                           parian_remesher **remesher)
{
    double edge = edge_for_target(part);
    parian_remesher_desc desc = {.crease_deg = crease_deg,
                                 .feature_area = 0.5 * edge * edge,
                                 .feature_length = feature_edges * edge,
                                 .corner_length = edge,
                                 .ridge_deg = ridge_deg,
                                 .ridge_area = ridge_area * edge * edge};
    parian_mesh thin = {0};
    const parian_mesh *from = &part->source;
    double(*side)[3] = NULL;
    parian_result result = PARIAN_OK;
    if (part->source.vertex_count > dense_from * part->target) {
        uint32_t left = (uint32_t)(dense_to * part->target);
        result = parian_transfer_decimate(env, &part->source, left, &thin);
    }
    if (thin.triangle_count) {
        from = &thin;
    }
    if (result == PARIAN_OK && !PARIAN_NEW(env, side, from->triangle_count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for ridges");
    }
    if (result == PARIAN_OK) {
        result = parian_transfer_sides(env, from, edge, side);
    }
    if (result == PARIAN_OK) {
        desc.side = (const double(*)[3])side;
        result = parian_remesher_create(env, from, &desc, remesher);
    }
    parian_free(env, side);
    parian_mesh_free(env, &thin);
    return result;
}

parian_result parian_transfer_remesh(const parian_env *env, const parian_closest *source,
                                     transfer_part *part)
{
    parian_remesher *remesher = NULL;
    parian_result result = begin(env, part, &remesher);
    if (result == PARIAN_OK) {
        result = run_rounds(env, source, part, remesher);
    }
    if (result == PARIAN_OK) {
        result = finish(env, source, remesher, part);
    }
    parian_remesher_destroy(remesher);
    return result;
}
