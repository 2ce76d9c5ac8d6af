/* test_nasty_surface.c - import and surface over a folder of damaged files: each is mended or
 * refused.
 *
 * The shared test data where they are present; random triangle soups of the worst kinds in any
 * case.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>

#include "bake/stages/import.h"
#include "bake/stages/surface.h"
#include "core/memory.h"
#include "support/sound_surface.h"

static int lines; /* of errors, in the present call */

static void count_errors(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        lines++;
        print_message("    %s\n", text);
    }
}

static const parian_env counting = {.log = count_errors};

static void run_file(const char *path, bool *refused)
{
    parian_source_scene scene = {0};
    lines = 0;
    parian_result result = parian_import(&counting, path, &scene);
    for (uint32_t p = 0; result == PARIAN_OK && p < scene.part_count; p++) {
        parian_surface_report report;
        result = parian_stage_surface(&counting, &scene.parts[p].mesh, &report);
        if (result == PARIAN_OK) {
            assert_sound_surface(&scene.parts[p].mesh, &report);
        }
    }
    *refused = result != PARIAN_OK;
    assert_true(result == PARIAN_OK || result == PARIAN_E_FORMAT);
    assert_int_equal(lines, *refused ? 1 : 0); /* exactly one line says why */
    parian_source_scene_free(NULL, &scene);
}

static void shared_files(void **state)
{
    (void)state;
    static const char *const refusals[] = {"all_degenerate.obj",  "empty.ply",
                                           "infinite_bounds.glb", "nan_inf.obj",
                                           "oom_header.off",      "truncated_midline.obj"};
    const char *folder = test_shared("data/nasty");
    DIR *dir = folder ? opendir(folder) : NULL;
    if (!dir) {
        skip();
    }
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        char path[1024];
        bool refused, expected = false;
        if (entry->d_name[0] == '.') {
            continue;
        }
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        print_message("%s\n", entry->d_name);
        run_file(path, &refused);
        for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
            expected = expected || strcmp(entry->d_name, refusals[i]) == 0;
        }
        assert_int_equal(refused, expected);
    }
    closedir(dir);
}

static uint32_t next_random(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* Triangles among few vertices of a small grid: every kind of non-manifold, flat and repeated there
 * is. */
static void random_soups(void **state)
{
    (void)state;
    uint32_t seed = 1;
    for (int round = 0; round < 400; round++) {
        parian_mesh mesh = {.vertex_count = 4 + next_random(&seed) % 30,
                            .triangle_count = 1 + next_random(&seed) % 120};
        assert_true(PARIAN_NEW(NULL, mesh.position, mesh.vertex_count) &&
                    PARIAN_NEW(NULL, mesh.triangle, mesh.triangle_count));
        uint32_t grid = 2 + next_random(&seed) % 4;
        for (uint32_t i = 0; i < 3 * mesh.vertex_count; i++) {
            mesh.position[i / 3][i % 3] = next_random(&seed) % grid;
        }
        for (uint32_t i = 0; i < 3 * mesh.triangle_count; i++) {
            mesh.triangle[i / 3][i % 3] = next_random(&seed) % mesh.vertex_count;
        }
        parian_surface_report report;
        parian_result result = parian_stage_surface(NULL, &mesh, &report);
        if (result == PARIAN_OK) {
            assert_sound_surface(&mesh, &report);
        } else {
            assert_int_equal(result, PARIAN_E_FORMAT);
        }
        parian_mesh_free(NULL, &mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_soups),
                                       cmocka_unit_test(shared_files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
