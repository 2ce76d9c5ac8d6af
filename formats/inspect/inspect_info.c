/* inspect_info.c - parian-info info: what an asset holds, for people or as JSON.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/body_file.h"
#include "core/memory.h"
#include "inspect/inspect.h"

enum { INDENT = 18, COLUMNS = 80 };

/* ---- text ---------------------------------------------------------------------------------------
 */

/* Print words in lines of 80 columns behind a label. */
static void print_wrapped(const char *label, const char *text)
{
    int column = printf("  %-*s", INDENT - 2, label);
    for (const char *word = text; *word;) {
        int length = (int)strcspn(word, " \n");
        if (column > INDENT && column + 1 + length > COLUMNS) {
            column = printf("\n%*s", INDENT, "") - 1;
        }
        column += printf("%s%.*s", column > INDENT ? " " : "", length, word);
        word += length;
        word += strspn(word, " \n");
    }
    putchar('\n');
}

static void print_channels(const char *label, const double value[3], double factor)
{
    printf("  %-24s %12.4g %12.4g %12.4g\n", label, value[0] * factor, value[1] * factor,
           value[2] * factor);
}

/* A length in mm, and as multiples of the mean free path. */
static void print_length(const char *label, double length_m, const double mean_free_path_m[3])
{
    printf("  %-*s%.4g mm: %.3g, %.3g, %.3g mean free paths\n", INDENT - 2, label, length_m * 1e3,
           length_m / mean_free_path_m[0], length_m / mean_free_path_m[1],
           length_m / mean_free_path_m[2]);
}

static void print_medium(const parian_medium *medium, const body_summary *summary)
{
    char line[PARIAN_NAME_MAX + PARIAN_SOURCE_MAX + 64];
    snprintf(line, sizeof line, "%s, eta %.4g%s%s%s", medium->name[0] ? medium->name : "unnamed",
             medium->eta, medium->reduced_only ? ", reduced coefficients" : "",
             medium->source[0] ? "; " : "", medium->source);
    print_wrapped("medium", line);
    printf("  %-24s %12s %12s %12s\n", "", "red", "green", "blue");
    print_channels("sigma_s' (1/mm)", medium->sigma_s_prime, 1e-3);
    print_channels("sigma_a (1/mm)", medium->sigma_a, 1e-3);
    if (!medium->reduced_only) {
        print_channels("g", medium->g, 1);
    }
    print_channels("mean free path (mm)", summary->mean_free_path_m, 1e3);
    print_channels("diffusion length (mm)", summary->diffusion_length_m, 1e3);
}

/* The reason out of the plan, or the plan as it is. */
static void print_plan(const char *plan_json)
{
    cJSON *plan = plan_json ? cJSON_Parse(plan_json) : NULL;
    const char *reason = cJSON_GetStringValue(cJSON_GetObjectItem(plan, "reason"));
    if (plan_json) {
        print_wrapped("plan", reason ? reason : plan_json);
    }
    cJSON_Delete(plan);
}

static void print_atlas(const parian_body *body)
{
    char line[200];
    double area = (double)body->atlas_size * body->atlas_size;
    snprintf(line, sizeof line,
             "%u x %u, %s chart%s; %s texels own surface (%.1f %%), %s of them border; %s gutter",
             body->atlas_size, body->atlas_size, inspect_count(body->chart_count),
             body->chart_count == 1 ? "" : "s", inspect_count(body->texel_count),
             100 * body->texel_count / area, inspect_count(body->border_count),
             inspect_count(body->gutter_count));
    print_wrapped("atlas", line);
}

static void print_transport(const parian_body *body, const body_summary *summary)
{
    char line[200];
    snprintf(line, sizeof line, "%s, F_dr %s%s",
             body->bssrdf == PARIAN_BSSRDF_DIPOLE ? "dipole" : "dipole-flux",
             body->fit_fdr ? "by the printed fit" : "exact",
             body->paper_form ? ", the paper's own form" : "");
    print_wrapped("model", line);
    snprintf(line, sizeof line, "%s", inspect_local_form_texts[body->local_form]);
    if (body->local_form != PARIAN_LOCAL_NONE) {
        snprintf(line, sizeof line, "%s, %u x %u texels",
                 inspect_local_form_texts[body->local_form], body->kernel_width,
                 body->kernel_width);
    }
    print_wrapped("local part", line);
    if (body->has_global) {
        snprintf(line, sizeof line, "%u operator%s, %s factors in %s runs (%.2f %% of all pairs)",
                 body->operator_count, body->operator_count == 1 ? "" : "s",
                 inspect_count(summary->factor_count), inspect_count(summary->run_count),
                 100 * summary->kept_share);
    }
    print_wrapped("global part", body->has_global ? line : "none");
}

