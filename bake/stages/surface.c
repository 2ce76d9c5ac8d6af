/* surface.c - makes a sound surface of a source mesh: the steps in order, and what is said about
 * them.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/surface.h"

#include <math.h>

#include "bake/adapters/cgal_surface.h"
#include "bake/stages/surface_steps.h"
#include "core/memory.h"

/* Vertices nearer than this share of the bounding box's diagonal are one; triangles lower are flat.
 */
static const double weld_share = 1e-7;

enum { CROSSING_TRIANGLES_MAX = 500000, CROSSINGS_MAX = 1000000 };

static parian_result refuse_empty(const parian_env *env, const parian_mesh *mesh, uint32_t before)
{
    if (mesh->triangle_count > 0) {
        return PARIAN_OK;
    }
    return parian_fail(env, PARIAN_E_FORMAT,
                       "none of the %u triangles has an area, expected a surface", before);
}

static double diagonal(const parian_mesh *mesh)
{
    double lower[3], upper[3];
    parian_mesh_bounds(mesh, lower, upper);
    return sqrt((upper[0] - lower[0]) * (upper[0] - lower[0]) +
                (upper[1] - lower[1]) * (upper[1] - lower[1]) +
                (upper[2] - lower[2]) * (upper[2] - lower[2]));
}

/* Welding and everything else that depends on positions alone. */
static parian_result clean(const parian_env *env, parian_mesh *mesh, parian_surface_report *report)
{
    uint32_t before = mesh->triangle_count, dropped;
    parian_result result = surface_drop_unreferenced(env, mesh, &report->unreferenced_vertices);
    double tolerance = weld_share * diagonal(mesh);
    if (result == PARIAN_OK && !(tolerance > 0 && isfinite(tolerance))) {
        return parian_fail(env, PARIAN_E_FORMAT,
                           "a bounding box diagonal of %g, expected a surface of finite size",
                           tolerance / weld_share);
    }
    if (result == PARIAN_OK) {
        result = surface_weld(env, mesh, tolerance, &report->welded_vertices);
    }
    if (result == PARIAN_OK) {
        result = surface_drop_duplicates(env, mesh, &report->duplicate_triangles);
    }
    if (result == PARIAN_OK) {
        result = surface_drop_degenerate(env, mesh, tolerance, &report->degenerate_triangles);
    }
    if (result == PARIAN_OK) {
        result = surface_drop_unreferenced(env, mesh, &dropped);
    }
    return result == PARIAN_OK ? refuse_empty(env, mesh, before) : result;
}

static parian_result check_crossings(const parian_env *env, const parian_mesh *mesh,
                                     parian_surface_report *report)
{
    if (mesh->triangle_count > CROSSING_TRIANGLES_MAX) {
        parian_log(env, PARIAN_LOG_INFO,
                   "surface: self-intersections are not looked for above %d triangles",
                   CROSSING_TRIANGLES_MAX);
        return PARIAN_OK;
    }
    return parian_cgal_count_crossings(env, mesh, CROSSINGS_MAX, &report->self_intersections);
}

static void warn_count(const parian_env *env, uint32_t count, const char *what)
{
    if (count > 0) {
        parian_log(env, PARIAN_LOG_WARNING, "surface: %u %s", count, what);
    }
}

static void say(const parian_env *env, const parian_surface_report *report, uint32_t turned_over)
{
    if (report->welded_vertices > 0) {
        parian_log(env, PARIAN_LOG_INFO,
                   "surface: %u vertices were merged with one at the same place",
                   report->welded_vertices);
    }
    warn_count(env, report->unreferenced_vertices, "vertices without a triangle were dropped");
    warn_count(env, report->degenerate_triangles, "triangles without an area were taken out");
    warn_count(env, report->duplicate_triangles, "triangles that repeat another were dropped");
    warn_count(env, turned_over, "triangles were turned so that neighbours agree");
    warn_count(
        env, report->split_vertices,
        "vertices were duplicated where more than two triangles share an edge or sheets touch");
    if (!report->orientable) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "surface: it cannot be oriented (as a Moebius strip): it was cut");
    }
    if (report->inverted) {
        parian_log(env, PARIAN_LOG_WARNING, "surface: it was inside out and was turned");
    } else {
        warn_count(env, report->flipped_triangles - turned_over,
                   "triangles of parts that were inside out were turned");
    }
    if (!report->closed) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "surface: it is open, with %u boundary edges; thickness is not known there",
                   report->boundary_edges);
    }
    if (report->components > 1) {
        parian_log(env, PARIAN_LOG_WARNING, "surface: it has %u separate parts",
                   report->components);
    }
    warn_count(env, report->self_intersections,
               "pairs of triangles cross; they are left as they are");
}

parian_result parian_stage_surface(const parian_env *env, parian_mesh *mesh,
                                   parian_surface_report *report)
{
    parian_surface_report made = {0};
    uint32_t *mate = NULL, turned_over = 0;
    if (!mesh || !report) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "surface: no mesh or no report given");
    }
    parian_result result = refuse_empty(env, mesh, 0);
    if (result == PARIAN_OK) {
        result = clean(env, mesh, &made);
    }
    if (result == PARIAN_OK) {
        result = surface_make_manifold(env, mesh, &mate, &made);
    }
    if (result == PARIAN_OK) {
        turned_over = made.flipped_triangles;
        result = surface_face_outward(env, mesh, mate, &made);
    }
    parian_free(env, mate);
    if (result == PARIAN_OK && parian_cancelled(env)) {
        result = PARIAN_E_INTERRUPTED;
    }
    if (result == PARIAN_OK) {
        result = check_crossings(env, mesh, &made);
    }
    if (result == PARIAN_OK) {
        say(env, &made, turned_over);
        *report = made;
    }
    return result;
}
