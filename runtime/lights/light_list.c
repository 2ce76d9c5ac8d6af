/* light_list.c - checks lights and turns them into samples.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lights/light_list.h"

#include <string.h>

#include "core/memory.h"
#include "core/small_maths.h"
#include "lights/light_image.h"
#include "lights/sky_cells.h"
#include "vec3.h"

static const char *const light_type_names[] = {"point", "directional", "spot", "rect",
                                               "environment"};

static bool all_finite(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool has_length(const float v[3])
{
    return all_finite(v) && (v[0] != 0.0f || v[1] != 0.0f || v[2] != 0.0f);
}

static const char *find_image_fault(const parian_light_image *image)
{
    if (!image->pixel) {
        return NULL;
    }
    if (image->width < 1 || image->height < 1 || image->width > 16384 || image->height > 16384) {
        return "the image is not of 1 to 16384 pixels a side";
    }
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        for (int c = 0; c < 3; c++) {
            if (!(image->pixel[i][c] >= 0.0f) || !isfinite(image->pixel[i][c])) {
                return "the image has a negative or non-finite pixel";
            }
        }
    }
    return NULL;
}

/* What is wrong with a light, or NULL. */
static const char *find_fault(const parian_light *light)
{
    for (int c = 0; c < 3; c++) {
        if (!(light->color[c] >= 0.0f) || light->color[c] > 1e12f) {
            return "colour is not within 0 to 1e12";
        }
    }
    bool placed =
        light->type != PARIAN_LIGHT_DIRECTIONAL && light->type != PARIAN_LIGHT_ENVIRONMENT;
    if (placed && (!all_finite(light->position) || vec3_length(light->position) > 1e9f)) {
        return "position is not finite or farther than 1e9 m";
    }
    if ((light->type == PARIAN_LIGHT_DIRECTIONAL || light->type == PARIAN_LIGHT_SPOT) &&
        !has_length(light->direction)) {
        return "direction is not finite or has no length";
    }
    if (light->type == PARIAN_LIGHT_SPOT &&
        !(light->inner_deg >= 0.0f && light->inner_deg <= light->outer_deg &&
          light->outer_deg > 0.0f && light->outer_deg < 90.0f && all_finite(light->up))) {
        return "cone is not 0 <= inner <= outer < 90 degrees";
    }
    if (light->type == PARIAN_LIGHT_RECT) {
        float normal[3];
        vec3_cross(normal, light->axis_u, light->axis_v);
        if (!has_length(normal)) {
            return "the axes span no rectangle";
        }
    }
    if (light->type == PARIAN_LIGHT_ENVIRONMENT && !isfinite(light->rotation_deg)) {
        return "rotation is not finite";
    }
    bool pictured = light->type == PARIAN_LIGHT_SPOT || light->type == PARIAN_LIGHT_ENVIRONMENT;
    return pictured ? find_image_fault(&light->image) : NULL;
}

static parian_result check_lights(const parian_env *env, const parian_light *lights, size_t count)
{
    if (count > PARIAN_LIGHT_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT, "%zu lights given, at most %d are possible", count,
                           PARIAN_LIGHT_MAX);
    }
    for (size_t i = 0; i < count; i++) {
        if ((unsigned)lights[i].type > PARIAN_LIGHT_ENVIRONMENT) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "light %zu: unknown type %d", i,
                               (int)lights[i].type);
        }
        const char *fault = find_fault(&lights[i]);
        if (fault) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "light %zu (%s): %s", i,
                               light_type_names[lights[i].type], fault);
        }
    }
    return PARIAN_OK;
}

/* At most; environments with much black have fewer. */
static size_t sample_count_of(const parian_light *light, uint32_t sky_cells)
{
    switch (light->type) {
    case PARIAN_LIGHT_RECT:
        return PARIAN_RECT_GRID * PARIAN_RECT_GRID;
    case PARIAN_LIGHT_ENVIRONMENT:
        return sky_cells;
    default:
        return 1;
    }
}

static void make_simple(const parian_light *light, parian_light_sample *sample)
{
    static const parian_sample_kind kinds[] = {PARIAN_SAMPLE_POINT, PARIAN_SAMPLE_DIRECTIONAL,
                                               PARIAN_SAMPLE_SPOT};
    sample->kind = kinds[light->type];
    vec3_copy(sample->color, light->color);
    if (light->type != PARIAN_LIGHT_DIRECTIONAL) {
        vec3_copy(sample->position, light->position);
    }
    if (light->type != PARIAN_LIGHT_POINT) {
        vec3_copy(sample->direction, light->direction);
        vec3_normalize(sample->direction);
    }
    if (light->type == PARIAN_LIGHT_SPOT) {
        const float rad = (float)(M_PI / 180.0);
        sample->cos_inner = cosf(light->inner_deg * rad);
        sample->cos_outer = cosf(light->outer_deg * rad);
        sample->tan_outer = tanf(light->outer_deg * rad);
        const float zero[3] = {0.0f, 1.0f, 0.0f};
        float backward[3] = {-sample->direction[0], -sample->direction[1], -sample->direction[2]};
        vec3_frame(backward, has_length(light->up) ? light->up : zero, sample->right, sample->up);
    }
}

