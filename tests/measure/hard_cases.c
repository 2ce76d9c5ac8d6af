/* hard_cases.c - the table of hard cases, and its report.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/hard_cases.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tests/measure/results_table.h"
#include "tool/files.h"

/* clang-format off */
/* Coefficients are in units of 1 / size, so that the numbers say how many mean free paths a body is wide. The plain
 * medium is that of marble at 20 mm. */
#define PLAIN {40, 50, 60}, {0.05, 0.1, 0.2}
#define BALL PARIAN_SHAPE_SPHERE, 0.02
#define SOUND .error_max = 0.03, .energy_max = 0.01, .minimum = -0.001
#define PHYSICS .truth = PARIAN_HARD_PATH, .error_max = 0.15, .energy_max = 0.05, .minimum = -0.001

static const char AS_SOUND[] = "as a sound sphere at this setting";
static const char REDUCED[] = "transport by reduced coefficients: as with g = 0";
static const char UNITS[] = "the same body in other units";
static const char SHEET[] =
    "three quarters of the light cross half a mean free path, most of it unscattered; by distance alone the two sides "
    "of a wide sheet give 1.53 of what enters";
static const char CREASE[] = "distance takes a short cut through air";
static const char EDGE[] = "near an edge half of the flux leaves by the other face";
static const char CONSERVED[] =
    "what enters a body that does not absorb leaves it; by distance alone what would go past the far side is lost";
static const char CROSSING[] =
    "light crosses unscattered, which no diffuse BSSRDF holds";
static const char SIMILAR[] =
    "similarity keeps totals to 2 % at this albedo; the rest is the dipole's, on a radius of 5 to 7 mean free paths";

