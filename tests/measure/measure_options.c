/* measure_options.c - the option tables of parian-measure.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/measure_options.h"

#include <stdio.h>
#include <string.h>

enum {
    RECEIVERS_DEFAULT = 1000,
    PICTURE_DEFAULT = 512,
    RECEIVERS_MAX = 10000000,
    SAMPLES_MAX = 2000000000
};

static const char SUMMARY[] =
    "Measures methods and settings against ground truth: error of the scattered\n"
    "radiosity B against milliseconds per relight, bytes of asset and bake seconds.\n"
    "INPUT is a model, which is baked with every --bake, or a baked .parian asset.\n"
    "Writes results.csv, results.json, results.md, plots and maps.";

static const char EPILOGUE[] =
    "Truth is taken at texels of the asset chosen evenly by area, on the surface of\n"
    "the model where INPUT is one, else on the asset's own. Bakes and truths are\n"
    "kept by content in the cache. `parian-measure hard-cases -o DIR` runs the table\n"
    "of hard cases.\n"
    "\n"
    "Examples:\n"
    "  parian-measure bunny.ply --scale 50mm --material marble --lights studio.json \\\n"
    "      -o measured\n"
    "  parian-measure bunny.ply --scale 50mm --bake '--quality preview' \\\n"
    "      --bake '--form paper' --lights studio.json -o measured\n"
    "  parian-measure bunny.parian --lights a.json --lights b.json --reference path \\\n"
    "      --standard-error 0.02 --receivers 200 -o measured";

static const parian_subcommand COMMANDS[] = {
    {"hard-cases", "bakes and measures the cases that break naive code, a verdict for each"}};

static parian_result parse_table(int argc, char **argv, parian_measure_options *o)
{
    const parian_option table[] = {
        {"-o", "--output", PARIAN_OPTION_STRING, &o->output, "DIR",
         "The folder that takes the results.", 0, 0, NULL, NULL},
        {"--lights", NULL, PARIAN_OPTION_LIST, &o->lights, "FILE",
         "A lights file; each one given is a light set of its own.", 0, 0, NULL, NULL},
        {"--bake", NULL, PARIAN_OPTION_LIST, &o->bakes, "OPTIONS",
         "Options of parian-bake as one string, such as '--quality preview'; models are baked once "
         "with each "
         "(one bake with the defaults).",
         0, 0, NULL, NULL},
        {"--material", NULL, PARIAN_OPTION_LIST, &o->materials, "NAME",
         "The medium, as in parian-bake.", 0, 0, NULL, NULL},
        {"--scale", NULL, PARIAN_OPTION_STRING, &o->scale, "LEN",
         "Length of the longest side of a model, such as 50mm, as in parian-bake.", 0, 0, NULL,
         NULL},
        {"--unit", NULL, PARIAN_OPTION_CHOICE, &o->unit, "UNIT", "Unit of length of models.", 0, 0,
         "mm|cm|m", &o->unit_given},
        PARIAN_FLAG_ROW("--keep-origin", &o->keep_origin,
                        "Do not move the box's centre to the origin."),
        {"--methods", NULL, PARIAN_OPTION_STRING, &o->methods_text, "LIST",
         "Methods, NAME[:KEY=VALUE,...], in one string with spaces between them (transfer).", 0, 0,
         NULL, NULL},
        {"--backend", NULL, PARIAN_OPTION_CHOICE, &o->backend, "NAME",
         "What relights: OpenGL 3.3 core or OpenGL ES 3.0 without a window, or the C evaluation "
         "(core).",
         0, 0, "core|es|cpu", NULL},
        {"--reference", NULL, PARIAN_OPTION_CHOICE, &o->reference, "MODEL",
         "The truth (the model that the asset was baked with).", 0, 0,
         "dipole|dipole-flux|directional|pbd|path", &o->reference_given},
        {"--reference-samples", NULL, PARIAN_OPTION_COUNT, &o->samples, "N",
         "Samples of the truth for each receiver; for path the most (what the model takes).", 1,
         SAMPLES_MAX, NULL, NULL},
        {"--standard-error", NULL, PARIAN_OPTION_NUMBER, &o->standard_error, "E",
         "path: stop when the standard error is below this share of the mean of B (0.02).", 1e-6, 1,
         NULL, NULL},
        {"--normalise", NULL, PARIAN_OPTION_CHOICE, &o->normalise, "WHETHER",
         "directional, pbd: scale each channel to the total that radiative transfer gives a "
         "half-space (on).",
         0, 0, "on|off", NULL},
        {"--receivers", NULL, PARIAN_OPTION_COUNT, &o->receivers, "N",
         "Texels at which truth is taken (1000).", 1, RECEIVERS_MAX, NULL, NULL},
        {"--map-receivers", NULL, PARIAN_OPTION_COUNT, &o->map_receivers, "N",
         "Draw error maps, in the atlas and on the object, from truth at this many texels, such as "
         "20000; the "
         "others show the nearest of them (0: no maps).",
         0, RECEIVERS_MAX, NULL, NULL},
        PARIAN_FLAG_ROW("--images", &o->images,
                        "Compare the backend's picture with that of the C evaluation: images.csv."),
        {"--camera", NULL, PARIAN_OPTION_STRING, &o->camera, "VIEW",
         "Of maps and pictures, as in parian-view.", 0, 0, NULL, NULL},
        {"--picture-size", NULL, PARIAN_OPTION_COUNT, &o->picture_size, "N",
         "Side of maps and pictures, pixels (512).", 16, 8192, NULL, NULL},
        {"--cache", NULL, PARIAN_OPTION_STRING, &o->cache, "DIR",
         "Folder of bakes and truths (cache in the -o folder).", 0, 0, NULL, NULL},
        {"--relight-seconds", NULL, PARIAN_OPTION_NUMBER, &o->relight_seconds, "S",
         "Relights are timed for so long, at least 5 and at most 100 of them (5).", 0, 3600, NULL,
         NULL},
        {"--seed", NULL, PARIAN_OPTION_COUNT, &o->seed, "N", "Seed of receivers and truth (0).", 0,
         4294967295.0, NULL, NULL},
    };
    const parian_command command = {.tool = "parian-measure",
                                    .usage =
                                        "INPUT|ASSET.parian ... --lights FILE -o DIR [options]",
                                    .summary = SUMMARY,
                                    .epilogue = EPILOGUE,
                                    .options = table,
                                    .option_count = sizeof table / sizeof *table,
                                    .commands = COMMANDS,
                                    .command_count = sizeof COMMANDS / sizeof *COMMANDS};
    return parian_options_parse(&command, &o->common, &o->inputs, argc, argv, 1);
}

static parian_result usage_error(const char *text, const char *what)
{
    fprintf(stderr, "parian-measure: %s%s; see parian-measure --help\n", text, what);
    return PARIAN_E_ARGUMENT;
}

/* Before a session exists, a log line goes to stderr as the one line of the mistake. */
static void print_mistake(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        fprintf(stderr, "parian-measure: %s\n", text);
    }
}

