/* transfer_mesh.c - the transfer-mesh stage: shares the vertices out, makes every part, reports.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/transfer_mesh.h"

#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

enum { DEFAULT_TARGET = 10000, SAMPLE_COUNT = 20000, PART_SAMPLES_MIN = 64 };
enum { PART_TARGET_MIN = 4, PART_TARGET_GOOD = 24 };
static const double count_tolerance = 0.05;
static const double sliver_area = 1e-6; /* of the mean */
static const char progress_name[] = "transfer mesh";

/* Share the target by area; small parts get a floor, which the others pay for. */
static void share_target(transfer_part *parts, uint32_t count, uint32_t target)
{
    double floor_share = fmin(PART_TARGET_GOOD, fmax(PART_TARGET_MIN, target / (4.0 * count)));
    double area = 0.0, rest = target;
    for (uint32_t p = 0; p < count; p++) {
        area += parts[p].area;
    }
    for (bool changed = true; changed && area > 0.0;) {
        changed = false;
        for (uint32_t p = 0; p < count; p++) {
            if (!parts[p].target && parts[p].area * rest < floor_share * area) {
                parts[p].target = (uint32_t)floor_share;
                area -= parts[p].area;
                rest = fmax(rest - floor_share, 0.0);
                changed = true;
            }
        }
    }
    for (uint32_t p = 0; p < count; p++) {
        if (!parts[p].target) {
            double share = area > 0.0 ? rest * parts[p].area / area : 0.0;
            parts[p].target = (uint32_t)fmax(PART_TARGET_MIN, floor(share + 0.5));
        }
    }
}

typedef struct stage_job {
    const parian_env *env;
    transfer_part *parts;
    uint32_t count;
    double area;
    parian_result *result; /* [count] */
} stage_job;

static void make_part(void *context, size_t index)
{
    stage_job *job = context;
    transfer_part *part = &job->parts[index];
    double samples = fmax(PART_SAMPLES_MIN, SAMPLE_COUNT * part->area / job->area);
    parian_closest *source = NULL;
    parian_result result = parian_closest_create(job->env, &part->source, &source);
    if (result == PARIAN_OK) {
        result = parian_transfer_remesh(job->env, source, part);
    }
    if (result == PARIAN_OK && job->count == 1) {
        parian_progress(job->env, progress_name, 0.8);
    }
    if (result == PARIAN_OK) {
        result = parian_transfer_measure(job->env, source, (uint32_t)samples, part);
    }
    parian_closest_destroy(source);
    job->result[index] = result;
}

/* Parts run side by side; what a part does in parallel runs inline then. */
static parian_result make_parts(const parian_env *env, transfer_part *parts, uint32_t count)
{
    stage_job job = {.env = env, .parts = parts, .count = count};
    parian_result result = PARIAN_OK;
    if (!PARIAN_NEW(env, job.result, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for %u parts", count);
    }
    for (uint32_t p = 0; p < count; p++) {
        job.area += parts[p].area;
    }
    if (count == 1) {
        make_part(&job, 0);
    } else {
        parian_par(env, count, make_part, &job);
    }
    for (uint32_t p = 0; p < count && result == PARIAN_OK; p++) {
        result = job.result[p];
    }
    parian_free(env, job.result);
    return result;
}

static void report_shape(const parian_mesh *mesh, parian_transfer_mesh_report *report)
{
    double edge_sum = 0.0, quality_sum = 0.0;
    report->edge_min_m = INFINITY;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const double *corner[3], *first = mesh->position[mesh->triangle[t][0]];
        double squares = 0.0, n[3];
        for (int k = 0; k < 3; k++) {
            corner[k] = mesh->position[mesh->triangle[t][k]];
        }
        for (int k = 0; k < 3; k++) {
            double edge[3];
            subtract(corner[(k + 1) % 3], corner[k], edge);
            double length = norm(edge);
            edge_sum += length;
            squares += length * length;
            report->edge_min_m = fmin(report->edge_min_m, length);
            report->edge_max_m = fmax(report->edge_max_m, length);
        }
        area_vector(first, corner[1], corner[2], n);
        quality_sum += squares > 0.0 ? 2.0 * sqrt(3.0) * norm(n) / squares : 0.0;
    }
    report->vertex_count = mesh->vertex_count;
    report->triangle_count = mesh->triangle_count;
    report->edge_mean_m = edge_sum / (3.0 * mesh->triangle_count);
    report->quality_mean = quality_sum / mesh->triangle_count;
}

