/* planar_output.c - writes tables of half-space and slab as CSV and npy, and their totals.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <stdio.h>

#include "bake/reference/reference_files.h"
#include "bake/reference/reference_output.h"
#include "core/memory.h"
#include "core/small_maths.h"

enum { ROW_TEXT_MAX = 192, COLUMNS_MAX = 6 };

static const char *const CHANNEL[] = {"red", "green", "blue"};

static uint32_t side_count(const parian_planar_table *table)
{
    return table->desc[0].shape == PARIAN_SLAB ? 2 : 1;
}

/* The last bin of a profile also holds what lies beyond, and is no density: it is left out. */
static uint32_t row_count(const parian_planar_table *table)
{
    return table->desc[0].bin_count - 1;
}

/* One ring: its middle radius, then flux per area and standard error of each side. */
static void fill_row(const parian_planar_table *table, int channel, uint32_t bin,
                     double row[COLUMNS_MAX])
{
    const parian_planar_profile *p = &table->profile[channel];
    double width = table->desc[channel].bin_width, inner = bin * width, outer = inner + width;
    double area = PARIAN_PI * (outer * outer - inner * inner);
    row[0] = 0.5 * (inner + outer);
    for (uint32_t s = 0; s < side_count(table); s++) {
        row[1 + 2 * s] = p->bin[s][bin] / area;
        row[2 + 2 * s] = p->bin_error[s][bin] / area;
    }
}

static parian_result write_csv(reference_files *files, const parian_planar_table *table)
{
    size_t rows = 3 * (size_t)row_count(table), used = 0, room = (rows + 1) * ROW_TEXT_MAX;
    char *text = parian_alloc(files->env, room, 1), name[64];
    bool slab = side_count(table) > 1;
    if (!text) {
        return parian_fail(files->env, PARIAN_E_NOMEM, "no memory for a table of %zu rows", rows);
    }
    used += (size_t)snprintf(text, room, "channel,radius_m,lit_side_per_m2,lit_side_error%s\n",
                             slab ? ",far_side_per_m2,far_side_error" : "");
    for (size_t i = 0; i < rows; i++) {
        int c = (int)(i / row_count(table));
        double row[COLUMNS_MAX];
        fill_row(table, c, (uint32_t)(i % row_count(table)), row);
        used += (size_t)snprintf(text + used, room - used, "%s,%.9g,%.9g,%.9g", CHANNEL[c], row[0],
                                 row[1], row[2]);
        if (slab) {
            used += (size_t)snprintf(text + used, room - used, ",%.9g,%.9g", row[3], row[4]);
        }
        used += (size_t)snprintf(text + used, room - used, "\n");
    }
    snprintf(name, sizeof name, "%s.csv", table->name);
    parian_result r = reference_files_text(files, name, text);
    parian_free(files->env, text);
    return r;
}

static parian_result write_npy(reference_files *files, const parian_planar_table *table)
{
    uint32_t rows = row_count(table), columns = 1 + 2 * side_count(table);
    const uint64_t shape[3] = {3, rows, columns};
    char name[64];
    double *value;
    if (!PARIAN_NEW(files->env, value, (size_t)3 * rows * columns)) {
        return parian_fail(files->env, PARIAN_E_NOMEM, "no memory for a table of %u rows", rows);
    }
    for (size_t i = 0; i < (size_t)3 * rows; i++) {
        double row[COLUMNS_MAX];
        fill_row(table, (int)(i / rows), (uint32_t)(i % rows), row);
        for (uint32_t k = 0; k < columns; k++) {
            value[i * columns + k] = row[k];
        }
    }
    snprintf(name, sizeof name, "%s.npy", table->name);
    parian_result r = reference_files_npy(files, name, PARIAN_ELEMENT_F64, 3, shape, value);
    parian_free(files->env, value);
    return r;
}

