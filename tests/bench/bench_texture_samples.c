/* bench_texture_samples.c - texture-space importance sampling: error of B against milliseconds.
 *
 *   bench_texture_samples ASSET LIGHT...     LIGHT as parian-view --light takes it
 *
 * A row for each light and number of samples: L2 error of B against brute-force quadrature at 500
 * receivers, root mean square over 4 seeds; energy; milliseconds of pyramid and samples, and of the
 * sums at all texels, by the C evaluation.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/body_file.h"
#include "core/memory.h"
#include "cpu/cpu_texture.h"
#include "parian/runtime.h"
#include "support/quadrature.h"
#include "support/test_support.h"
#include "tool/lights_file.h"
#include "tool/session.h"

enum { RECEIVERS = 500, SEEDS = 4 };

typedef struct bench {
    const parian_env *env;
    parian_scene_data data;
    const parian_body *body;
    parian_renderer *renderer;
    float (*position)[3], (*normal)[3], *area, (*irradiance)[3], (*radiosity)[3];
    quadrature_texels texels;
    size_t receiver[RECEIVERS];
    double truth[RECEIVERS][3];
} bench;

static parian_result light_body(bench *b, const char *spec)
{
    parian_light_set set = {0};
    parian_texel_arrays arrays = {.position = b->position,
                                  .normal = b->normal,
                                  .area = b->area,
                                  .irradiance = b->irradiance,
                                  .radiosity = b->radiosity};
    parian_result r = parian_lights_parse_spec(b->env, spec, &set);
    r = r == PARIAN_OK ? parian_renderer_set_lights(b->renderer, set.light, set.count) : r;
    r = r == PARIAN_OK ? parian_renderer_read_texels(b->renderer, &arrays) : r;
    parian_light_set_free(b->env, &set);
    b->texels = (quadrature_texels){b->body->texel_count, (const float(*)[3])b->position,
                                    (const float(*)[3])b->normal, b->area,
                                    (const float(*)[3])b->irradiance};
    quadrature_pick(&b->texels, RECEIVERS, 7, b->receiver);
    return r == PARIAN_OK ? quadrature_radiosity(b->env, &b->body->medium, b->body->fit_fdr,
                                                 &b->texels, b->receiver, RECEIVERS, b->truth)
                          : r;
}

static void measure(bench *b, const parian_transport_model *model, parian_flux_pyramid *pyramid,
                    uint32_t count)
{
    double squares[3] = {0}, energy[3] = {0}, draw_ms = INFINITY, gather_ms = INFINITY;
    float(*number)[3];
    parian_flux_sample *sample;
    if (!PARIAN_NEW(b->env, number, count) || !PARIAN_NEW(b->env, sample, count)) {
        abort();
    }
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        parian_texture_numbers(seed, count, number);
        double start = parian_seconds();
        parian_flux_pyramid_build(b->env, b->body, (const float(*)[3])b->irradiance, pyramid);
        parian_texture_samples_draw(b->env, b->body, pyramid, (const float(*)[3])b->irradiance,
                                    (const float(*)[3])number, count, sample);
        double drawn = parian_seconds();
        if (parian_cpu_texture_gather(b->env, b->body, model, sample, count, b->radiosity) !=
            PARIAN_OK) {
            abort();
        }
        draw_ms = fmin(draw_ms, 1e3 * (drawn - start));
        gather_ms = fmin(gather_ms, 1e3 * (parian_seconds() - drawn));
        quadrature_error e =
            quadrature_compare(&b->texels, (const float(*)[3])b->radiosity, b->receiver, RECEIVERS,
                               (const double(*)[3])b->truth);
        for (int c = 0; c < 3; c++) {
            squares[c] += e.l2[c] * e.l2[c] / SEEDS;
            energy[c] += e.energy[c] / SEEDS;
        }
    }
    printf("| %u | %.2f/%.2f/%.2f | %.4f/%.4f/%.4f | %.2f | %.1f |\n", count,
           100 * sqrt(squares[0]), 100 * sqrt(squares[1]), 100 * sqrt(squares[2]), energy[0],
           energy[1], energy[2], draw_ms, gather_ms);
    fflush(stdout);
    parian_free(b->env, number);
    parian_free(b->env, sample);
}

static parian_result open_asset(bench *b, const char *path)
{
    parian_reader *reader = NULL;
    parian_scene *scene = NULL;
    parian_renderer_desc desc = {.backend = PARIAN_BACKEND_CPU};
    parian_result r = parian_reader_open(b->env, path, NULL, &reader);
    r = r == PARIAN_OK ? parian_scene_data_read(b->env, reader, &b->data) : r;
    parian_reader_close(reader);
    r = r == PARIAN_OK ? parian_scene_open(b->env, path, &scene) : r;
    r = r == PARIAN_OK ? parian_renderer_create(b->env, scene, &desc, &b->renderer) : r;
    if (r == PARIAN_OK) {
        size_t n = parian_scene_get_info(scene).texel_count;
        b->body = &b->data.bodies[0];
        bool room = PARIAN_NEW(b->env, b->position, n) && PARIAN_NEW(b->env, b->normal, n) &&
                    PARIAN_NEW(b->env, b->area, n) && PARIAN_NEW(b->env, b->irradiance, n) &&
                    PARIAN_NEW(b->env, b->radiosity, n);
        r = room ? PARIAN_OK : PARIAN_E_NOMEM;
    }
    return r;
}

int main(int argc, char **argv)
{
    static const uint32_t counts[] = {49, 100, 400, 900, 1600, 3600, 6400, 14400};
    bench b = {.env = test_env(0)};
    parian_transport_model model = {0};
    parian_flux_pyramid pyramid = {0};
    if (argc < 3) {
        fprintf(stderr, "usage: bench_texture_samples ASSET LIGHT...\n");
        return 1;
    }
    parian_result r = open_asset(&b, argv[1]);
    r = r == PARIAN_OK ? parian_transport_model_make(b.env, b.body, PARIAN_MODEL_FULL, &model) : r;
    r = r == PARIAN_OK ? parian_flux_pyramid_create(b.env, b.body, &pyramid) : r;
    for (int i = 2; r == PARIAN_OK && i < argc; i++) {
        r = light_body(&b, argv[i]);
        if (r == PARIAN_OK) {
            printf(
                "\n%s, %s, %u texels, %s\n\n| samples | L2 %% R/G/B | energy | draw ms | gather ms "
                "|\n|---|---|---|---|---|\n",
                b.body->name, b.body->medium.name, b.body->texel_count, argv[i]);
        }
        for (size_t k = 0; r == PARIAN_OK && k < sizeof counts / sizeof *counts; k++) {
            measure(&b, &model, &pyramid, counts[k]);
        }
    }
    if (r != PARIAN_OK) {
        fprintf(stderr, "bench_texture_samples: %s\n", parian_result_text(r));
    }
    return parian_result_exit_status(r);
}
