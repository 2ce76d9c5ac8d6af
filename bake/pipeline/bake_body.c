/* bake_body.c - runs the stages for one body, in order.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "bake/pipeline/bake.h"
#include "bake/stages/detail.h"
#include "bake/stages/rounding.h"
#include "bake/stages/surface.h"
#include "bake/stages/texels.h"
#include "core/memory.h"
#include "tool/session.h"

/* Say so from this share of the surface on. */
static const double THIN_SHARE_MAX = 0.02;

typedef struct body_job {
    const parian_bake_desc *desc;
    parian_source_scene *scene;
    uint32_t part;
    parian_body *body;
    parian_body_report *report;
} body_job;

typedef parian_result (*body_step)(const parian_env *env, body_job *job);

static parian_result step_surface(const parian_env *env, body_job *job)
{
    return parian_stage_surface(env, &job->scene->parts[job->part].mesh, &job->report->surface);
}

/* The transfer surface as the body stores it: floats, with corner normals. */
static parian_result store_surface(const parian_env *env, parian_mesh *mesh, parian_body *body)
{
    parian_result r = parian_mesh_make_corner_normals(env, mesh, PARIAN_CREASE_DEG);
    if (r != PARIAN_OK) {
        return r;
    }
    if (!PARIAN_NEW(env, body->vertex_position, mesh->vertex_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u vertices", mesh->vertex_count);
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            body->vertex_position[v][k] = (float)mesh->position[v][k];
        }
    }
    body->vertex_count = mesh->vertex_count;
    body->triangle_count = mesh->triangle_count;
    body->triangle = mesh->triangle;
    body->corner_normal = mesh->corner_normal;
    mesh->triangle = NULL;
    mesh->corner_normal = NULL;
    return PARIAN_OK;
}

static parian_result step_transfer_mesh(const parian_env *env, body_job *job)
{
    parian_transfer_mesh_desc desc = {.vertex_target = job->desc->transfer_vertices};
    parian_mesh transfer = {0};
    parian_result r = parian_stage_transfer_mesh(env, &job->scene->parts[job->part].mesh, &desc,
                                                 &transfer, &job->report->transfer_mesh);
    if (r == PARIAN_OK) {
        r = store_surface(env, &transfer, job->body);
    }
    parian_mesh_free(env, &transfer);
    return r;
}

static parian_result step_atlas(const parian_env *env, body_job *job)
{
    parian_atlas_desc desc = {.atlas_size = job->desc->atlas_size};
    return parian_stage_atlas(env, &desc, job->body, &job->report->atlas);
}

static parian_result step_texels(const parian_env *env, body_job *job)
{
    parian_result r = parian_stage_texels(env, job->body);
    job->report->texel_count = job->body->texel_count;
    job->report->border_count = job->body->border_count;
    job->report->gutter_count = job->body->gutter_count;
    return r;
}

/* The plan as the asset carries it. */
static parian_result store_plan(const parian_env *env, const parian_plan *plan, parian_body *body)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddBoolToObject(root, "local", plan->local);
    cJSON_AddBoolToObject(root, "global", plan->global);
    cJSON_AddStringToObject(root, "reason", plan->reason);
    cJSON_AddNumberToObject(root, "error_without_local", plan->error_without_local);
    cJSON_AddNumberToObject(root, "error_without_global", plan->error_without_global);
    char *text = cJSON_PrintUnformatted(root);
    cJSON_Delete(root);
    size_t size = text ? strlen(text) + 1 : 0;
    body->plan_json = text ? parian_alloc(env, size, 1) : NULL;
    if (body->plan_json) {
        memcpy(body->plan_json, text, size);
    }
    cJSON_free(text);
    return body->plan_json ? PARIAN_OK : parian_fail(env, PARIAN_E_NOMEM, "no memory for the plan");
}

static parian_result step_plan(const parian_env *env, body_job *job)
{
    const parian_bake_desc *d = job->desc;
    parian_plan_desc desc = {.force_local = d->force_local,
                             .force_global = d->force_global,
                             .no_local = d->no_local,
                             .no_global = d->no_global,
                             .local_form = d->local_form,
                             .paper_form = d->form == PARIAN_FORM_PAPER};
    parian_result r = parian_stage_plan(env, &desc, job->body, &job->report->plan);
    if (r == PARIAN_OK) {
        parian_log(env, PARIAN_LOG_INFO, "plan: %s", job->report->plan.reason);
        r = store_plan(env, &job->report->plan, job->body);
    }
    return r;
}