/* Gauss-Legendre nodes: the sum over patches is exact to a few per mille down to distances of a
 * side. */
static void make_rect(const parian_light *light, parian_light_sample *samples,
                      parian_rect_source *source)
{
    double node[PARIAN_RECT_GRID], weight[PARIAN_RECT_GRID];
    float normal[3];
    vec3_cross(normal, light->axis_u, light->axis_v);
    float area = 4.0f * vec3_length(normal);
    vec3_normalize(normal);
    vec3_copy(source->position, light->position);
    vec3_copy(source->axis_u, light->axis_u);
    vec3_copy(source->axis_v, light->axis_v);
    vec3_copy(source->power, light->color);
    vec3_scale(source->power, area);
    parian_gauss_legendre(PARIAN_RECT_GRID, node, weight);
    for (int i = 0; i < PARIAN_RECT_GRID * PARIAN_RECT_GRID; i++) {
        parian_light_sample *sample = &samples[i];
        int u = i % PARIAN_RECT_GRID, v = i / PARIAN_RECT_GRID;
        sample->kind = PARIAN_SAMPLE_PATCH;
        vec3_copy(sample->position, light->position);
        vec3_add_scaled(sample->position, light->axis_u, (float)(2.0 * node[u] - 1.0));
        vec3_add_scaled(sample->position, light->axis_v, (float)(2.0 * node[v] - 1.0));
        vec3_copy(sample->direction, normal);
        vec3_copy(sample->color, light->color);
        vec3_scale(sample->color, area * (float)(weight[u] * weight[v]));
    }
}

static void add_image(parian_light_list *list, const parian_light *light,
                      parian_light_sample *sample)
{
    if (light->type != PARIAN_LIGHT_SPOT || !light->image.pixel) {
        return;
    }
    const parian_light_image *image = &light->image;
    sample->image_offset = list->image_total;
    sample->image_width = image->width;
    sample->image_height = image->height;
    sample->image_levels = parian_image_level_count(image->width, image->height);
    parian_image_build_levels(image, list->image + list->image_total);
    list->image_total += (uint32_t)parian_image_pixel_total(image->width, image->height);
}

static parian_result make_samples(const parian_env *env, parian_light_list *list,
                                  const parian_light *lights, size_t count, uint32_t sky_cells)
{
    for (size_t i = 0; i < count; i++) {
        parian_light_sample *sample = list->sample + list->sample_count;
        uint32_t added = 1;
        if (lights[i].type == PARIAN_LIGHT_RECT) {
            parian_rect_source *source = &list->rect[list->rect_count++];
            source->first_sample = list->sample_count;
            make_rect(&lights[i], sample, source);
            added = PARIAN_RECT_GRID * PARIAN_RECT_GRID;
        } else if (lights[i].type == PARIAN_LIGHT_ENVIRONMENT) {
            parian_sky *sky = &list->sky[list->sky_count];
            parian_result result = parian_sky_build(env, &lights[i], sky_cells, sky);
            if (result != PARIAN_OK) {
                return result;
            }
            list->sky_count++;
            sky->first_sample = list->sample_count;
            parian_sky_samples(sky, sample, list->environment_sh);
            added = sky->cell_count;
        } else {
            make_simple(&lights[i], sample);
            add_image(list, &lights[i], sample);
        }
        list->sample_count += added;
    }
    return PARIAN_OK;
}

/* What lights need: samples, picture pixels, rectangles, environments. */
typedef struct light_needs {
    size_t samples, rects, skies;
    uint64_t pixels;
} light_needs;

static light_needs count_needs(const parian_light *lights, size_t count, uint32_t sky_cells)
{
    light_needs needs = {0};
    for (size_t i = 0; i < count; i++) {
        needs.samples += sample_count_of(&lights[i], sky_cells);
        needs.rects += lights[i].type == PARIAN_LIGHT_RECT;
        needs.skies += lights[i].type == PARIAN_LIGHT_ENVIRONMENT;
        if (lights[i].type == PARIAN_LIGHT_SPOT && lights[i].image.pixel) {
            needs.pixels += parian_image_pixel_total(lights[i].image.width, lights[i].image.height);
        }
    }
    return needs;
}

