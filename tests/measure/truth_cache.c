/* truth_cache.c - names truths by what they depend on; carries them to and from files.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "parian/format.h"
#include "tests/measure/content_hash.h"
#include "tests/measure/truth.h"

/* Raised when a reference model changes what it means; a build alone does not cost the truths that
 * are kept. */
enum { TRUTH_VERSION = 1 };

/* ---- the name
 * -----------------------------------------------------------------------------------------------
 */
static void hash_mesh(parian_content_hash *hash, const parian_mesh *mesh)
{
    parian_content_hash_add(hash, mesh->position, mesh->vertex_count * sizeof *mesh->position);
    parian_content_hash_add(hash, mesh->triangle, mesh->triangle_count * sizeof *mesh->triangle);
    parian_content_hash_add(hash, mesh->corner_normal,
                            mesh->corner_normal ? mesh->triangle_count * sizeof *mesh->corner_normal
                                                : 0);
}

static void hash_medium(parian_content_hash *hash, const parian_medium *medium)
{
    parian_content_hash_add(hash, medium->sigma_s_prime, sizeof medium->sigma_s_prime);
    parian_content_hash_add(hash, medium->sigma_a, sizeof medium->sigma_a);
    parian_content_hash_add(hash, medium->g, sizeof medium->g);
    parian_content_hash_number(hash, medium->eta);
    parian_content_hash_count(hash, medium->reduced_only);
}

static void hash_field(parian_content_hash *hash, const parian_medium_field *field)
{
    parian_content_hash_count(hash, field != NULL);
    if (field) {
        size_t nodes = (size_t)field->size[0] * field->size[1] * field->size[2];
        parian_content_hash_add(hash, field->size, sizeof field->size);
        parian_content_hash_add(hash, field->lower, sizeof field->lower);
        parian_content_hash_add(hash, field->upper, sizeof field->upper);
        parian_content_hash_add(hash, field->sigma_s, nodes * sizeof *field->sigma_s);
        parian_content_hash_add(hash, field->sigma_a, nodes * sizeof *field->sigma_a);
    }
}

static void hash_light(parian_content_hash *hash, const parian_light *light)
{
    size_t pixels = light->image.pixel ? (size_t)light->image.width * light->image.height : 0;
    parian_content_hash_count(hash, (uint64_t)light->type);
    parian_content_hash_add(hash, light->position, sizeof light->position);
    parian_content_hash_add(hash, light->direction, sizeof light->direction);
    parian_content_hash_add(hash, light->up, sizeof light->up);
    parian_content_hash_add(hash, light->color, sizeof light->color);
    parian_content_hash_add(hash, light->axis_u, sizeof light->axis_u);
    parian_content_hash_add(hash, light->axis_v, sizeof light->axis_v);
    parian_content_hash_number(hash, light->inner_deg);
    parian_content_hash_number(hash, light->outer_deg);
    parian_content_hash_number(hash, light->rotation_deg);
    parian_content_hash_count(hash, pixels ? light->image.width : 0);
    parian_content_hash_add(hash, light->image.pixel, pixels * sizeof *light->image.pixel);
}

static void hash_scene(parian_content_hash *hash, const parian_reference_scene *scene)
{
    parian_content_hash_count(hash, scene->body_count);
    for (uint32_t b = 0; b < scene->body_count; b++) {
        hash_mesh(hash, &scene->bodies[b].mesh);
        hash_medium(hash, &scene->bodies[b].medium);
        hash_field(hash, scene->bodies[b].field);
    }
    parian_content_hash_count(hash, scene->surrounding_count);
    for (uint32_t s = 0; s < scene->surrounding_count; s++) {
        hash_mesh(hash, &scene->surroundings[s]);
    }
    parian_content_hash_count(hash, scene->light_count);
    for (uint32_t l = 0; l < scene->light_count; l++) {
        hash_light(hash, &scene->lights[l]);
    }
}

static void hash_receivers(parian_content_hash *hash, const parian_receivers *receivers)
{
    size_t n = receivers->count;
    parian_content_hash_add(hash, receivers->position, n * sizeof *receivers->position);
    parian_content_hash_add(hash, receivers->normal, n * sizeof *receivers->normal);
    parian_content_hash_add(hash, receivers->smooth_normal, n * sizeof *receivers->smooth_normal);
    parian_content_hash_add(hash, receivers->area, n * sizeof *receivers->area);
    parian_content_hash_add(hash, receivers->body, n * sizeof *receivers->body);
    parian_content_hash_add(hash, receivers->triangle, n * sizeof *receivers->triangle);
}

static void hash_desc(parian_content_hash *hash, const parian_truth_desc *desc)
{
    parian_content_hash_count(hash, TRUTH_VERSION);
    parian_content_hash_count(hash, (uint64_t)desc->model);
    parian_content_hash_count(hash, desc->fit_fdr);
    parian_content_hash_count(hash, desc->normalise);
    parian_content_hash_count(hash, desc->samples);
    parian_content_hash_number(hash, desc->standard_error);
    parian_content_hash_count(hash, desc->seed);
}