static void print_body(const parian_body *body, uint32_t index)
{
    char line[200];
    body_summary s;
    inspect_summarise(body, &s);
    printf("\nbody %u  %s\n", index, body->name);
    print_medium(&body->medium, &s);
    snprintf(line, sizeof line, "%s vertices, %s triangles, %.4g cm2; %.4g x %.4g x %.4g mm",
             inspect_count(body->vertex_count), inspect_count(body->triangle_count),
             s.area_m2 * 1e4, s.extent_m[0] * 1e3, s.extent_m[1] * 1e3, s.extent_m[2] * 1e3);
    print_wrapped("surface", line);
    print_length("extent", inspect_longest(s.extent_m), s.mean_free_path_m);
    print_length("vertex edge", s.vertex_edge_m, s.mean_free_path_m);
    print_length("texel edge", s.texel_edge_m, s.mean_free_path_m);
    print_atlas(body);
    print_transport(body, &s);
    print_plan(body->plan_json);
    if (body->texel_albedo || body->texel_normal_map) {
        print_wrapped("detail", !body->texel_albedo       ? "normal map"
                                : !body->texel_normal_map ? "surface colour"
                                                          : "surface colour, normal map");
    }
    print_wrapped("GPU memory", inspect_bytes(s.gpu_bytes));
}

static void print_parts(const parian_reader *reader)
{
    part_sizes parts;
    double total = (double)parian_reader_file_size(reader);
    inspect_part_sizes(reader, &parts);
    printf("\n%-26s %12s %8s %12s\n", "part", "in the file", "share", "decoded");
    for (size_t i = 0; i < parts.count; i++) {
        if (parts.stored[i] > 0) {
            printf("%-26s %12s %6.1f %% %12s\n", parts.name[i], inspect_bytes(parts.stored[i]),
                   100 * (double)parts.stored[i] / total, inspect_bytes(parts.decoded[i]));
        }
    }
}

/* "key value, key value": what an object of plain values holds. */
static void print_settings(const cJSON *settings)
{
    char line[2048] = "";
    size_t used = 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, settings)
    {
        char *value = cJSON_PrintUnformatted(item);
        if (value && used < sizeof line) {
            used += (size_t)snprintf(line + used, sizeof line - used, "%s%s %s", used ? ", " : "",
                                     item->string, value);
        }
        cJSON_free(value);
    }
    if (used) {
        print_wrapped("settings", line);
    }
}

static void print_provenance(const char *provenance_json)
{
    cJSON *root = provenance_json ? cJSON_Parse(provenance_json) : NULL;
    const char *tool = cJSON_GetStringValue(cJSON_GetObjectItem(root, "tool"));
    const char *input = cJSON_GetStringValue(cJSON_GetObjectItem(root, "input_xxh3_64"));
    if (tool) {
        char line[200];
        snprintf(line, sizeof line, "%.80s%s%.80s", tool, input ? ", input " : "",
                 input ? input : "");
        print_wrapped("made by", line);
        print_settings(cJSON_GetObjectItem(root, "settings"));
    } else if (provenance_json) {
        print_wrapped("provenance", provenance_json);
    }
    cJSON_Delete(root);
}

