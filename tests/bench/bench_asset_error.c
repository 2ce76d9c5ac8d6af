/* bench_asset_error.c - error of B against brute-force quadrature, with milliseconds and bytes
 * beside it.
 *
 *   bench_asset_error ASSET LIGHT...     LIGHT as parian-view --light takes it
 *
 * One line a light: relative L2 and energy ratio per channel at 1,000 receivers, the smallest B,
 * and the medians of the passes of a relight by the C evaluation.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/body_file.h"
#include "core/memory.h"
#include "parian/runtime.h"
#include "support/quadrature.h"
#include "support/test_support.h"
#include "tool/lights_file.h"
#include "tool/session.h"

enum { RECEIVERS = 1000, REPEATS = 5 };

typedef struct bench {
    const parian_env *env;
    parian_scene_data data;
    parian_scene *scene;
    parian_renderer *renderer;
    size_t texel_count;
    float (*position)[3], (*normal)[3], *area, (*irradiance)[3], (*radiosity)[3];
} bench;

static parian_result open_asset(bench *b, const char *path)
{
    parian_reader *reader = NULL;
    parian_result r = parian_reader_open(b->env, path, NULL, &reader);
    if (r == PARIAN_OK) {
        r = parian_scene_data_read(b->env, reader, &b->data);
    }
    parian_reader_close(reader);
    double start = parian_seconds();
    parian_renderer_desc desc = {.backend = PARIAN_BACKEND_CPU};
    if (r == PARIAN_OK) {
        r = parian_scene_open(b->env, path, &b->scene);
    }
    if (r == PARIAN_OK) {
        r = parian_renderer_create(b->env, b->scene, &desc, &b->renderer);
    }
    printf("load %.2f s\n", parian_seconds() - start);
    return r;
}

static bool allocate(bench *b)
{
    size_t n = b->texel_count = parian_scene_get_info(b->scene).texel_count;
    return PARIAN_NEW(b->env, b->position, n) && PARIAN_NEW(b->env, b->normal, n) &&
           PARIAN_NEW(b->env, b->area, n) && PARIAN_NEW(b->env, b->irradiance, n) &&
           PARIAN_NEW(b->env, b->radiosity, n);
}

static parian_result relight(bench *b, const parian_light_set *set)
{
    parian_texel_arrays arrays = {.position = b->position,
                                  .normal = b->normal,
                                  .area = b->area,
                                  .irradiance = b->irradiance,
                                  .radiosity = b->radiosity};
    parian_result r = PARIAN_OK;
    parian_renderer_set_timing(b->renderer, true);
    for (int i = 0; r == PARIAN_OK && i < REPEATS; i++) {
        r = parian_renderer_set_lights(b->renderer, set->light, set->count);
        r = r == PARIAN_OK ? parian_renderer_relight(b->renderer) : r;
    }
    return r == PARIAN_OK ? parian_renderer_read_texels(b->renderer, &arrays) : r;
}

static void print_body_error(const quadrature_error *e)
{
    printf("  L2 %.4f %.4f %.4f  energy %.4f %.4f %.4f  p99.9 %.3f %.3f %.3f  smallest %.2g",
           e->l2[0], e->l2[1], e->l2[2], e->energy[0], e->energy[1], e->energy[2], e->p999[0],
           e->p999[1], e->p999[2], e->smallest);
}

static void print_times(const bench *b)
{
    parian_pass_time times[PARIAN_PASS_MAX];
    size_t count = parian_renderer_get_times(b->renderer, times);
    for (size_t i = 0; i < count; i++) {
        if (times[i].runs > 0) {
            printf("  %s %.2f ms", times[i].name, times[i].ms);
        }
    }
    printf("\n");
}

/* Bodies one after the other: light does not pass from body to body. */
static parian_result measure(bench *b, const char *spec)
{
    size_t at = 0, receiver[RECEIVERS];
    static double truth[RECEIVERS][3];
    for (uint32_t k = 0; k < b->data.body_count; k++) {
        const parian_body *body = &b->data.bodies[k];
        quadrature_texels texels = {body->texel_count, (const float(*)[3])(b->position + at),
                                    (const float(*)[3])(b->normal + at), b->area + at,
                                    (const float(*)[3])(b->irradiance + at)};
        quadrature_pick(&texels, RECEIVERS, 7, receiver);
        parian_result r = quadrature_radiosity(b->env, &body->medium, body->fit_fdr, &texels,
                                               receiver, RECEIVERS, truth);
        if (r != PARIAN_OK) {
            return r;
        }
        quadrature_error e = quadrature_compare(&texels, (const float(*)[3])(b->radiosity + at),
                                                receiver, RECEIVERS, (const double(*)[3])truth);
        printf("%s, %s, %s:", body->name, body->medium.name, spec);
        print_body_error(&e);
        at += body->texel_count;
    }
    print_times(b);
    return PARIAN_OK;
}

int main(int argc, char **argv)
{
    bench b = {.env = test_env(0)};
    struct stat info;
    if (argc < 3 || stat(argv[1], &info) != 0) {
        fprintf(stderr, "usage: bench_asset_error ASSET LIGHT...\n");
        return 1;
    }
    printf("%.2f MB  ", (double)info.st_size / 1e6);
    parian_result r = open_asset(&b, argv[1]);
    if (r == PARIAN_OK && !allocate(&b)) {
        r = PARIAN_E_NOMEM;
    }
    for (int i = 2; r == PARIAN_OK && i < argc; i++) {
        parian_light_set set = {0};
        r = parian_lights_parse_spec(b.env, argv[i], &set);
        r = r == PARIAN_OK ? relight(&b, &set) : r;
        r = r == PARIAN_OK ? measure(&b, argv[i]) : r;
        parian_light_set_free(b.env, &set);
    }
    if (r != PARIAN_OK) {
        fprintf(stderr, "bench_asset_error: %s\n", parian_result_text(r));
    }
    return parian_result_exit_status(r);
}