const char *parian_bake_text_fault(const char *text)
{
    static const char *const refused[] = {
        "-o",        "--output",       "--report",         "--dump",    "-MD", "-MF", "--help",
        "--version", "--print-config", "--list-materials", "--threads", "-q",  "-v",  "--progress"};
    static const char SPACE[] = " \t\n";
    for (text += strspn(text, SPACE); *text; text += strspn(text, SPACE)) {
        size_t n = strcspn(text, SPACE), word = strcspn(text, "= \t\n");
        for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
            if (strlen(refused[i]) == word && strncmp(text, refused[i], word) == 0) {
                return refused[i];
            }
        }
        text += n;
    }
    return NULL;
}

static parian_result check_bakes(const parian_measure_options *o)
{
    for (size_t i = 0; i < o->bakes.count; i++) {
        const char *fault = parian_bake_text_fault(o->bakes.item[i]);
        if (fault) {
            return usage_error("--bake may not hold ", fault);
        }
        for (size_t k = 0; k < i; k++) {
            if (strcmp(o->bakes.item[i], o->bakes.item[k]) == 0) {
                return usage_error("the same --bake twice: ", o->bakes.item[i]);
            }
        }
    }
    return PARIAN_OK;
}

static parian_result check_options(const parian_measure_options *o)
{
    double metres;
    if (o->inputs.count == 0) {
        return usage_error("no INPUT given", "");
    }
    if (!o->output || strcmp(o->output, "-") == 0) {
        return usage_error("no folder for the results: give -o DIR", "");
    }
    if (o->lights.count == 0) {
        return usage_error("no lights: give --lights FILE", "");
    }
    if (o->scale && parian_parse_length(o->scale, &metres) != PARIAN_OK) {
        return usage_error("--scale is not a length such as 50mm: ", o->scale);
    }
    if (o->scale && o->unit_given) {
        return usage_error("--scale and --unit exclude each other", "");
    }
    return check_bakes(o);
}

parian_result parian_measure_options_parse(int argc, char **argv, parian_measure_options *o)
{
    const parian_env env = {.log = print_mistake};
    o->receivers = RECEIVERS_DEFAULT;
    o->picture_size = PICTURE_DEFAULT;
    o->relight_seconds = 5;
    o->methods_text = "transfer";
    parian_result r = parse_table(argc, argv, o);
    if (r != PARIAN_OK || o->common.help || o->common.version) {
        return r;
    }
    r = check_options(o);
    if (r == PARIAN_OK) {
        r = parian_method_list_parse(&env, o->methods_text, o->method, &o->method_count);
    }
    if (r == PARIAN_OK && !o->cache) {
        snprintf(o->cache_default, sizeof o->cache_default, "%s/cache", o->output);
        o->cache = o->cache_default;
    }
    return r;
}

parian_result parian_hard_options_parse(int argc, char **argv, parian_hard_options *o)
{
    static parian_string_list inputs;
    const parian_option table[] = {
        {"-o", "--output", PARIAN_OPTION_STRING, &o->output, "DIR",
         "The folder that takes hard-cases.csv, hard-cases.md and the models of the cases.", 0, 0,
         NULL, NULL},
        {"--cases", NULL, PARIAN_OPTION_STRING, &o->cases, "NAME,...", "Run these alone (all).", 0,
         0, NULL, NULL},
        PARIAN_FLAG_ROW("--list", &o->list, "Print the names and stop."),
    };
    const parian_command command = {
        .tool = "parian-measure hard-cases",
        .usage = "-o DIR [options]",
        .summary = "Bakes, relights and measures the cases that break naive code: for each one "
                   "whether all numbers\n"
                   "are finite, the ratio of energies, the error, what is expected, and whether "
                   "that is met.",
        .epilogue = "Example:\n  parian-measure hard-cases -o hard --cases eta-one,open-mesh",
        .options = table,
        .option_count = sizeof table / sizeof *table};
    parian_result r = parian_options_parse(&command, &o->common, &inputs, argc, argv, 2);
    if (r != PARIAN_OK || o->common.help || o->common.version) {
        return r;
    }
    if (inputs.count > 0) {
        return usage_error("hard-cases takes no INPUT: ", inputs.item[0]);
    }
    return o->output || o->list ? PARIAN_OK
                                : usage_error("no folder for the results: give -o DIR", "");
}