const parian_hard_case parian_hard_case_table[] = {
    {"sound-sphere", BALL, PLAIN, 0, 1.5, SOUND, .reason = "nothing is hard: what the others are held against"},
    {"absorption-zero", BALL, {40, 50, 60}, {0, 0, 0}, 0, 1.5, SOUND, .reason = AS_SOUND},
    {"absorption-zero-path", BALL, {40, 50, 60}, {0, 0, 0}, 0, 1.5, PARIAN_HARD_SKY, PHYSICS, .reason = CONSERVED},
    {"absorption-zero-flux-path", BALL, {40, 50, 60}, {0, 0, 0}, 0, 1.5, PARIAN_HARD_SKY, PHYSICS,
     .flux = true, .reason = CONSERVED},
    {"albedo-one", BALL, {400, 500, 600}, {0.04, 0.05, 0.06}, 0, 1.5, SOUND, .reason = AS_SOUND},
    {"eta-one", BALL, PLAIN, 0, 1, SOUND, .reason = AS_SOUND},
    {"eta-one-path", BALL, PLAIN, 0, 1, PHYSICS, .reason = "no boundary: A = 1"},
    {"eta-below-one", BALL, PLAIN, 0, 0.7, PARIAN_HARD_SKY, PARIAN_HARD_REFUSED, .error_max = 0.3, .energy_max = 0.3,
     .minimum = -0.001,
     .reason = "the bake refuses it in one line; quadrature and path tracing stay finite, and no farther apart than "
               "the dipole is from truth on a sphere of 20 mean free paths (29 % was measured)"},
    {"eta-2.5", BALL, PLAIN, 0, 2.5, SOUND, .reason = AS_SOUND},
    {"g-0.95", BALL, PLAIN, 0.95, 1.5, SOUND, .reason = REDUCED},
    {"g-0.995", BALL, PLAIN, 0.995, 1.5, SOUND, .reason = REDUCED},
    {"g-minus-0.5", BALL, PLAIN, -0.5, 1.5, SOUND, .reason = REDUCED},
    {"g-0.95-path", BALL, {10, 12, 14}, {0.01, 0.02, 0.04}, 0.95, 1.5, PARIAN_HARD_SKY, PHYSICS, .reason = SIMILAR},
    {"g-0.95-flux-path", BALL, {10, 12, 14}, {0.01, 0.02, 0.04}, 0.95, 1.5, PARIAN_HARD_SKY, PHYSICS,
     .flux = true, .reason = SIMILAR},
    {"g-minus-0.5-path", BALL, {10, 12, 14}, {0.01, 0.02, 0.04}, -0.5, 1.5, PARIAN_HARD_SKY, PHYSICS,
     .reason = SIMILAR},
    {"strong-absorption", BALL, {40, 40, 40}, {40, 160, 640}, 0, 1.5, SOUND,
     .reason = "R_d falls by 200 orders of magnitude over the body: half floats with a scale of each row hold it"},
    {"one-channel-dark", BALL, {40, 40, 0}, {0.1, 0.1, 40}, 0, 1.5, SOUND,
     .reason = "a channel that does not scatter gives B = 0"},
    {"path-below-texel", BALL, {4e5, 5e5, 6e5}, {400, 500, 600}, 0, 1.5, PARIAN_HARD_SUN, PARIAN_HARD_LAMBERT,
     .error_max = 0.03, .energy_max = 0.01, .minimum = -0.001,
     .reason = "a mean free path below 1/2000 texel: Lambert's law with the albedo of the half-space"},
    {"path-above-object", BALL, {0.05, 0.1, 0.2}, {0.0005, 0.001, 0.002}, 0, 1.5, SOUND, .reason = AS_SOUND},
    {"path-above-object-path", BALL, {0.05, 0.1, 0.2}, {0.0005, 0.001, 0.002}, 0, 1.5, PARIAN_HARD_SKY, PHYSICS,
     .reason = CROSSING},
    {"path-above-object-flux-path", BALL, {0.05, 0.1, 0.2}, {0.0005, 0.001, 0.002}, 0, 1.5, PARIAN_HARD_SKY, PHYSICS,
     .flux = true, .reason = CROSSING},
    {"thin-sheet", PARIAN_SHAPE_SHEET, 0.02, {12, 16, 20}, {0.02, 0.04, 0.08}, 0, 1.5, SOUND,
     .reason = "a sheet of 0.3 to 0.5 mean free paths: as a sound sphere"},
    {"thin-sheet-path", PARIAN_SHAPE_SHEET, 0.02, {12, 16, 20}, {0.02, 0.04, 0.08}, 0, 1.5, PHYSICS, .reason = SHEET},
    {"thin-sheet-flux-path", PARIAN_SHAPE_SHEET, 0.02, {12, 16, 20}, {0.02, 0.04, 0.08}, 0, 1.5, PHYSICS,
     .flux = true, .reason = SHEET},
    {"sharp-edge", PARIAN_SHAPE_BOX, 0.02, PLAIN, 0, 1.5, SOUND, .reason = AS_SOUND},
    {"sharp-edge-path", PARIAN_SHAPE_BOX, 0.02, PLAIN, 0, 1.5, PARIAN_HARD_SKY, PHYSICS, .reason = EDGE},
    {"sharp-edge-flux-path", PARIAN_SHAPE_BOX, 0.02, PLAIN, 0, 1.5, PARIAN_HARD_SKY, PHYSICS,
     .flux = true, .reason = EDGE},
    {"concave-crease", PARIAN_SHAPE_CREASE, 0.02, PLAIN, 0, 1.5, SOUND, .reason = AS_SOUND},
    {"concave-crease-path", PARIAN_SHAPE_CREASE, 0.02, PLAIN, 0, 1.5, PHYSICS, .reason = CREASE},
    {"concave-crease-flux-path", PARIAN_SHAPE_CREASE, 0.02, PLAIN, 0, 1.5, PHYSICS, .flux = true, .reason = CREASE},
    {"zero-area-triangles", PARIAN_SHAPE_ZERO_AREA, 0.02, PLAIN, 0, 1.5, SOUND, .reason = AS_SOUND},
    {"uneven-triangles", PARIAN_SHAPE_UNEVEN_SPHERE, 0.02, PLAIN, 0, 1.5, SOUND, .reason = AS_SOUND},
    {"open-mesh", PARIAN_SHAPE_BOWL, 0.02, PLAIN, 0, 1.5, PARIAN_HARD_SKY, .error_max = 0.05, .energy_max = 0.03,
     .minimum = -0.001,
     .reason = "a surface without inside: as a sound sphere, and 2 % for what its rim does to normals"},
    {"non-manifold", PARIAN_SHAPE_TOUCHING, 0.02, PLAIN, 0, 1.5, SOUND,
     .reason = "four triangles at an edge are parted: as a sound sphere"},
    {"scale-0.1mm", PARIAN_SHAPE_SPHERE, 0.0001, PLAIN, 0, 1.5, SOUND, .reason = UNITS},
    {"scale-10m", PARIAN_SHAPE_SPHERE, 10, PLAIN, 0, 1.5, SOUND, .reason = UNITS},
    {"small-spot", BALL, PLAIN, 0, 1.5, PARIAN_HARD_SPOT, .error_max = 0.1, .energy_max = 0.05, .minimum = -0.001,
     .reason = "a spot of a few vertices' distance: no ringing, nothing below zero; its rim costs accuracy"},
    {"no-light", BALL, PLAIN, 0, 1.5, PARIAN_HARD_NIGHT, .error_max = 0, .energy_max = 0, .minimum = 0,
     .reason = "B = 0 everywhere, and no 0 / 0"},
};
/* clang-format on */
const size_t parian_hard_case_count =
    sizeof parian_hard_case_table / sizeof parian_hard_case_table[0];

