/* reference_options.c - the option table of parian-bake reference and what must hold between its
 * options.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/cli/reference_options.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MODEL_PLANAR = 5, RECEIVERS_DEFAULT = 1000, RECEIVERS_MAX = 100000000, FIRST_ARGUMENT = 2 };
static const double STANDARD_ERROR_DEFAULT = 0.02;
static const uint64_t SAMPLES_MOST = UINT64_C(1)
                                     << 32; /* walks, where a standard error ends the run */

/* Models of an option: bit i is model i of the list. */
enum {
    ON_BSSRDF = 0x0f,
    ON_DIPOLES = 0x07, /* those with a diffuse Fresnel reflectance of either form */
    ON_NORMALISED = 0x0c,
    ON_PATH = 0x10,
    ON_PLANAR = 0x20,
    ON_SURFACE = ON_BSSRDF | ON_PATH
};

typedef struct raw_options {
    const char *receivers;
    int model, fdr, normalise, walk, unit;
    uint32_t samples, seed;
    double scale;
    bool scale_given, unit_given, samples_given, receivers_given, fdr_given, normalise_given,
        walk_given;
    bool patch_given, error_given, thickness_given;
} raw_options;

static const char SUMMARY[] =
    "Computes ground truth: scattered radiosity B on the surface of INPUT, a model (.glb .gltf "
    ".obj "
    ".ply .stl .off) or a .parian asset, by integrating a BSSRDF over the surface or by volumetric "
    "path tracing. Writes receiver_*.npy and summary.json into DIR. Lengths are metres, B and E "
    "are "
    "W/m^2.";

static const char EPILOGUE[] =
    "Examples:\n"
    "  parian-bake reference bunny.ply --scale 50mm --material marble \\\n"
    "      --light directional:0,0,-1:irradiance=1 -o truth\n"
    "  parian-bake reference figurine.parian --lights lights.json --model dipole-flux \\\n"
    "      --receivers 5000 -o truth\n"
    "  parian-bake reference bunny.ply --scale 50mm --lights lights.json --model path \\\n"
    "      --standard-error 0.005 -o truth\n"
    "  parian-bake reference --model planar --material skin1 --thickness 2mm -o tables";

