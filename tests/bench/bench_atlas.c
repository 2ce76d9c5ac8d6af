/* bench_atlas.c - CPU seconds of the atlas and texels stages on a sphere of 20,480 triangles or a
 * mesh file.
 *
 *   bench_atlas [model] [side]     a model goes through import, surface and transfer mesh first
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "bake/stages/atlas.h"
#include "bake/stages/atlas_picture.h"
#include "bake/stages/import.h"
#include "bake/stages/surface.h"
#include "bake/stages/texels.h"
#include "bake/stages/transfer_mesh.h"
#include "support/atlas_case.h"
#include "tool/picture.h"

static double cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The transfer surface of the first part of a model. */
static parian_result load_model(const parian_env *env, const char *path, parian_mesh *mesh)
{
    parian_source_scene scene;
    parian_surface_report surface;
    parian_transfer_mesh_report transfer;
    parian_result result = parian_import(env, path, &scene);
    if (result != PARIAN_OK) {
        return result;
    }
    result = parian_stage_surface(env, &scene.parts[0].mesh, &surface);
    if (result == PARIAN_OK) {
        result = parian_stage_transfer_mesh(env, &scene.parts[0].mesh, NULL, mesh, &transfer);
    }
    parian_source_scene_free(env, &scene);
    return result;
}

static void write_picture(const parian_env *env, const parian_body *body)
{
    uint8_t(*rgba)[4];
    const char *path = test_scratch("atlas.png");
    if (PARIAN_NEW(env, rgba, (size_t)body->atlas_size * body->atlas_size) &&
        parian_atlas_picture(env, body, rgba) == PARIAN_OK &&
        parian_png_write(env, path, body->atlas_size, body->atlas_size,
                         (const uint8_t(*)[4])rgba) == PARIAN_OK) {
        printf("picture     %s\n", path);
    }
    parian_free(env, rgba);
}

int main(int argc, char **argv)
{
    const parian_env *env = test_env(1);
    parian_mesh mesh;
    parian_body body;
    parian_atlas_report report;
    parian_atlas_desc desc = {.atlas_size = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 512};
    parian_result result =
        argc > 1 ? load_model(env, argv[1], &mesh) : test_sphere(env, 0.025, 32, &mesh);
    if (result != PARIAN_OK || atlas_case_body(env, &mesh, &body) != PARIAN_OK) {
        fprintf(stderr, "bench_atlas: %s\n", parian_result_text(result));
        return 1;
    }
    double start = cpu_seconds();
    result = parian_stage_atlas(env, &desc, &body, &report);
    double middle = cpu_seconds();
    if (result != PARIAN_OK || parian_stage_texels(env, &body) != PARIAN_OK) {
        fprintf(stderr, "bench_atlas: %s\n", parian_result_text(result));
        return 1;
    }
    printf("triangles   %u\nside        %u\ncharts      %u\noccupancy   %.3f\nstretch     %.2f\n",
           body.triangle_count, body.atlas_size, report.chart_count, report.occupancy,
           report.stretch_max);
    printf("atlas       %.3f s\ntexels      %.3f s (%u texels, one thread)\n", middle - start,
           cpu_seconds() - middle, body.texel_count);
    printf("border      %u texels, %.1f %%, %.1f neighbours each\ngutter      %u texels\n",
           body.border_count, 100.0 * body.border_count / body.texel_count,
           body.border_count ? (double)body.border_offset[body.border_count] / body.border_count
                             : 0.0,
           body.gutter_count);
    write_picture(env, &body);
    parian_body_free(env, &body);
    parian_mesh_free(env, &mesh);
    return 0;
}