int parian_hard_cases_list(void)
{
    for (size_t i = 0; i < parian_hard_case_count; i++) {
        puts(parian_hard_case_table[i].name);
    }
    return parian_result_exit_status(fflush(stdout) == 0 ? PARIAN_OK : PARIAN_E_IO);
}

/* ---- which cases
 * ---------------------------------------------------------------------------------------------- */
static bool name_is_listed(const char *names, const char *name)
{
    size_t n = strlen(name);
    for (const char *at = names; at && *at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        if (strncmp(at, name, n) == 0 && (at[n] == ',' || at[n] == '\0')) {
            return true;
        }
    }
    return false;
}

/* Every name of the list must be a case. */
static parian_result check_names(const parian_env *env, const char *names)
{
    for (const char *at = names; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        int n = (int)strcspn(at, ",");
        bool known = false;
        for (size_t i = 0; i < parian_hard_case_count; i++) {
            const char *name = parian_hard_case_table[i].name;
            known = known || ((int)strlen(name) == n && strncmp(at, name, (size_t)n) == 0);
        }
        if (!known) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "no hard case is named '%.*s'; --list prints the names", n, at);
        }
    }
    return PARIAN_OK;
}

/* ---- the report
 * ------------------------------------------------------------------------------------------------
 */
static void describe_expected(const parian_hard_case *c, parian_text *text)
{
    parian_text_add(text, "%sL2 within %g %%, energy within %g %%: %s",
                    c->truth == PARIAN_HARD_REFUSED ? "refused; " : "finite; ", 100 * c->error_max,
                    100 * c->energy_max, c->reason);
}

static const char *truth_name(const parian_hard_case *c)
{
    static const char *const names[] = {"quadrature", "path tracing", "Lambert", "path tracing"};
    return names[c->truth];
}

static void add_csv_line(const parian_env *env, const parian_hard_case *c,
                         const parian_hard_outcome *o, parian_text *csv)
{
    parian_text expected = {.env = env};
    describe_expected(c, &expected);
    parian_text_add(csv, "%s,%s,", c->name, o->finite ? "yes" : "no");
    if (o->measured) {
        parian_text_add(csv, "%.6g,%.6g,", o->energy_ratio, o->error);
    } else {
        parian_text_add(csv, ",,");
    }
    parian_text_add_field(csv, expected.text ? expected.text : "");
    parian_text_add(csv, ",%s\n", o->pass ? "pass" : "short");
    csv->failed = csv->failed || expected.failed;
    parian_free(env, expected.text);
}

static void print_line(const parian_hard_case *c, const parian_hard_outcome *o)
{
    if (o->measured) {
        printf("%-28s %-6s %8.4f %8.2f %8.2f  %-12s %6.1f  %s\n", c->name, o->finite ? "yes" : "no",
               o->energy_ratio, 100 * o->error, 100 * o->standard_error, truth_name(c), o->seconds,
               o->pass ? "pass" : "SHORT");
    } else {
        printf("%-28s %-6s %8s %8s %8s  %-12s %6.1f  %s\n", c->name, o->finite ? "yes" : "no", "-",
               "-", "-", truth_name(c), o->seconds, o->pass ? "pass" : "SHORT");
    }
    if (!o->measured) {
        printf("  %s\n", o->note);
    }
    fflush(stdout);
}

static void add_page_line(const parian_hard_case *c, const parian_hard_outcome *o,
                          parian_text *page)
{
    parian_text_add(page, "| %s | %s | ", c->name, o->finite ? "yes" : "no");
    if (o->measured) {
        parian_text_add(page, "%.4f | %.2f | %.2f | %.3g |", o->energy_ratio, 100 * o->error,
                        100 * o->standard_error, o->minimum);
    } else {
        parian_text_add(page, "- | - | - | - |");
    }
    parian_text_add(page, " %s, %llu | ", truth_name(c), (unsigned long long)o->receivers);
    describe_expected(c, page);
    parian_text_add(page, " | %s |\n", o->pass ? "pass" : "**short**");
}

