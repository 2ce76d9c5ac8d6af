/* bench_load.c - seconds from a file to the first picture, phase by phase: reading, checking,
 * shaders, upload, light, picture. Never a verdict.
 *
 *   bench_load ASSET.parian [repeats]
 *
 * Medians of repeats (default 5), wall and CPU of all threads, with the file in the page cache and
 * the driver's shader cache warm; the context is the first that EGL gives.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "gl/egl_context.h"
#include "parian/format.h"
#include "parian/runtime.h"
#include "support/lit_scene.h"
#include "tool/session.h"

enum { PHASES = 9, REPEAT_MAX = 99, WIDTH = 960, HEIGHT = 720 };

static const char *const phase_name[PHASES] = {
    "hash all bytes", "verify blocks", "scene open", "create without upload",
    "upload",         "first relight", "first draw", "second relight",
    "second draw"};

static double seconds[PHASES][REPEAT_MAX], cpu_seconds[PHASES][REPEAT_MAX];
static uint64_t asset_bytes, upload_bytes;

static void expect(parian_result result, const char *what)
{
    if (result != PARIAN_OK) {
        fprintf(stderr, "bench_load: %s: %s\n", what, parian_result_text(result));
        exit(1);
    }
}

static double lap_start, lap_cpu_start;

static void start_lap(void)
{
    lap_start = parian_seconds();
    lap_cpu_start = (double)clock() / CLOCKS_PER_SEC;
}

static void end_lap(int phase, int repeat)
{
    seconds[phase][repeat] = parian_seconds() - lap_start;
    cpu_seconds[phase][repeat] = (double)clock() / CLOCKS_PER_SEC - lap_cpu_start;
    start_lap();
}

/* Checksums alone, then with the decoding of every block. */
static void read_file(const parian_env *env, const char *path, int r)
{
    FILE *file = fopen(path, "rb");
    parian_reader *reader = NULL;
    expect(file ? PARIAN_OK : PARIAN_E_IO, path);
    fseek(file, 0, SEEK_END);
    asset_bytes = (uint64_t)ftell(file);
    rewind(file);
    char *bytes = malloc(asset_bytes);
    expect(bytes && fread(bytes, 1, asset_bytes, file) == asset_bytes ? PARIAN_OK : PARIAN_E_IO,
           path);
    fclose(file);
    start_lap();
    volatile XXH64_hash_t hash = XXH3_64bits(bytes, asset_bytes);
    (void)hash;
    end_lap(0, r);
    free(bytes);
    start_lap();
    expect(parian_reader_open(env, path, NULL, &reader), "open");
    expect(parian_reader_verify(reader), "verify");
    end_lap(1, r);
    parian_reader_close(reader);
}

static void show(const parian_env *env, const char *path, int r)
{
    const float eye[3] = {0.05f, 0.03f, 0.11f};
    const parian_renderer_desc desc = {.get_proc_address = test_egl_address,
                                       .deferred_upload = true};
    const parian_draw_desc draw = {.camera = lit_camera(eye, WIDTH, HEIGHT),
                                   .width = WIDTH,
                                   .height = HEIGHT,
                                   .framebuffer = UINT32_MAX};
    parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-0.4f, -0.3f, -1}, .color = {3, 3, 3}};
    parian_scene *scene = NULL;
    parian_renderer *renderer = NULL;
    uint64_t left = 0;
    start_lap();
    expect(parian_scene_open(env, path, &scene), "open the scene");
    end_lap(2, r);
    expect(parian_renderer_create(env, scene, &desc, &renderer), "create a renderer");
    end_lap(3, r);
    expect(parian_renderer_upload(renderer, 1, &left), "upload");
    upload_bytes = left;
    expect(parian_renderer_upload(renderer, 0, &left), "upload");
    end_lap(4, r);
    parian_renderer_set_timing(renderer, true); /* each pass is waited for */
    for (int k = 0; k < 2; k++) {
        light.direction[0] += 0.1f;
        expect(parian_renderer_set_lights(renderer, &light, 1), "set lights");
        expect(parian_renderer_relight(renderer), "relight");
        end_lap(5 + 2 * k, r);
        expect(parian_renderer_draw(renderer, &draw), "draw");
        end_lap(6 + 2 * k, r);
    }
    if (r == 0) {
        printf("%s\n", parian_renderer_name(renderer));
    }
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    const parian_env *env = test_env(0);
    int repeats = argc > 2 ? atoi(argv[2]) : 5;
    test_egl egl;
    if (argc < 2 || repeats < 1 || repeats > REPEAT_MAX || !test_egl_open(&egl, false)) {
        fprintf(stderr, "usage: bench_load ASSET.parian [repeats], where EGL gives OpenGL 3.3\n");
        return 1;
    }
    for (int r = 0; r < repeats; r++) {
        read_file(env, argv[1], r);
        show(env, argv[1], r);
    }
    for (int p = 0; p < PHASES; p++) {
        uint64_t bytes = p < 3 ? asset_bytes : p == 4 ? upload_bytes : 0;
        qsort(seconds[p], (size_t)repeats, sizeof **seconds, compare_doubles);
        qsort(cpu_seconds[p], (size_t)repeats, sizeof **seconds, compare_doubles);
        double median = seconds[p][repeats / 2];
        printf("%-22s %8.1f ms %8.1f ms CPU", phase_name[p], 1e3 * median,
               1e3 * cpu_seconds[p][repeats / 2]);
        printf(bytes ? "  %8.1f MB  %8.0f MB/s\n" : "\n", 1e-6 * (double)bytes,
               1e-6 * (double)bytes / median);
    }
    test_egl_close(&egl);
    return 0;
}
