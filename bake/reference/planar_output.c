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

static void add_table(cJSON *parent, const parian_planar_table *table)
{
    static const char *const side[2] = {"lit_side", "far_side"};
    cJSON *o = cJSON_AddObjectToObject(parent, table->name);
    double value[3], beyond[3], in[3], out[3], absorbed[3];
    for (uint32_t s = 0; s < side_count(table); s++) {
        char name[32];
        cJSON *p = cJSON_AddObjectToObject(o, side[s]);
        for (int k = 0; k < 2; k++) {
            for (int c = 0; c < 3; c++) {
                const parian_planar_profile *profile = &table->profile[c];
                value[c] = k ? profile->total_error[s] : profile->total[s];
                beyond[c] = profile->bin[s][row_count(table)];
            }
            snprintf(name, sizeof name, k ? "standard_error" : "total");
            reference_add_triple(p, name, value);
        }
        reference_add_triple(p, "beyond_table", beyond);
    }
    for (int c = 0; c < 3; c++) {
        const parian_planar_profile *profile = &table->profile[c];
        double started = profile->books.started;
        value[c] = profile->unscattered;
        beyond[c] = table->desc[c].bin_width;
        in[c] = started > 0 ? 1 : 0;
        out[c] = started > 0 ? profile->books.left / started : 0;
        absorbed[c] = started > 0 ? profile->books.absorbed / started : 0;
    }
    reference_add_triple(o, "unscattered", value);
    reference_add_triple(o, "in", in);
    reference_add_triple(o, "out", out);
    reference_add_triple(o, "absorbed", absorbed);
    reference_add_triple(o, "bin_width_m", beyond);
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
