/* measure_images.c - the picture that the backend draws against that of the C evaluation.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "tests/measure/image_metrics.h"
#include "tests/measure/measure_run.h"

static const double MEAN_TARGET =
    0.18; /* of the reference picture, before measures that look at [0, 1] */

static parian_result draw(const parian_env *env, parian_relit *relit, const parian_measure_run *run,
                          const parian_measure_case *c, float (*picture)[4])
{
    const parian_view_extent extent = parian_view_extent_of(&relit->info);
    parian_view_camera view;
    parian_result r =
        parian_renderer_set_lights(relit->renderer, c->lights->set.light, c->lights->set.count);
    r = r == PARIAN_OK ? parian_relit_camera(env, relit, run->options->camera, &view) : r;
    if (r == PARIAN_OK) {
        const parian_camera camera = parian_view_camera_matrices(&view, &extent, 1);
        r = parian_relit_draw(relit, &camera, run->options->picture_size, picture);
    }
    return r;
}

/* Bring both pictures to an exposure that suits the reference; returns the factor. */
static double expose(float (*picture)[4], float (*reference)[4], size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += ((double)reference[i][0] + (double)reference[i][1] + (double)reference[i][2]) / 3;
    }
    double factor = sum > 0 ? MEAN_TARGET * (double)count / sum : 1;
    for (size_t i = 0; i < 3 * count; i++) {
        picture[i / 3][i % 3] *= (float)factor;
        reference[i / 3][i % 3] *= (float)factor;
    }
    return factor;
}

static void add_line(parian_measure_run *run, const parian_measure_case *c, double factor,
                     const parian_image_metrics *m)
{
    parian_text *text = &run->images;
    if (text->length == 0) {
        parian_text_add(text, "asset,method,lights,backend,reference,width,height,exposure,rmse,"
                              "rel_mse,psnr,flip_mean,"
                              "flip_p95,hdr_flip_mean,hdr_flip_p95\n");
    }
    parian_text_add_field(text, c->asset->label);
    parian_text_add(text, ",transfer,");
    parian_text_add_field(text, c->lights->name);
    parian_text_add(text, ",%s,cpu,%u,%u,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n",
                    parian_measure_backend_name(c->relit->device->backend),
                    run->options->picture_size, run->options->picture_size, factor, m->rmse,
                    m->rel_mse, m->psnr, m->flip_mean, m->flip_p95, m->hdr_flip_mean,
                    m->hdr_flip_p95);
}

parian_result parian_measure_image(const parian_env *env, parian_measure_run *run,
                                   const parian_measure_case *c)
{
    const parian_measure_device cpu = {.backend = PARIAN_MEASURE_CPU};
    size_t count = (size_t)run->options->picture_size * run->options->picture_size;
    float(*picture)[4] = NULL, (*reference)[4] = NULL;
    parian_relit relit = {0};
    parian_image_metrics metrics;
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW(env, picture, count) || !PARIAN_NEW(env, reference, count)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for two pictures");
    }
    r = r == PARIAN_OK ? draw(env, c->relit, run, c, picture) : r;
    r = r == PARIAN_OK ? parian_relit_open(env, c->asset->path, &cpu, &relit) : r;
    r = r == PARIAN_OK ? draw(env, &relit, run, c, reference) : r;
    if (r == PARIAN_OK) {
        double factor = expose(picture, reference, count);
        r = parian_image_measure(env, run->options->picture_size, run->options->picture_size,
                                 (const float(*)[4])picture, (const float(*)[4])reference, &metrics,
                                 NULL);
        if (r == PARIAN_OK) {
            add_line(run, c, factor, &metrics);
        }
    }
    parian_relit_close(env, &relit);
    parian_free(env, picture);
    parian_free(env, reference);
    return r;
}
