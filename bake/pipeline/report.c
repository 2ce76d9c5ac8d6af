/* report.c - the report of a bake, as log lines and as JSON.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/pipeline/report.h"

#include <string.h>

#include <cjson/cJSON.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/session.h"

void parian_report_stage(parian_body_report *report, const char *name, double seconds)
{
    if (report->stage_count < PARIAN_STAGE_MAX) {
        report->stage[report->stage_count++] = (parian_stage_time){name, seconds};
    }
}

static void log_body(const parian_env *env, const parian_body_report *b)
{
    parian_log(
        env, PARIAN_LOG_INFO,
        "%s: %u vertices (edge %.3g mm), %u texels of %.3g mm in %u charts, %llu factors a channel",
        b->name, b->transfer_mesh.vertex_count, 1e3 * b->transfer_mesh.edge_mean_m, b->texel_count,
        1e3 * b->atlas.texel_edge_m, b->atlas.chart_count,
        (unsigned long long)b->global.factor_count);
    parian_log(env, PARIAN_LOG_INFO, "%s: distance to the source: rms %.3g mm, largest %.3g mm",
               b->name, 1e3 * b->transfer_mesh.distance_rms_m,
               1e3 * b->transfer_mesh.distance_max_m);
}

void parian_report_log(const parian_env *env, const parian_bake_report *report)
{
    for (uint32_t i = 0; i < report->body_count; i++) {
        log_body(env, &report->bodies[i]);
    }
    parian_log(env, PARIAN_LOG_INFO,
               "%u bodies, %u surroundings, %.1f MB, %.2f s, peak memory %.0f MB",
               report->body_count, report->surrounding_count, (double)report->file_size / 1e6,
               report->total_seconds, (double)parian_peak_memory() / 1e6);
}

static void add_triple(cJSON *object, const char *name, const double value[3])
{
    cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(value, 3));
}

static void add_surface(cJSON *parent, const parian_surface_report *s)
{
    cJSON *o = cJSON_AddObjectToObject(parent, "surface");
    cJSON_AddNumberToObject(o, "welded_vertices", s->welded_vertices);
    cJSON_AddNumberToObject(o, "unreferenced_vertices", s->unreferenced_vertices);
    cJSON_AddNumberToObject(o, "degenerate_triangles", s->degenerate_triangles);
    cJSON_AddNumberToObject(o, "duplicate_triangles", s->duplicate_triangles);
    cJSON_AddNumberToObject(o, "split_vertices", s->split_vertices);
    cJSON_AddNumberToObject(o, "flipped_triangles", s->flipped_triangles);
    cJSON_AddNumberToObject(o, "components", s->components);
    cJSON_AddNumberToObject(o, "boundary_edges", s->boundary_edges);
    cJSON_AddNumberToObject(o, "self_intersections", s->self_intersections);
    cJSON_AddBoolToObject(o, "closed", s->closed);
    cJSON_AddBoolToObject(o, "inverted", s->inverted);
    cJSON_AddBoolToObject(o, "orientable", s->orientable);
}

static void add_transfer_mesh(cJSON *parent, const parian_transfer_mesh_report *t)
{
    cJSON *o = cJSON_AddObjectToObject(parent, "transfer_mesh");
    cJSON_AddNumberToObject(o, "vertices", t->vertex_count);
    cJSON_AddNumberToObject(o, "triangles", t->triangle_count);
    cJSON_AddNumberToObject(o, "edge_mean_m", t->edge_mean_m);
    cJSON_AddNumberToObject(o, "edge_min_m", t->edge_min_m);
    cJSON_AddNumberToObject(o, "edge_max_m", t->edge_max_m);
    cJSON_AddNumberToObject(o, "quality_mean", t->quality_mean);
    cJSON_AddNumberToObject(o, "distance_rms_m", t->distance_rms_m);
    cJSON_AddNumberToObject(o, "distance_max_m", t->distance_max_m);
    cJSON_AddNumberToObject(o, "area_ratio", t->area_ratio);
    cJSON_AddBoolToObject(o, "source_is_denser", t->source_is_denser);
}

static void add_atlas(cJSON *parent, const parian_body_report *b)
{
    cJSON *o = cJSON_AddObjectToObject(parent, "atlas");
    cJSON_AddNumberToObject(o, "charts", b->atlas.chart_count);
    cJSON_AddNumberToObject(o, "occupancy", b->atlas.occupancy);
    cJSON_AddNumberToObject(o, "texel_edge_m", b->atlas.texel_edge_m);
    cJSON_AddNumberToObject(o, "stretch_max", b->atlas.stretch_max);
    cJSON_AddNumberToObject(o, "texels", b->texel_count);
    cJSON_AddNumberToObject(o, "border_texels", b->border_count);
    cJSON_AddNumberToObject(o, "gutter_texels", b->gutter_count);
    cJSON_AddBoolToObject(o, "normal_map", b->has_normal_map);
    cJSON_AddBoolToObject(o, "surface_texture", b->has_albedo);
}

static void add_plan(cJSON *parent, const parian_plan *p)
{
    cJSON *o = cJSON_AddObjectToObject(parent, "plan");
    cJSON_AddBoolToObject(o, "local", p->local);
    cJSON_AddBoolToObject(o, "global", p->global);
    cJSON_AddStringToObject(o, "reason", p->reason);
    add_triple(o, "mean_free_path_m", p->mean_free_path_m);
    cJSON_AddNumberToObject(o, "extent_m", p->extent_m);
    cJSON_AddNumberToObject(o, "texel_edge_m", p->texel_edge_m);
    cJSON_AddNumberToObject(o, "vertex_edge_m", p->vertex_edge_m);
    cJSON_AddNumberToObject(o, "error_without_local", p->error_without_local);
    cJSON_AddNumberToObject(o, "error_without_global", p->error_without_global);
}

/* Percentiles that are infinite, where rays leave by an open rim, are null. */
static void add_thickness(cJSON *parent, const parian_thickness_report *t)
{
    cJSON *o = cJSON_AddObjectToObject(parent, "thickness");
    cJSON_AddNumberToObject(o, "thin_m", t->thin_m);
    cJSON_AddNumberToObject(o, "median_m", t->median_m);
    cJSON_AddNumberToObject(o, "mean_free_path_m", t->flight_m);
    cJSON_AddNumberToObject(o, "thin_share", t->thin_share);
}

