/* planar_command.c - parian-bake reference --model planar: tables of half-space and slab by Monte
 * Carlo.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/cli/reference_command.h"
#include "bake/reference/reference_output.h"
#include "core/dipole.h"
#include "core/memory.h"
#include "tool/session.h"

enum { TABLES_MAX = 4, PHOTONS_DEFAULT = 200000, BINS_MIN = 128, BINS_MAX = 4096 };
static const double BIN_WIDTH = 0.1; /* transport mean free paths */
static const double SPENT = 1e-4;    /* share of the flux that may leave beyond the table */

/* Bins until nearly all flux of the widest channel is out, by the dipole. */
static uint32_t count_bins(const parian_medium *medium)
{
    uint32_t most = BINS_MIN;
    for (int c = 0; c < 3; c++) {
        parian_dipole d = parian_dipole_make(medium, c, false);
        double total = parian_dipole_total(&d);
        uint32_t bins = BINS_MIN;
        while (bins < BINS_MAX && total > 0 &&
               parian_dipole_disc_energy(&d, bins * BIN_WIDTH * d.z_r) < (1 - SPENT) * total) {
            bins *= 2;
        }
        most = most > bins ? most : bins;
    }
    return most;
}

static parian_result make_table(const parian_env *env, const parian_reference_options *options,
                                const parian_medium *medium, uint32_t index,
                                parian_planar_table *table)
{
    static const char *const name[TABLES_MAX] = {"half_space_diffuse", "half_space_normal",
                                                 "slab_diffuse", "slab_normal"};
    parian_result r = PARIAN_OK;
    table->name = name[index];
    for (int c = 0; r == PARIAN_OK && c < 3; c++) {
        parian_dipole d = parian_dipole_make(medium, c, false);
        table->desc[c] = (parian_planar_desc){
            .shape = index < 2 ? PARIAN_HALF_SPACE : PARIAN_SLAB,
            .size = options->thickness,
            .medium = parian_walk_medium_make(medium, c),
            .normal_incidence = index % 2 == 1,
            .photons = options->samples ? options->samples : PHOTONS_DEFAULT,
            .seed = options->seed + UINT64_C(0x100000000) * (3 * index + (uint64_t)c),
            .bin_count = count_bins(medium) + 1,
            .bin_width = BIN_WIDTH * d.z_r};
        r = parian_planar_profile_make(env, &table->desc[c], &table->profile[c]);
    }
    return r;
}

static parian_result make_tables(const parian_env *env, const parian_reference_options *options,
                                 const parian_medium *medium, parian_planar_table *tables,
                                 size_t count)
{
    parian_planar_about about = {.medium = medium,
                                 .thickness = options->thickness,
                                 .photons = options->samples ? options->samples : PHOTONS_DEFAULT,
                                 .seed = options->seed};
    double start = parian_seconds();
    parian_result r = PARIAN_OK;
    for (uint32_t t = 0; r == PARIAN_OK && t < count; t++) {
        r = make_table(env, options, medium, t, &tables[t]);
    }
    about.seconds = parian_seconds() - start;
    return r == PARIAN_OK ? parian_planar_write(env, options->output, tables, count, &about) : r;
}

parian_result parian_planar_command(const parian_env *env, const parian_reference_options *options)
{
    parian_planar_table tables[TABLES_MAX];
    parian_medium medium;
    memset(tables, 0, sizeof tables);
    parian_result r = parian_check_outputs(env, &options->scene);
    if (r == PARIAN_OK) {
        r = parian_find_medium(env, options->materials.item[0], &medium);
    }
    if (r == PARIAN_OK) {
        r = make_tables(env, options, &medium, tables, options->thickness > 0 ? 4 : 2);
    }
    for (int i = 0; i < TABLES_MAX * 3; i++) {
        parian_planar_profile_free(env, &tables[i / 3].profile[i % 3]);
    }
    return r;
}