static parian_result parse_table(int argc, char **argv, raw_options *raw,
                                 parian_reference_options *o, parian_string_list *inputs)
{
    const parian_option table[] = {
        PARIAN_GROUP_ROW("Scene"),
        {"--material", NULL, PARIAN_OPTION_LIST, &o->materials, "NAME|FILE",
         "As in a bake: a preset, a FILE.json, or MESHNAME=NAME. Default: the model's own, else "
         "marble, with a warning.",
         0, 0, NULL, NULL},
        {"--scale", NULL, PARIAN_OPTION_LENGTH, &raw->scale, "LEN",
         "The longest side of the bodies' bounding box becomes LEN, such as 50mm.", 0, 0, NULL,
         &raw->scale_given},
        {"--unit", NULL, PARIAN_OPTION_CHOICE, &raw->unit, "UNIT", "Unit of length of the file.", 0,
         0, "mm|cm|m", &raw->unit_given},
        PARIAN_FLAG_ROW("--keep-origin", &o->scene.keep_origin,
                        "Do not move the box's centre to the origin."),
        {"--lights", NULL, PARIAN_OPTION_STRING, &o->lights_file, "FILE.json",
         "The lights. Default: the scene's own.", 0, 0, NULL, NULL},
        {"--light", NULL, PARIAN_OPTION_LIST, &o->light_specs, "SPEC",
         "One more light, such as directional:0,0,-1:irradiance=1 or environment:radiance=1.", 0, 0,
         NULL, NULL},
        {"--field", NULL, PARIAN_OPTION_STRING, &o->field_file, "FILE.npy",
         "path: coefficients on a grid over each body's box, [z][y][x] factors, or [z][y][x][6] "
         "sigma_s and sigma_a in 1/mm.",
         0, 0, NULL, NULL},
        PARIAN_GROUP_ROW("Truth"),
        {"--model", NULL, PARIAN_OPTION_CHOICE, &raw->model, "MODEL",
         "dipole, dipole-flux, directional or pbd over the surface; path for the radiative "
         "transfer "
         "equation; planar for tables of half-space and slab, without INPUT (dipole).",
         0, 0, "dipole|dipole-flux|directional|pbd|path|planar", NULL},
        {"--receivers", NULL, PARIAN_OPTION_STRING, &raw->receivers, "N|FILE.npy",
         "Places where B is computed: N spread evenly by area, or points [n][3] moved to the "
         "nearest surface (1000).",
         0, 0, NULL, &raw->receivers_given},
        {"--samples", NULL, PARIAN_OPTION_COUNT, &raw->samples, "N",
         "Per receiver: places on the surface (65536), for path walks per channel; for planar "
         "photons per table and channel (200000).",
         1, 4294967295.0, NULL, &raw->samples_given},
        {"--seed", NULL, PARIAN_OPTION_COUNT, &raw->seed, "N", "Seed of all random numbers (0).", 0,
         4294967295.0, NULL, NULL},
        {"-o", "--output", PARIAN_OPTION_STRING, &o->output, "DIR", "The folder to write.", 0, 0,
         NULL, NULL},
        PARIAN_GROUP_ROW("Models over the surface"),
        {"--fdr", NULL, PARIAN_OPTION_CHOICE, &raw->fdr, "FORM",
         "Fresnel moments of the dipoles: exact, or the printed fit (exact).", 0, 0, "exact|fit",
         &raw->fdr_given},
        {"--normalise", NULL, PARIAN_OPTION_CHOICE, &raw->normalise, "WHETHER",
         "directional, pbd: scale each channel to the total that radiative transfer gives a "
         "half-space (on).",
         0, 0, "on|off", &raw->normalise_given},
        PARIAN_GROUP_ROW("Path tracing"),
        {"--standard-error", NULL, PARIAN_OPTION_NUMBER, &o->standard_error, "E",
         "Stop when the root mean square standard error is below this share of the mean of B "
         "(0.02 unless --samples is given).",
         1e-6, 1, NULL, &raw->error_given},
        {"--walk", NULL, PARIAN_OPTION_CHOICE, &raw->walk, "KIND",
         "Walks from the receivers or from the light; auto tries both and keeps the better for "
         "each light (auto).",
         0, 0, "auto|adjoint|forward", &raw->walk_given},
        {"--patch", NULL, PARIAN_OPTION_LENGTH, &o->patch, "LEN",
         "Forward walks: radius of the disc around a receiver that gathers.", 0, 0, NULL,
         &raw->patch_given},
        PARIAN_GROUP_ROW("Planes"),
        {"--thickness", NULL, PARIAN_OPTION_LENGTH, &o->thickness, "LEN",
         "planar: a slab of this thickness too.", 0, 0, NULL, &raw->thickness_given},
    };
    const parian_command command = {.tool = "parian-bake reference",
                                    .usage = "INPUT --lights FILE [options] -o DIR",
                                    .summary = SUMMARY,
                                    .epilogue = EPILOGUE,
                                    .options = table,
                                    .option_count = sizeof table / sizeof *table};
    return parian_options_parse(&command, &o->common, inputs, argc, argv, FIRST_ARGUMENT);
}

static parian_result usage_error(const char *text)
{
    fprintf(stderr, "parian-bake reference: error: %s (see parian-bake reference --help)\n", text);
    return PARIAN_E_ARGUMENT;
}

/* Refuse an option that the chosen model would ignore. */
static parian_result check_use(const raw_options *raw, const parian_reference_options *o,
                               size_t inputs)
{
    const struct {
        bool given;
        int models;
        const char *text;
    } uses[] = {
        {inputs > 0, ON_SURFACE, "--model planar takes no INPUT"},
        {o->lights_file || o->light_specs.count, ON_SURFACE, "--model planar takes no lights"},
        {raw->receivers_given, ON_SURFACE, "--model planar takes no --receivers"},
        {raw->scale_given || raw->unit_given || o->scene.keep_origin, ON_SURFACE,
         "--model planar takes no --scale, --unit or --keep-origin"},
        {raw->fdr_given, ON_DIPOLES, "--fdr is for dipole, dipole-flux and directional"},
        {raw->normalise_given, ON_NORMALISED, "--normalise is for directional and pbd"},
        {raw->error_given, ON_PATH, "--standard-error is for path"},
        {raw->walk_given, ON_PATH, "--walk is for path"},
        {raw->patch_given, ON_PATH, "--patch is for path"},
        {o->field_file != NULL, ON_PATH, "--field is for path"},
        {raw->thickness_given, ON_PLANAR, "--thickness is for planar"}};
    for (size_t i = 0; i < sizeof uses / sizeof *uses; i++) {
        if (uses[i].given && !(uses[i].models >> raw->model & 1)) {
            return usage_error(uses[i].text);
        }
    }
    return PARIAN_OK;
}