static void add_transport(cJSON *parent, const parian_body_report *b)
{
    cJSON *o = cJSON_AddObjectToObject(parent, "global");
    cJSON_AddNumberToObject(o, "factors_per_channel", (double)b->global.factor_count);
    cJSON_AddNumberToObject(o, "kept_share", b->global.kept_share);
    cJSON_AddStringToObject(o, "hierarchy", b->global.hierarchy);
    cJSON *levels = cJSON_AddArrayToObject(o, "level_points");
    for (uint32_t l = 0; l < b->global.level_count; l++) {
        cJSON_AddItemToArray(levels, cJSON_CreateNumber(b->global.level_points[l]));
    }
    cJSON_AddNumberToObject(o, "lost_mean", b->global.lost_mean);
    cJSON_AddNumberToObject(o, "lost_max", b->global.lost_max);
    add_triple(o, "row_sum_min", b->global.row_sum_min);
    add_triple(o, "row_sum_max", b->global.row_sum_max);
    o = cJSON_AddObjectToObject(parent, "blend");
    cJSON_AddNumberToObject(o, "fitted", b->blend.fitted);
    cJSON_AddNumberToObject(o, "fallback", b->blend.fallback);
    cJSON_AddNumberToObject(o, "energy_error_max", b->blend.energy_error_max);
}

static void add_stages(cJSON *parent, const parian_body_report *b)
{
    cJSON *o = cJSON_AddObjectToObject(parent, "seconds");
    for (size_t i = 0; i < b->stage_count; i++) {
        cJSON_AddNumberToObject(o, b->stage[i].name, b->stage[i].seconds);
    }
}

static cJSON *body_json(const parian_body_report *b)
{
    cJSON *o = cJSON_CreateObject();
    cJSON_AddStringToObject(o, "name", b->name);
    cJSON *medium = cJSON_AddObjectToObject(o, "medium");
    cJSON_AddStringToObject(medium, "name", b->medium.name);
    cJSON_AddStringToObject(medium, "source", b->medium.source);
    add_triple(medium, "sigma_s_prime_per_m", b->medium.sigma_s_prime);
    add_triple(medium, "sigma_a_per_m", b->medium.sigma_a);
    add_triple(medium, "g", b->medium.g);
    cJSON_AddNumberToObject(medium, "eta", b->medium.eta);
    add_surface(o, &b->surface);
    add_transfer_mesh(o, &b->transfer_mesh);
    add_atlas(o, b);
    add_plan(o, &b->plan);
    add_thickness(o, &b->thickness);
    add_transport(o, b);
    add_stages(o, b);
    return o;
}

static cJSON *report_json(const parian_bake_report *report, const char *config)
{
    cJSON *root = cJSON_CreateObject();
    if (config) {
        cJSON_AddItemToObject(root, "provenance", cJSON_Parse(config));
    }
    cJSON_AddNumberToObject(root, "import_seconds", report->import_seconds);
    cJSON_AddNumberToObject(root, "write_seconds", report->write_seconds);
    cJSON_AddNumberToObject(root, "total_seconds", report->total_seconds);
    cJSON_AddNumberToObject(root, "peak_memory_bytes", (double)parian_peak_memory());
    cJSON_AddNumberToObject(root, "file_size", (double)report->file_size);
    cJSON_AddNumberToObject(root, "surroundings", report->surrounding_count);
    cJSON *bodies = cJSON_AddArrayToObject(root, "bodies");
    for (uint32_t i = 0; i < report->body_count; i++) {
        cJSON_AddItemToArray(bodies, body_json(&report->bodies[i]));
    }
    return root;
}

parian_result parian_report_write(const parian_env *env, const char *path,
                                  const parian_bake_report *report, const char *config)
{
    cJSON *root = report_json(report, config);
    char *text = cJSON_Print(root);
    cJSON_Delete(root);
    if (!text) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the report");
    }
    parian_result r = parian_file_write(env, path, text, strlen(text));
    cJSON_free(text);
    return r;
}