static void add_page_head(parian_text *page)
{
    parian_text_add(
        page,
        "# Hard cases\n\n`parian-measure hard-cases` bakes each one with 1,500 vertices and an "
        "atlas of "
        "160 x 160, relights it with the C evaluation, and compares B at texels spread by area "
        "with the "
        "truth: quadrature of the same BSSRDF on the source surface (the error of the "
        "discretisation), "
        "path tracing (that of the model as well), or Lambert's law. Numbers are those of the "
        "worst "
        "channel; the error is the area-weighted relative L2. The models are beside this page.\n\n"
        "| case | finite | energy ratio | error %% | standard error of the truth %% | least B over "
        "mean | "
        "truth, receivers | expected | verdict |\n|---|---|---|---|---|---|---|---|---|\n");
}

static void add_page_notes(const parian_hard_case *const *done, const parian_hard_outcome *outcome,
                           size_t count, parian_text *page)
{
    size_t shorts = 0;
    for (size_t i = 0; i < count; i++) {
        shorts += !outcome[i].pass;
    }
    parian_text_add(page, "\n%zu of %zu cases fall short%s\n", shorts, count, shorts ? ":\n" : ".");
    for (size_t i = 0; i < count; i++) {
        if (!outcome[i].pass) {
            parian_text_add(page, "* %s%s%s\n", done[i]->name, outcome[i].measured ? "" : ": ",
                            outcome[i].measured ? "" : outcome[i].note);
        }
    }
}

static parian_result write_report(const parian_env *env, const char *folder, parian_text *csv,
                                  parian_text *page)
{
    char *csv_path = parian_path_join(env, folder, "hard-cases.csv");
    char *page_path = parian_path_join(env, folder, "hard-cases.md");
    parian_result r = csv_path && page_path
                          ? PARIAN_OK
                          : parian_fail(env, PARIAN_E_NOMEM, "no memory for a path");
    r = r == PARIAN_OK ? parian_text_write(csv, csv_path) : r;
    r = r == PARIAN_OK ? parian_text_write(page, page_path) : r;
    parian_free(env, csv_path);
    parian_free(env, page_path);
    return r;
}

/* Room for what every case gave. */
typedef struct hard_results {
    const parian_hard_case **done;
    parian_hard_outcome *outcome;
    size_t count;
} hard_results;

static parian_result run_cases(const parian_env *env, const char *models, const char *names,
                               hard_results *results)
{
    parian_result r = PARIAN_OK;
    printf("%-28s %-6s %8s %8s %8s  %-12s %6s  %s\n", "case", "finite", "energy", "error %",
           "s.e. %", "truth", "s", "verdict");
    for (size_t i = 0; r == PARIAN_OK && i < parian_hard_case_count; i++) {
        const parian_hard_case *c = &parian_hard_case_table[i];
        if (names && !name_is_listed(names, c->name)) {
            continue;
        }
        parian_progress(env, c->name, (double)i / (double)parian_hard_case_count);
        r = parian_cancelled(env)
                ? PARIAN_E_INTERRUPTED
                : parian_hard_case_run(env, c, models, &results->outcome[results->count]);
        if (r == PARIAN_OK) {
            print_line(c, &results->outcome[results->count]);
            results->done[results->count++] = c;
        }
    }
    return r;
}

parian_result parian_hard_cases_run(const parian_env *env, const char *folder, const char *names)
{
    parian_text csv = {.env = env}, page = {.env = env};
    hard_results results = {0};
    char *models = parian_path_join(env, folder, "models");
    parian_result r = check_names(env, names);
    if (r == PARIAN_OK && (!models || !PARIAN_NEW0(env, results.done, parian_hard_case_count) ||
                           !PARIAN_NEW0(env, results.outcome, parian_hard_case_count))) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for the hard cases");
    }
    r = r == PARIAN_OK ? parian_folder_create(env, models) : r;
    r = r == PARIAN_OK ? run_cases(env, models, names, &results) : r;
    if (r == PARIAN_OK) {
        parian_text_add(&csv, "case,finite,energy_ratio,error,expected,verdict\n");
        add_page_head(&page);
        for (size_t i = 0; i < results.count; i++) {
            add_csv_line(env, results.done[i], &results.outcome[i], &csv);
            add_page_line(results.done[i], &results.outcome[i], &page);
        }
        add_page_notes(results.done, results.outcome, results.count, &page);
        r = write_report(env, folder, &csv, &page);
    }
    parian_free(env, csv.text);
    parian_free(env, page.text);
    parian_free(env, results.done);
    parian_free(env, results.outcome);
    parian_free(env, models);
    return r;
}