parian_result parian_light_list_build(const parian_env *env, const parian_light *lights,
                                      size_t count, uint32_t sky_cells, parian_light_list *list)
{
    parian_light_list made = {0};
    parian_result result = check_lights(env, lights, count);
    if (result != PARIAN_OK) {
        return result;
    }
    sky_cells = sky_cells ? sky_cells : PARIAN_SKY_CELLS;
    light_needs needs = count_needs(lights, count, sky_cells);
    if (needs.samples > PARIAN_LIGHT_MAX || needs.pixels > PARIAN_IMAGE_PIXEL_MAX) {
        return parian_fail(
            env, PARIAN_E_LIMIT,
            "lights need %zu samples and %llu picture pixels, at most %d and %d are possible",
            needs.samples, (unsigned long long)needs.pixels, PARIAN_LIGHT_MAX,
            PARIAN_IMAGE_PIXEL_MAX);
    }
    if (!PARIAN_NEW0(env, made.sample, needs.samples) ||
        !PARIAN_NEW0(env, made.rect, needs.rects) || !PARIAN_NEW0(env, made.sky, needs.skies) ||
        !PARIAN_NEW(env, made.image, (size_t)needs.pixels)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu light samples", needs.samples);
    } else {
        result = make_samples(env, &made, lights, count, sky_cells);
    }
    if (result != PARIAN_OK) {
        parian_light_list_free(env, &made);
        return result;
    }
    *list = made;
    return PARIAN_OK;
}

void parian_light_list_free(const parian_env *env, parian_light_list *list)
{
    if (list) {
        for (uint32_t s = 0; list->sky && s < list->sky_count; s++) {
            parian_sky_free(env, &list->sky[s]);
        }
        parian_free(env, list->sky);
        parian_free(env, list->rect);
        parian_free(env, list->sample);
        parian_free(env, list->image);
        parian_free(env, list->layer);
        memset(list, 0, sizeof *list);
    }
}

static bool sample_equal(const parian_light_sample *a, const parian_light_sample *b)
{
    parian_light_sample c = *b;
    c.layer_first = a->layer_first;
    c.layer_count = a->layer_count;
    return memcmp(a, &c, sizeof c) == 0;
}

bool parian_light_list_equal(const parian_light_list *a, const parian_light_list *b)
{
    bool equal = a->sample_count == b->sample_count && a->image_total == b->image_total &&
                 a->sky_count == b->sky_count &&
                 memcmp(a->environment_sh, b->environment_sh, sizeof a->environment_sh) == 0;
    for (uint32_t i = 0; equal && i < a->sample_count; i++) {
        equal = sample_equal(&a->sample[i], &b->sample[i]);
    }
    for (uint32_t k = 0; equal && k < a->sky_count; k++) {
        equal = parian_sky_equal(&a->sky[k], &b->sky[k]);
    }
    return equal &&
           (!a->image_total || memcmp(a->image, b->image, a->image_total * sizeof *a->image) == 0);
}

static void put(float to[4], const float v[3], float w)
{
    vec3_copy(to, v);
    to[3] = w;
}

void parian_light_sample_table(const parian_light_sample *sample, uint32_t count, float (*row)[4])
{
    memset(row, 0, (size_t)count * PARIAN_LIGHT_ROW * sizeof *row);
    for (uint32_t i = 0; i < count; i++, row += PARIAN_LIGHT_ROW) {
        const parian_light_sample *s = &sample[i];
        put(row[0], s->position, (float)s->kind);
        put(row[1], s->direction, s->cos_inner);
        put(row[2], s->color, s->cos_outer);
        put(row[3], s->right, s->tan_outer);
        put(row[4], s->up, 0.0f);
        row[5][0] = (float)s->image_offset, row[5][1] = (float)s->image_width;
        row[5][2] = (float)s->image_height, row[5][3] = (float)s->image_levels;
        row[6][0] = (float)s->layer_first, row[6][1] = (float)s->layer_count;
    }
}

void parian_light_list_tables(const parian_light_list *list, float (*samples)[4],
                              float (*layers)[4])
{
    parian_light_sample_table(list->sample, list->sample_count, samples);
    memset(layers, 0, (size_t)list->layer_count * PARIAN_LAYER_ROW * sizeof *layers);
    for (uint32_t i = 0; i < list->layer_count; i++) {
        const parian_shadow_layer *layer = &list->layer[i];
        float(*row)[4] = layers + (size_t)i * PARIAN_LAYER_ROW;
        memcpy(row, layer->row, sizeof layer->row);
        row[4][0] = layer->texel_scale, row[4][1] = layer->perspective ? 1.0f : 0.0f;
        row[4][2] = layer->near_m, row[4][3] = layer->far_m;
    }
}