parian_result parian_truth_name(const parian_env *env, const parian_reference_scene *scene,
                                const parian_receivers *receivers, const parian_truth_desc *desc,
                                char name[PARIAN_TRUTH_NAME_MAX])
{
    char digits[PARIAN_HASH_TEXT_MAX];
    parian_content_hash *hash = NULL;
    parian_result r = parian_content_hash_begin(env, &hash);
    if (r == PARIAN_OK) {
        hash_desc(hash, desc);
        hash_scene(hash, scene);
        hash_receivers(hash, receivers);
        parian_content_hash_end(hash, digits);
        snprintf(name, PARIAN_TRUTH_NAME_MAX, "truth-%s", digits);
    }
    return r;
}

/* ---- the file: a container of arrays, whose every block is checked
 * ------------------------------------------- */
enum { NUMBER_COUNT = 21 };

static void pack_numbers(const parian_reference_result *result, double number[NUMBER_COUNT])
{
    const double *triple[] = {result->in,
                              result->out,
                              result->absorbed,
                              result->roulette_added,
                              result->roulette_removed,
                              result->lost};
    number[0] = (double)result->samples;
    number[1] = result->seconds;
    number[2] = (double)result->scattering_events;
    for (int k = 0; k < 18; k++) {
        number[3 + k] = triple[k / 3][k % 3];
    }
}

static void unpack_numbers(const double number[NUMBER_COUNT], parian_reference_result *result)
{
    double *triple[] = {result->in,
                        result->out,
                        result->absorbed,
                        result->roulette_added,
                        result->roulette_removed,
                        result->lost};
    result->samples = (uint64_t)number[0];
    result->seconds = number[1];
    result->scattering_events = (uint64_t)number[2];
    for (int k = 0; k < 18; k++) {
        triple[k / 3][k % 3] = number[3 + k];
    }
}

static parian_result write_array(parian_writer *writer, const char *name, size_t count,
                                 size_t width, const void *data)
{
    parian_chunk_info info = {
        .element = PARIAN_ELEMENT_F64, .codec = PARIAN_CODEC_SHUFFLE_ZSTD, .rank = 2};
    info.shape[0] = count;
    info.shape[1] = width;
    snprintf(info.name, sizeof info.name, "%s", name);
    return data ? parian_writer_chunk(writer, &info, data) : PARIAN_OK;
}

parian_result parian_truth_save(const parian_env *env, const char *path, size_t count,
                                const parian_reference_result *result)
{
    double number[NUMBER_COUNT];
    parian_writer_desc desc = {.path = path};
    parian_writer *writer = NULL;
    parian_result r = parian_writer_begin(env, &desc, &writer);
    if (r != PARIAN_OK) {
        return r;
    }
    pack_numbers(result, number);
    r = write_array(writer, "truth.numbers", 1, NUMBER_COUNT, number);
    r = r == PARIAN_OK ? write_array(writer, "truth.irradiance", count, 3, result->irradiance) : r;
    r = r == PARIAN_OK ? write_array(writer, "truth.radiosity", count, 3, result->radiosity) : r;
    r = r == PARIAN_OK
            ? write_array(writer, "truth.standard_error", count, 3, result->standard_error)
            : r;
    r = r == PARIAN_OK ? write_array(writer, "truth.unscattered", count, 3, result->unscattered)
                       : r;
    if (r != PARIAN_OK) {
        parian_writer_abort(writer);
        return r;
    }
    return parian_writer_finish(writer);
}

static bool read_array(const parian_reader *reader, const char *name, size_t count, size_t width,
                       void *data)
{
    int64_t index = parian_reader_find(reader, name, 0, 0);
    if (index < 0) {
        return false;
    }
    const parian_chunk_info *info = parian_reader_chunk(reader, (uint32_t)index);
    return info->element == PARIAN_ELEMENT_F64 && info->rank == 2 && info->shape[0] == count &&
           info->shape[1] == width &&
           parian_reader_read(reader, (uint32_t)index, data) == PARIAN_OK;
}

static bool read_arrays(const parian_reader *reader, size_t count, parian_reference_result *result)
{
    double number[NUMBER_COUNT];
    bool sound = read_array(reader, "truth.numbers", 1, NUMBER_COUNT, number) &&
                 read_array(reader, "truth.irradiance", count, 3, result->irradiance) &&
                 read_array(reader, "truth.radiosity", count, 3, result->radiosity) &&
                 read_array(reader, "truth.standard_error", count, 3, result->standard_error) &&
                 (!result->unscattered ||
                  read_array(reader, "truth.unscattered", count, 3, result->unscattered));
    if (sound) {
        unpack_numbers(number, result);
    }
    return sound;
}

bool parian_truth_load(const parian_env *env, const char *path, size_t count,
                       parian_reference_result *result)
{
    parian_env silent = env ? *env : (parian_env){0};
    parian_reader *reader = NULL;
    silent.log = NULL; /* a damaged file is no fault of the run */
    *result = (parian_reference_result){0};
    if (parian_reader_open(&silent, path, NULL, &reader) != PARIAN_OK) {
        return false;
    }
    bool unscattered = parian_reader_find(reader, "truth.unscattered", 0, 0) >= 0;
    bool sound = parian_reference_result_init(env, count, unscattered, result) == PARIAN_OK &&
                 read_arrays(reader, count, result);
    parian_reader_close(reader);
    if (!sound) {
        parian_reference_result_free(env, result);
    }
    return sound;
}