static void print_scene(const char *path, const parian_reader *reader,
                        const parian_scene_data *scene)
{
    printf("%s\n", path);
    printf("  %-*s%s (%s bytes), format %d.%u, %u chunks\n", INDENT - 2, "file",
           inspect_bytes(parian_reader_file_size(reader)),
           inspect_count(parian_reader_file_size(reader)), PARIAN_FORMAT_VERSION,
           parian_reader_version_minor(reader), parian_reader_chunk_count(reader));
    printf("  %-*s%u bod%s, %u surrounding%s, %s default lights\n", INDENT - 2, "scene",
           scene->body_count, scene->body_count == 1 ? "y" : "ies", scene->surrounding_count,
           scene->surrounding_count == 1 ? "" : "s", scene->lights_json ? "with" : "without");
    print_provenance(scene->provenance_json);
    for (uint32_t i = 0; i < scene->body_count; i++) {
        print_body(&scene->bodies[i], i);
    }
    for (uint32_t i = 0; i < scene->surrounding_count; i++) {
        const parian_surrounding *s = &scene->surroundings[i];
        printf("\nsurrounding %u  %s: %s vertices, %s triangle%s, reflectance %.3g %.3g %.3g\n", i,
               s->name, inspect_count(s->vertex_count), inspect_count(s->triangle_count),
               s->triangle_count == 1 ? "" : "s", s->reflectance[0], s->reflectance[1],
               s->reflectance[2]);
    }
    print_parts(reader);
}

/* ---- JSON ---------------------------------------------------------------------------------------
 */

/* Add what a JSON text holds, or the text itself where it is no JSON. */
static void add_json_text(cJSON *object, const char *key, const char *text)
{
    cJSON *parsed = text ? cJSON_Parse(text) : NULL;
    if (parsed) {
        cJSON_AddItemToObject(object, key, parsed);
    } else if (text) {
        cJSON_AddStringToObject(object, key, text);
    } else {
        cJSON_AddNullToObject(object, key);
    }
}

static void add_numbers(cJSON *object, const char *key, const double *value, int count)
{
    cJSON_AddItemToObject(object, key, cJSON_CreateDoubleArray(value, count));
}

static void add_medium(cJSON *object, const parian_medium *medium, const body_summary *summary)
{
    cJSON *json = cJSON_AddObjectToObject(object, "medium");
    cJSON_AddStringToObject(json, "name", medium->name);
    cJSON_AddStringToObject(json, "source", medium->source);
    add_numbers(json, "sigma_s_prime_per_m", medium->sigma_s_prime, 3);
    add_numbers(json, "sigma_a_per_m", medium->sigma_a, 3);
    add_numbers(json, "g", medium->g, 3);
    cJSON_AddNumberToObject(json, "eta", medium->eta);
    cJSON_AddBoolToObject(json, "reduced_only", medium->reduced_only);
    add_numbers(json, "mean_free_path_m", summary->mean_free_path_m, 3);
    add_numbers(json, "diffusion_length_m", summary->diffusion_length_m, 3);
}

static void add_counts(cJSON *json, const parian_body *body)
{
    cJSON_AddNumberToObject(json, "vertex_count", body->vertex_count);
    cJSON_AddNumberToObject(json, "triangle_count", body->triangle_count);
    cJSON_AddNumberToObject(json, "atlas_size", body->atlas_size);
    cJSON_AddNumberToObject(json, "chart_count", body->chart_count);
    cJSON_AddNumberToObject(json, "texel_count", body->texel_count);
    cJSON_AddNumberToObject(json, "border_texel_count", body->border_count);
    cJSON_AddNumberToObject(json, "gutter_texel_count", body->gutter_count);
}

static cJSON *make_body(const parian_body *body)
{
    body_summary s;
    cJSON *json = cJSON_CreateObject();
    inspect_summarise(body, &s);
    cJSON_AddStringToObject(json, "name", body->name);
    add_medium(json, &body->medium, &s);
    add_counts(json, body);
    add_numbers(json, "extent_m", s.extent_m, 3);
    cJSON_AddNumberToObject(json, "area_m2", s.area_m2);
    cJSON_AddNumberToObject(json, "texel_edge_m", s.texel_edge_m);
    cJSON_AddNumberToObject(json, "vertex_edge_m", s.vertex_edge_m);
    cJSON_AddStringToObject(json, "bssrdf",
                            body->bssrdf == PARIAN_BSSRDF_DIPOLE ? "dipole" : "dipole-flux");
    cJSON_AddStringToObject(json, "fdr", body->fit_fdr ? "fit" : "exact");
    cJSON_AddStringToObject(json, "form", body->paper_form ? "paper" : "parian");
    cJSON_AddStringToObject(json, "local_form", inspect_local_form_names[body->local_form]);
    cJSON_AddNumberToObject(json, "kernel_width", body->kernel_width);
    cJSON_AddBoolToObject(json, "has_global", body->has_global);
    cJSON_AddNumberToObject(json, "operator_count", body->operator_count);
    cJSON_AddNumberToObject(json, "factor_count", (double)s.factor_count);
    cJSON_AddNumberToObject(json, "run_count", (double)s.run_count);
    cJSON_AddNumberToObject(json, "kept_share", s.kept_share);
    cJSON_AddBoolToObject(json, "has_albedo", body->texel_albedo != NULL);
    cJSON_AddBoolToObject(json, "has_normal_map", body->texel_normal_map != NULL);
    cJSON_AddNumberToObject(json, "gpu_bytes_estimate", (double)s.gpu_bytes);
    add_json_text(json, "plan", body->plan_json);
    return json;
}