/* Distances of the parts, each weighted by its area. */
static void report_distance(const transfer_part *parts, uint32_t count, double area,
                            parian_transfer_mesh_report *report)
{
    double squares = 0.0;
    for (uint32_t p = 0; p < count; p++) {
        squares += parts[p].area / area * parts[p].squared_sum / parts[p].sample_count;
        report->distance_max_m = fmax(report->distance_max_m, parts[p].distance_max);
    }
    report->distance_rms_m = sqrt(squares);
}

static void warn_about_count(const parian_env *env, uint32_t target, uint32_t part_count,
                             const parian_transfer_mesh_report *report)
{
    if (fabs((double)report->vertex_count - target) > count_tolerance * target) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "transfer mesh: %u vertices instead of %u: what the %u part%s of the surface "
                   "allow%s",
                   report->vertex_count, target, part_count, part_count == 1 ? "" : "s",
                   part_count == 1 ? "s" : "");
    }
}

/* Sources with parts far thinner than an edge can leave triangles that no move opens. */
static void warn_about_slivers(const parian_env *env, const parian_mesh *mesh, double area)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangle[t];
        double n[3];
        area_vector(mesh->position[c[0]], mesh->position[c[1]], mesh->position[c[2]], n);
        count += 0.5 * norm(n) * mesh->triangle_count < sliver_area * area;
    }
    if (count) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "transfer mesh: %u triangles have less than a millionth of the mean area",
                   count);
    }
}

static parian_result check_source(const parian_env *env, const parian_mesh *source, double *area)
{
    *area = parian_mesh_area(source);
    if (source->triangle_count && *area > 0.0 && isfinite(*area)) {
        return PARIAN_OK;
    }
    return parian_fail(env, PARIAN_E_COMPUTE,
                       "transfer mesh: %u triangles of %g m^2 found, a surface expected",
                       source->triangle_count, *area);
}

parian_result parian_stage_transfer_mesh(const parian_env *env, const parian_mesh *source,
                                         const parian_transfer_mesh_desc *desc,
                                         parian_mesh *transfer, parian_transfer_mesh_report *report)
{
    uint32_t target = desc && desc->vertex_target ? desc->vertex_target : DEFAULT_TARGET;
    transfer_part *parts = NULL;
    uint32_t count = 0;
    double area;
    parian_mesh made = {0};
    parian_transfer_mesh_report summary = {0};
    parian_result result = check_source(env, source, &area);
    parian_progress(env, progress_name, 0.0);
    if (result == PARIAN_OK) {
        result = parian_transfer_split(env, source, &parts, &count);
    }
    if (result == PARIAN_OK) {
        share_target(parts, count, target);
        result = make_parts(env, parts, count);
    }
    if (result == PARIAN_OK) {
        result = parian_transfer_join(env, parts, count, &made);
    }
    if (result == PARIAN_OK) {
        result = parian_transfer_order(env, &made);
    }
    if (result == PARIAN_OK) {
        report_shape(&made, &summary);
        report_distance(parts, count, area, &summary);
        summary.area_ratio = parian_mesh_area(&made) / area;
        summary.source_is_denser = source->vertex_count > made.vertex_count;
        warn_about_count(env, target, count, &summary);
        warn_about_slivers(env, &made, area);
        *transfer = made;
        *report = summary;
        parian_progress(env, progress_name, 1.0);
    } else {
        parian_mesh_free(env, &made);
    }
    parian_transfer_parts_free(env, parts, count);
    return result;
}
