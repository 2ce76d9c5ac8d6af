/* bake.c - runs the stages of a bake in order and writes the asset.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/pipeline/bake.h"
#include "bake/pipeline/named_env.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "core/body_file.h"
#include "core/memory.h"
#include "parian/format.h"
#include "tool/files.h"
#include "tool/lights_file.h"
#include "tool/session.h"

enum { PATH_MAX_LENGTH = 4096 };

typedef struct bake_state {
    const parian_bake_desc *desc;
    parian_source_scene source;
    parian_selection selection;
    parian_scene_data scene;
    parian_bake_report report;
    double area; /* of all bodies, m^2 */
} bake_state;

static void state_free(const parian_env *env, bake_state *state)
{
    parian_scene_data_free(env, &state->scene);
    parian_selection_free(env, &state->selection);
    parian_source_scene_free(env, &state->source);
    parian_free(env, state->report.bodies);
}

static parian_result import_scene(const parian_env *env, bake_state *state)
{
    double start = parian_seconds();
    parian_progress(env, "import", 0);
    parian_result r = parian_import(env, state->desc->input, &state->source);
    if (r == PARIAN_OK) {
        r = parian_select_bodies(env, state->desc, &state->source, &state->selection);
    }
    if (r == PARIAN_OK) {
        r = parian_scale_scene(env, state->desc, &state->selection, &state->source);
    }
    state->report.import_seconds = parian_seconds() - start;
    return r;
}

static parian_result allocate_objects(const parian_env *env, bake_state *state)
{
    uint32_t bodies = state->selection.body_count;
    uint32_t rest = state->source.part_count - bodies;
    if (!PARIAN_NEW0(env, state->scene.bodies, bodies) ||
        !PARIAN_NEW0(env, state->scene.surroundings, rest) ||
        !PARIAN_NEW0(env, state->report.bodies, bodies)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u bodies", bodies);
    }
    return PARIAN_OK;
}

static double bodies_area(const bake_state *state)
{
    double area = 0;
    for (uint32_t p = 0; p < state->source.part_count; p++) {
        area += state->selection.is_body[p] ? parian_mesh_area(&state->source.parts[p].mesh) : 0;
    }
    return area;
}

/* This part's settings: those of the desc, or its share of them. */
static parian_bake_desc part_desc(const bake_state *state, uint32_t part)
{
    parian_bake_desc desc = *state->desc;
    double share = parian_mesh_area(&state->source.parts[part].mesh) / state->area;
    parian_share_budget(state->desc, state->selection.body_count, share, &desc.transfer_vertices,
                        &desc.atlas_size);
    return desc;
}

static parian_result bake_part(const parian_env *env, bake_state *state, uint32_t part)
{
    parian_scene_data *scene = &state->scene;
    uint32_t b = scene->body_count;
    parian_body_report *report = &state->report.bodies[b];
    parian_bake_desc desc = part_desc(state, part);
    parian_named_env named;
    parian_named_env_init(&named, env, desc.input, state->source.parts[part].name,
                          state->source.part_count > 1);
    parian_result r = parian_bake_body(&named.env, &desc, &state->source, part,
                                       &state->selection.medium[part], &scene->bodies[b], report);
    if (r == PARIAN_OK) {
        scene->body_count++;
        state->report.body_count++;
    }
    return r;
}

static parian_result bake_parts(const parian_env *env, bake_state *state)
{
    parian_result r = allocate_objects(env, state);
    state->area = bodies_area(state);
    for (uint32_t p = 0; r == PARIAN_OK && p < state->source.part_count; p++) {
        if (parian_cancelled(env)) {
            return PARIAN_E_INTERRUPTED;
        }
        if (state->selection.is_body[p]) {
            r = bake_part(env, state, p);
        } else {
            parian_scene_data *scene = &state->scene;
            r = parian_make_surrounding(env, &state->source, p,
                                        &scene->surroundings[scene->surrounding_count]);
            scene->surrounding_count += r == PARIAN_OK;
        }
    }
    state->report.surrounding_count = state->scene.surrounding_count;
    return r;
}

static parian_result describe_scene(const parian_env *env, bake_state *state)
{
    parian_result r = parian_make_provenance(env, state->desc, &state->scene.provenance_json);
    if (r == PARIAN_OK && state->source.light_count > 0) {
        r = parian_lights_to_json(env, state->source.lights, state->source.light_count,
                                  &state->scene.lights_json);
    }
    return r;
}

static parian_result write_asset(const parian_env *env, bake_state *state)
{
    double start = parian_seconds();
    parian_writer_desc desc = {.path = state->desc->output};
    parian_writer *writer = NULL;
    char temporary[PATH_MAX_LENGTH]; /* outlives the writer */
    parian_progress(env, "write", 0);
    parian_result r = parian_folder_create_parent(env, state->desc->output);
    if (r == PARIAN_OK) {
        r = parian_writer_begin(env, &desc, &writer);
    }
    if (r != PARIAN_OK) {
        return r;
    }
    snprintf(temporary, sizeof temporary, "%s", parian_writer_temporary(writer));
    parian_temp_register(temporary);
    r = parian_scene_data_write(writer, &state->scene);
    if (r == PARIAN_OK && parian_cancelled(env)) {
        r = PARIAN_E_INTERRUPTED;
    }
    if (r != PARIAN_OK) {
        parian_writer_abort(writer);
    } else {
        r = parian_writer_finish(writer);
    }
    parian_temp_unregister(temporary);
    struct stat info;
    if (r == PARIAN_OK && stat(state->desc->output, &info) == 0) {
        state->report.file_size = (uint64_t)info.st_size;
    }
    state->report.write_seconds = parian_seconds() - start;
    return r;
}

static parian_result write_outputs(const parian_env *env, bake_state *state)
{
    const parian_bake_desc *desc = state->desc;
    parian_result r = PARIAN_OK;
    if (desc->output) {
        r = write_asset(env, state);
    }
    if (r == PARIAN_OK && desc->dump_folder) {
        r = parian_bake_dump(env, desc->dump_folder, &state->scene);
    }
    if (r == PARIAN_OK && desc->depfile_path) {
        r = parian_write_depfile(env, desc);
    }
    return r;
}

parian_result parian_bake_run(const parian_env *env, const parian_bake_desc *desc)
{
    bake_state state = {.desc = desc};
    double start = parian_seconds();
    parian_result r = parian_check_outputs(env, desc);
    if (r == PARIAN_OK) {
        r = import_scene(env, &state);
    }
    if (r == PARIAN_OK) {
        r = bake_parts(env, &state);
    }
    if (r == PARIAN_OK) {
        r = describe_scene(env, &state);
    }
    if (r == PARIAN_OK) {
        r = write_outputs(env, &state);
    }
    state.report.total_seconds = parian_seconds() - start;
    if (r == PARIAN_OK) {
        parian_report_log(env, &state.report);
        if (desc->report_path) {
            r = parian_report_write(env, desc->report_path, &state.report,
                                    state.scene.provenance_json);
        }
    }
    state_free(env, &state);
    return r;
}