static cJSON *make_parts(const parian_reader *reader)
{
    part_sizes parts;
    cJSON *list = cJSON_CreateArray();
    inspect_part_sizes(reader, &parts);
    for (size_t i = 0; i < parts.count; i++) {
        cJSON *part = cJSON_CreateObject();
        cJSON_AddStringToObject(part, "name", parts.name[i]);
        cJSON_AddNumberToObject(part, "stored_bytes", (double)parts.stored[i]);
        cJSON_AddNumberToObject(part, "decoded_bytes", (double)parts.decoded[i]);
        cJSON_AddNumberToObject(part, "share",
                                (double)parts.stored[i] / (double)parian_reader_file_size(reader));
        cJSON_AddItemToArray(list, part);
    }
    return list;
}

static cJSON *make_surrounding(const parian_surrounding *surrounding)
{
    double reflectance[3] = {surrounding->reflectance[0], surrounding->reflectance[1],
                             surrounding->reflectance[2]};
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "name", surrounding->name);
    cJSON_AddNumberToObject(json, "vertex_count", surrounding->vertex_count);
    cJSON_AddNumberToObject(json, "triangle_count", surrounding->triangle_count);
    add_numbers(json, "reflectance", reflectance, 3);
    return json;
}

static cJSON *make_scene(const char *path, const parian_reader *reader,
                         const parian_scene_data *scene)
{
    char version[16];
    cJSON *json = cJSON_CreateObject();
    snprintf(version, sizeof version, "%d.%u", PARIAN_FORMAT_VERSION,
             parian_reader_version_minor(reader));
    cJSON_AddStringToObject(json, "asset", path);
    cJSON_AddNumberToObject(json, "file_bytes", (double)parian_reader_file_size(reader));
    cJSON_AddStringToObject(json, "format", version);
    cJSON_AddNumberToObject(json, "chunk_count", parian_reader_chunk_count(reader));
    cJSON *bodies = cJSON_AddArrayToObject(json, "bodies");
    for (uint32_t i = 0; i < scene->body_count; i++) {
        cJSON_AddItemToArray(bodies, make_body(&scene->bodies[i]));
    }
    cJSON *surroundings = cJSON_AddArrayToObject(json, "surroundings");
    for (uint32_t i = 0; i < scene->surrounding_count; i++) {
        cJSON_AddItemToArray(surroundings, make_surrounding(&scene->surroundings[i]));
    }
    cJSON_AddItemToObject(json, "parts", make_parts(reader));
    add_json_text(json, "lights", scene->lights_json);
    add_json_text(json, "provenance", scene->provenance_json);
    return json;
}

parian_result inspect_info(const parian_env *env, const inspect_options *options, const char *path)
{
    parian_reader *reader;
    parian_scene_data scene;
    parian_result result = parian_reader_open(env, path, NULL, &reader);
    if (result != PARIAN_OK) {
        return result;
    }
    result = parian_scene_data_read(env, reader, &scene);
    if (result == PARIAN_OK) {
        if (options->json) {
            result = inspect_print_json(env, make_scene(path, reader, &scene));
        } else {
            print_scene(path, reader, &scene);
        }
        parian_scene_data_free(env, &scene);
    }
    parian_reader_close(reader);
    return result;
}
