/* reference_output.c - writes what a reference has computed: arrays of the receivers and a summary.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/reference_output.h"

#include <math.h>

#include "bake/reference/reference_files.h"
#include "core/memory.h"

static const char UNSCATTERED[] = "receiver_radiosity_unscattered.npy";

const char *parian_reference_model_name(parian_reference_model model)
{
    static const char *const name[] = {"dipole", "dipole-flux", "directional", "pbd", "path"};
    return (unsigned)model < sizeof name / sizeof *name ? name[model] : "unknown";
}

/* ---- arrays ------------------------------------------------------------------------------------
 */
static parian_result write_receivers(reference_files *files, const parian_receivers *receivers,
                                     const parian_reference_result *result)
{
    const uint64_t shape[2] = {receivers->count, 3};
    const struct {
        const char *name;
        parian_element element;
        uint32_t rank;
        const void *data;
    } arrays[] = {{"receiver_position.npy", PARIAN_ELEMENT_F64, 2, receivers->position},
                  {"receiver_normal.npy", PARIAN_ELEMENT_F64, 2, receivers->smooth_normal},
                  {"receiver_area.npy", PARIAN_ELEMENT_F64, 1, receivers->area},
                  {"receiver_body.npy", PARIAN_ELEMENT_U32, 1, receivers->body},
                  {"receiver_irradiance.npy", PARIAN_ELEMENT_F64, 2, result->irradiance},
                  {"receiver_radiosity.npy", PARIAN_ELEMENT_F64, 2, result->radiosity},
                  {"receiver_standard_error.npy", PARIAN_ELEMENT_F64, 2, result->standard_error},
                  {UNSCATTERED, PARIAN_ELEMENT_F64, 2, result->unscattered}};
    parian_result r = PARIAN_OK;
    for (size_t i = 0; r == PARIAN_OK && i < sizeof arrays / sizeof *arrays; i++) {
        if (arrays[i].data) {
            r = reference_files_npy(files, arrays[i].name, arrays[i].element, arrays[i].rank, shape,
                                    arrays[i].data);
        }
    }
    return r;
}

/* ---- summary -----------------------------------------------------------------------------------
 */
static void add_bodies(cJSON *root, const parian_reference_scene *scene,
                       const parian_reference_about *about)
{
    cJSON *bodies = cJSON_AddArrayToObject(root, "bodies");
    for (uint32_t b = 0; b < scene->body_count; b++) {
        const parian_reference_body *body = &scene->bodies[b];
        cJSON *o = cJSON_CreateObject();
        cJSON_AddStringToObject(o, "name", body->name);
        reference_add_medium(o, NULL, &body->medium);
        cJSON_AddNumberToObject(o, "triangles", body->mesh.triangle_count);
        cJSON_AddNumberToObject(o, "area_m2", parian_mesh_area(&body->mesh));
        cJSON_AddBoolToObject(o, "closed", body->closed);
        cJSON_AddBoolToObject(o, "field", body->field != NULL);
        if (about->scale) {
            reference_add_triple(o, "normalisation", about->scale[b]);
        }
        cJSON_AddItemToArray(bodies, o);
    }
}

/* Means over the receivers, weighed by area. */
static void add_means(cJSON *root, const parian_receivers *receivers,
                      const parian_reference_result *result)
{
    double area = 0, mean[3] = {0}, square[3] = {0}, light[3] = {0}, error[3], relative[3];
    for (size_t i = 0; i < receivers->count; i++) {
        double a = receivers->area[i];
        area += a;
        for (int c = 0; c < 3; c++) {
            mean[c] += a * result->radiosity[i][c];
            light[c] += a * result->irradiance[i][c];
            square[c] += a * result->standard_error[i][c] * result->standard_error[i][c];
        }
    }
    for (int c = 0; c < 3; c++) {
        mean[c] /= area;
        light[c] /= area;
        error[c] = sqrt(square[c] / area);
        relative[c] = error[c] / mean[c];
    }
    reference_add_triple(root, "mean_irradiance_W_m2", light);
    reference_add_triple(root, "mean_radiosity_W_m2", mean);
    reference_add_triple(root, "rms_standard_error_W_m2", error);
    reference_add_triple(root, "relative_standard_error", relative);
}

/* Books of paths; of a quadrature the integrals of E and, where receivers stand for the surface, of
 * B. */
static void add_energy(cJSON *root, const parian_reference_result *result,
                       const parian_reference_about *about)
{
    static const double unknown[3] = {NAN, NAN, NAN};
    bool path = about->model == PARIAN_REFERENCE_PATH, known = path || about->spread;
    cJSON *o = cJSON_AddObjectToObject(root, "energy_W");
    reference_add_triple(o, "in", result->in);
    reference_add_triple(o, "out", known ? result->out : unknown);
    reference_add_triple(o, "absorbed", known ? result->absorbed : unknown);
    if (path) {
        reference_add_triple(o, "roulette_added", result->roulette_added);
        reference_add_triple(o, "roulette_removed", result->roulette_removed);
        reference_add_triple(o, "lost", result->lost);
    }
}

static cJSON *make_summary(const parian_reference_scene *scene, const parian_receivers *receivers,
                           const parian_reference_result *result,
                           const parian_reference_about *about)
{
    cJSON *root = cJSON_CreateObject();
    bool path = about->model == PARIAN_REFERENCE_PATH;
    if (!root) {
        return NULL;
    }
    cJSON_AddStringToObject(root, "tool", "parian-bake " PARIAN_VERSION);
    cJSON_AddStringToObject(root, "model", parian_reference_model_name(about->model));
    if (!path) {
        cJSON_AddStringToObject(root, "fdr", about->fit_fdr ? "fit" : "exact");
    }
    add_bodies(root, scene, about);
    cJSON_AddNumberToObject(root, "surroundings", scene->surrounding_count);
    cJSON_AddNumberToObject(root, "lights", scene->light_count);
    cJSON_AddNumberToObject(root, "receivers", (double)receivers->count);
    cJSON_AddNumberToObject(root, "samples", (double)result->samples);
    cJSON_AddNumberToObject(root, "seed", (double)about->seed);
    add_energy(root, result, about);
    add_means(root, receivers, result);
    if (path) {
        cJSON_AddNumberToObject(root, "scattering_events", (double)result->scattering_events);
    }
    cJSON_AddNumberToObject(root, "seconds", result->seconds);
    return root;
}

parian_result parian_reference_write(const parian_env *env, const char *folder,
                                     const parian_reference_scene *scene,
                                     const parian_receivers *receivers,
                                     const parian_reference_result *result,
                                     const parian_reference_about *about)
{
    reference_files files = {.env = env, .folder = folder};
    parian_result r = write_receivers(&files, receivers, result);
    if (r == PARIAN_OK) {
        r = reference_files_json(&files, "summary.json",
                                 make_summary(scene, receivers, result, about));
    }
    if (r != PARIAN_OK) {
        reference_files_remove(&files);
    } else if (!result->unscattered) {
        reference_files_forget(&files, UNSCATTERED); /* that of an earlier run is not of this one */
    }
    return r;
}