/* Say where the dipole does not hold: no setting of the bake mends that. */
static parian_result step_thickness(const parian_env *env, body_job *job)
{
    parian_thickness_report *t = &job->report->thickness;
    parian_result r = parian_stage_thickness(env, job->body, t);
    if (r == PARIAN_OK && t->thin_share > THIN_SHARE_MAX) {
        parian_log(env, PARIAN_LOG_INFO,
                   "%.0f %% of the surface is thinner than %d mean free paths (%.3g mm in the "
                   "clearest channel): %s",
                   100 * t->thin_share, PARIAN_THIN_FLIGHTS, 1e3 * t->flight_m,
                   job->desc->bssrdf == PARIAN_BSSRDF_DIPOLE
                       ? "the dipole by distance errs there; --bssrdf dipole-flux errs less"
                       : "no diffuse BSSRDF holds well there");
    }
    return r;
}

static parian_result step_detail(const parian_env *env, body_job *job)
{
    const parian_source_scene *scene = job->scene;
    const parian_source_part *part = &scene->parts[job->part];
    parian_detail_desc desc = {.source = &part->mesh,
                               .materials = scene->materials,
                               .material_count = scene->material_count,
                               .material = part->material,
                               .pictures = scene->pictures,
                               .picture_count = scene->picture_count,
                               .normal_map = job->report->transfer_mesh.source_is_denser};
    parian_result r = parian_stage_detail(env, &desc, job->body);
    job->report->has_normal_map = job->body->texel_normal_map != NULL;
    job->report->has_albedo = job->body->texel_albedo != NULL;
    return r;
}

static parian_result step_rounding(const parian_env *env, body_job *job)
{
    return parian_stage_rounding(env, job->body);
}

static parian_result step_global(const parian_env *env, body_job *job)
{
    parian_global_desc desc = {.threshold = job->desc->threshold,
                               .threshold_absolute = job->desc->threshold_absolute,
                               .hierarchy = job->desc->hierarchy};
    parian_result r = parian_stage_global(env, &desc, job->body, &job->report->global);
    if (r == PARIAN_OK && job->body->has_global) {
        parian_log(env, PARIAN_LOG_INFO, "global: %s", job->report->global.hierarchy);
    }
    return r;
}

static parian_result step_blend(const parian_env *env, body_job *job)
{
    parian_result r = parian_blend_make(env, job->body, &job->report->blend);
    if (r == PARIAN_OK) {
        parian_round_blend(job->body);
    }
    return r;
}

static parian_result step_local(const parian_env *env, body_job *job)
{
    return parian_stage_local(env, job->body);
}

static const struct {
    const char *name;
    body_step run;
} STEPS[] = {{"surface", step_surface}, {"transfer mesh", step_transfer_mesh},
             {"atlas", step_atlas},     {"texels", step_texels},
             {"plan", step_plan},       {"thickness", step_thickness},
             {"detail", step_detail},   {"rounding", step_rounding},
             {"global", step_global},   {"blend", step_blend},
             {"local", step_local}};

static void init_body(const parian_bake_desc *desc, const parian_source_part *part,
                      const parian_medium *medium, parian_body *body)
{
    *body = (parian_body){0};
    memcpy(body->name, part->name, sizeof body->name);
    body->medium = *medium;
    body->bssrdf = desc->bssrdf;
    body->fit_fdr = desc->fit_fdr;
    body->paper_form = desc->form == PARIAN_FORM_PAPER;
    body->kernel_width = desc->kernel_width;
}

parian_result parian_bake_body(const parian_env *env, const parian_bake_desc *desc,
                               parian_source_scene *scene, uint32_t part,
                               const parian_medium *medium, parian_body *body,
                               parian_body_report *report)
{
    body_job job = {desc, scene, part, body, report};
    parian_result r = PARIAN_OK;
    init_body(desc, &scene->parts[part], medium, body);
    memcpy(report->name, body->name, sizeof report->name);
    report->medium = *medium;
    for (size_t i = 0; r == PARIAN_OK && i < sizeof STEPS / sizeof *STEPS; i++) {
        double start = parian_seconds();
        parian_progress(env, STEPS[i].name, 0);
        r = STEPS[i].run(env, &job);
        parian_report_stage(report, STEPS[i].name, parian_seconds() - start);
        if (r == PARIAN_OK && parian_cancelled(env)) {
            r = PARIAN_E_INTERRUPTED;
        }
    }
    if (r != PARIAN_OK) {
        parian_body_free(env, body);
    }
    return r;
}