static parian_result check_options(const raw_options *raw, const parian_reference_options *o,
                                   const parian_string_list *inputs)
{
    parian_result r = check_use(raw, o, inputs->count);
    if (r != PARIAN_OK) {
        return r;
    }
    if (raw->model != MODEL_PLANAR && inputs->count != 1) {
        return usage_error(inputs->count ? "one INPUT expected, several given" : "no INPUT given");
    }
    if (raw->model == MODEL_PLANAR && o->materials.count != 1) {
        return usage_error("--model planar needs one --material");
    }
    if (!o->output || strcmp(o->output, "-") == 0) {
        return usage_error("no output: give -o DIR");
    }
    if (raw->scale_given && raw->unit_given) {
        return usage_error("--scale and --unit exclude each other");
    }
    return PARIAN_OK;
}

/* "1000" is a number of receivers, anything else a file. */
static parian_result parse_receivers(const raw_options *raw, parian_reference_options *o)
{
    const char *text = raw->receivers_given ? raw->receivers : "";
    char *end;
    errno = 0;
    o->receiver_count = RECEIVERS_DEFAULT;
    if (*text == '\0') {
        return raw->receivers_given ? usage_error("--receivers: a number or FILE.npy expected")
                                    : PARIAN_OK;
    }
    if (strspn(text, "0123456789") != strlen(text)) {
        o->receiver_count = 0;
        o->receiver_file = text;
        return PARIAN_OK;
    }
    o->receiver_count = strtoull(text, &end, 10);
    bool right = errno == 0 && o->receiver_count >= 1 && o->receiver_count <= RECEIVERS_MAX;
    return right ? PARIAN_OK : usage_error("--receivers: outside of 1 to 100000000");
}

static void fill_options(const raw_options *raw, const parian_string_list *inputs,
                         parian_reference_options *o)
{
    static const double units[] = {1e-3, 1e-2, 1};
    o->planar = raw->model == MODEL_PLANAR;
    o->model = o->planar ? PARIAN_REFERENCE_PATH : (parian_reference_model)raw->model;
    o->fit_fdr = raw->fdr == 1;
    o->normalise = raw->normalise == 0 && (ON_NORMALISED >> raw->model & 1);
    o->walk = (parian_walk_kind)raw->walk;
    o->seed = raw->seed;
    o->samples = raw->samples_given ? raw->samples : 0;
    if (raw->model == PARIAN_REFERENCE_PATH && !raw->samples_given) {
        o->samples = SAMPLES_MOST;
        o->standard_error = raw->error_given ? o->standard_error : STANDARD_ERROR_DEFAULT;
    }
    o->scene.input = inputs->count ? inputs->item[0] : NULL;
    o->scene.material = o->materials.item;
    o->scene.material_count = o->materials.count;
    o->scene.scale_m = raw->scale_given ? raw->scale : 0;
    o->scene.unit_m = raw->unit_given ? units[raw->unit] : 0;
    o->scene.dump_folder = o->output;
}

parian_result parian_reference_options_parse(int argc, char **argv,
                                             parian_reference_options *options)
{
    raw_options raw = {0};
    parian_string_list inputs = {0};
    parian_result r = parse_table(argc, argv, &raw, options, &inputs);
    if (r != PARIAN_OK || options->common.help || options->common.version) {
        return r;
    }
    r = check_options(&raw, options, &inputs);
    if (r == PARIAN_OK) {
        r = parse_receivers(&raw, options);
    }
    if (r == PARIAN_OK) {
        fill_options(&raw, &inputs, options);
    }
    return r;
}