/* Totals of one side, and what of them lies beyond the table. */
static void add_side(cJSON *parent, const char *name, const parian_planar_table *table,
                     uint32_t side)
{
    cJSON *o = cJSON_AddObjectToObject(parent, name);
    double total[3], error[3], beyond[3];
    for (int c = 0; c < 3; c++) {
        const parian_planar_profile *profile = &table->profile[c];
        total[c] = profile->total[side];
        error[c] = profile->total_error[side];
        beyond[c] = profile->bin[side][row_count(table)];
    }
    reference_add_triple(o, "total", total);
    reference_add_triple(o, "standard_error", error);
    reference_add_triple(o, "beyond_table", beyond);
}

/* Where the energy went, as shares: in + roulette_added = out + absorbed + roulette_removed. */
static void add_books(cJSON *o, const parian_planar_table *table)
{
    double in[3], out[3], absorbed[3], added[3], removed[3];
    for (int c = 0; c < 3; c++) {
        const parian_walk_books *books = &table->profile[c].books;
        double share = books->started > 0 ? 1 / books->started : 0;
        in[c] = share * books->started;
        out[c] = share * books->left;
        absorbed[c] = share * books->absorbed;
        added[c] = share * books->roulette_added;
        removed[c] = share * books->roulette_removed;
    }
    reference_add_triple(o, "in", in);
    reference_add_triple(o, "out", out);
    reference_add_triple(o, "absorbed", absorbed);
    reference_add_triple(o, "roulette_added", added);
    reference_add_triple(o, "roulette_removed", removed);
}

static void add_table(cJSON *parent, const parian_planar_table *table)
{
    cJSON *o = cJSON_AddObjectToObject(parent, table->name);
    double unscattered[3], width[3];
    add_side(o, "lit_side", table, 0);
    if (side_count(table) > 1) {
        add_side(o, "far_side", table, 1);
    }
    for (int c = 0; c < 3; c++) {
        unscattered[c] = table->profile[c].unscattered;
        width[c] = table->desc[c].bin_width;
    }
    reference_add_triple(o, "unscattered", unscattered);
    add_books(o, table);
    reference_add_triple(o, "bin_width_m", width);
    cJSON_AddNumberToObject(o, "bins", row_count(table));
}

static cJSON *make_summary(const parian_planar_table *tables, size_t count,
                           const parian_planar_about *about)
{
    cJSON *root = cJSON_CreateObject();
    double events = 0;
    if (!root) {
        return NULL;
    }
    cJSON_AddStringToObject(root, "tool", "parian-bake " PARIAN_VERSION);
    cJSON_AddStringToObject(root, "model", "planar");
    reference_add_medium(root, "body", about->medium);
    if (about->thickness > 0) {
        cJSON_AddNumberToObject(root, "thickness_m", about->thickness);
    }
    cJSON_AddNumberToObject(root, "samples", (double)about->photons);
    cJSON_AddNumberToObject(root, "seed", (double)about->seed);
    for (size_t t = 0; t < count; t++) {
        add_table(root, &tables[t]);
        for (int c = 0; c < 3; c++) {
            events += (double)tables[t].profile[c].books.events;
        }
    }
    cJSON_AddNumberToObject(root, "scattering_events", events);
    cJSON_AddNumberToObject(root, "seconds", about->seconds);
    return root;
}

parian_result parian_planar_write(const parian_env *env, const char *folder,
                                  const parian_planar_table *tables, size_t count,
                                  const parian_planar_about *about)
{
    reference_files files = {.env = env, .folder = folder};
    parian_result r = PARIAN_OK;
    for (size_t t = 0; r == PARIAN_OK && t < count; t++) {
        r = write_csv(&files, &tables[t]);
        if (r == PARIAN_OK) {
            r = write_npy(&files, &tables[t]);
        }
    }
    if (r == PARIAN_OK) {
        r = reference_files_json(&files, "summary.json", make_summary(tables, count, about));
    }
    if (r != PARIAN_OK) {
        reference_files_remove(&files);
    }
    return r;
}
