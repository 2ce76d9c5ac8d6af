/* bake_options.c - the option table of parian-bake and what must hold between its options.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/cli/bake_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LOCAL_COUNT = 4, QUALITY_NONE = -1 };

static const parian_local_form LOCAL_FORMS[LOCAL_COUNT] = {PARIAN_LOCAL_REBUILT, PARIAN_LOCAL_F16,
                                                           PARIAN_LOCAL_U8, PARIAN_LOCAL_SPLIT};

/* What the table fills before it is turned into a desc. */
typedef struct raw_options {
    const char *output, *report, *dump, *depfile;
    double scale, threshold, threshold_absolute;
    int unit, bssrdf, fdr, form, local, hierarchy, quality;
    uint32_t atlas, kernel, vertices, seed;
    bool md, keep_origin, force_local, force_global, no_local, no_global;
    bool atlas_given, kernel_given, vertices_given, threshold_given, absolute_given, unit_given;
    bool quality_given, scale_given;
} raw_options;

static const char SUMMARY[] =
    "Turns a model and a measured medium into a .parian asset that the runtime\n"
    "relights. INPUT is .glb .gltf .obj .ply .stl or .off. In a glTF scene every node\n"
    "whose material scatters is a body; the other meshes are its diffuse\n"
    "surroundings. Bodies beyond four share the vertices and texels of four.";

static const parian_subcommand COMMANDS[] = {
    {"reference", "ground truth instead: a BSSRDF integrated over the surface, or path tracing"}};

static const char EPILOGUE[] =
    "Examples:\n"
    "  parian-bake figurine.glb -o figurine.parian\n"
    "  parian-bake bunny.ply --scale 50mm --material marble -o bunny.parian --report bunny.json\n"
    "  parian-bake bust.obj --unit mm --material skin1 --quality preview -o bust.parian";

static parian_result parse_table(int argc, char **argv, raw_options *raw,
                                 parian_bake_options *options, parian_string_list *inputs)
{
    const parian_option table[] = {
        {"-o", "--output", PARIAN_OPTION_STRING, &raw->output, "OUT.parian", "The asset to write.",
         0, 0, NULL, NULL},
        {"--material", NULL, PARIAN_OPTION_LIST, &options->materials, "NAME|FILE",
         "A preset (see --list-materials; case, spaces, - and _ do not matter), a FILE.json, or "
         "MESHNAME=NAME "
         "for one glTF mesh, node or material. Default: the glTF's own volume extensions, else "
         "marble, "
         "with a warning.",
         0, 0, NULL, NULL},
        {"--scale", NULL, PARIAN_OPTION_LENGTH, &raw->scale, "LEN",
         "The longest side of the bodies' bounding box becomes LEN, such as 50mm; for obj, ply, "
         "stl and off "
         "the box's centre becomes the origin. Default: glTF metres; the other formats need "
         "--scale or "
         "--unit.",
         0, 0, NULL, &raw->scale_given},
        {"--unit", NULL, PARIAN_OPTION_CHOICE, &raw->unit, "UNIT", "Unit of length of the file.", 0,
         0, "mm|cm|m", &raw->unit_given},
        PARIAN_FLAG_ROW("--keep-origin", &raw->keep_origin,
                        "Do not move the box's centre to the origin."),
        {"--bssrdf", NULL, PARIAN_OPTION_CHOICE, &raw->bssrdf, "MODEL",
         "Model of the transport: the standard dipole by distance, or with the true gradient at "
         "the receiver "
         "(dipole).",
         0, 0, "dipole|dipole-flux", NULL},
        {"--fdr", NULL, PARIAN_OPTION_CHOICE, &raw->fdr, "FORM",
         "Diffuse Fresnel reflectance of the dipole: the exact moment, or the printed fit (exact).",
         0, 0, "exact|fit", NULL},
        {"--form", NULL, PARIAN_OPTION_CHOICE, &raw->form, "FORM",
         "The mended form, or the paper's own: dual basis, unconstrained fit, zero diagonal, "
         "absolute "
         "threshold (parian).",
         0, 0, "parian|paper", NULL},
        {"--atlas", NULL, PARIAN_OPTION_COUNT, &raw->atlas, "N",
         "Side of the atlas in texels (512).", 16, 8192, NULL, &raw->atlas_given},
        {"--kernel", NULL, PARIAN_OPTION_COUNT, &raw->kernel, "K",
         "Width of the local kernel, odd (7).", 3, 15, NULL, &raw->kernel_given},
        {"--local", NULL, PARIAN_OPTION_CHOICE, &raw->local, "FORM",
         "How the local response is carried: rebuilt at load, stored as fp16 or bytes, or a smooth "
         "split by "
         "distance (rebuilt).",
         0, 0, "rebuilt|f16|u8|split", NULL},
        {"--transfer-vertices", NULL, PARIAN_OPTION_COUNT, &raw->vertices, "N",
         "Vertices of the transfer mesh, met within 5 % (10000).", 4, 200000, NULL,
         &raw->vertices_given},
        {"--threshold", NULL, PARIAN_OPTION_NUMBER, &raw->threshold, "T",
         "The smallest throughput factors of a row are dropped while their sum stays below T of "
         "the row's "
         "sum (0.002).",
         0, 0.5, NULL, &raw->threshold_given},
        {"--threshold-absolute", NULL, PARIAN_OPTION_NUMBER, &raw->threshold_absolute, "T",
         "Drop the factors below T, as the paper does (there 1e-5).", 1e-12, 1, NULL,
         &raw->absolute_given},
        {"--hierarchy", NULL, PARIAN_OPTION_CHOICE, &raw->hierarchy, "WHEN",
         "Carry far light over a few coarse points instead of from each vertex to each: where that "
         "saves factors, always, or never (auto).",
         0, 0, "auto|on|off", NULL},
        PARIAN_FLAG_ROW("--force-local", &raw->force_local,
                        "Keep the local part whatever the plan says."),
        PARIAN_FLAG_ROW("--force-global", &raw->force_global,
                        "Keep the global part whatever the plan says."),
        PARIAN_FLAG_ROW("--no-local", &raw->no_local,
                        "Leave the local part out whatever the plan says."),
        PARIAN_FLAG_ROW("--no-global", &raw->no_global,
                        "Leave the global part out whatever the plan says."),
        {"--quality", NULL, PARIAN_OPTION_CHOICE, &raw->quality, "NAME",
         "Named settings; explicit options win. preview: 2500 vertices, atlas 256, threshold 0.01; "
         "medium: the defaults; production: 16000 vertices, atlas 1024, kernel 9 (medium).",
         0, 0, "preview|medium|production", &raw->quality_given},
        {"--report", NULL, PARIAN_OPTION_STRING, &raw->report, "FILE.json",
         "Write stages, seconds, memory, counts, sizes, repairs, the plan and its reasons.", 0, 0,
         NULL, NULL},
        PARIAN_FLAG_ROW("-MD", &raw->md,
                        "Write a dependency file OUT.parian.d for Make and Ninja."),
        {"-MF", NULL, PARIAN_OPTION_STRING, &raw->depfile, "FILE", "Name of the dependency file.",
         0, 0, NULL, NULL},
        {"--dump", NULL, PARIAN_OPTION_STRING, &raw->dump, "DIR",
         "Write every intermediate array as .npy and the atlas as PNG and EXR.", 0, 0, NULL, NULL},
        PARIAN_FLAG_ROW("--print-config", &options->print_config,
                        "Print the resolved settings as JSON and stop."),
        PARIAN_FLAG_ROW("--list-materials", &options->list_materials,
                        "Print the presets and stop."),
        {"--seed", NULL, PARIAN_OPTION_COUNT, &raw->seed, "N",
         "Seed of the stages that draw random numbers; none of them does at present (0).", 0,
         4294967295.0, NULL, NULL},
        PARIAN_LATER_ROW("--samples"),
        PARIAN_LATER_ROW("--max-error"),
    };
    const parian_command command = {.tool = "parian-bake",
                                    .usage = "INPUT -o OUT.parian [options]",
                                    .summary = SUMMARY,
                                    .epilogue = EPILOGUE,
                                    .options = table,
                                    .option_count = sizeof table / sizeof *table,
                                    .commands = COMMANDS,
                                    .command_count = sizeof COMMANDS / sizeof *COMMANDS};
    return parian_options_parse(&command, &options->common, inputs, argc, argv, 1);
}

static parian_result usage_error(const char *text)
{
    fprintf(stderr, "parian-bake: %s; see parian-bake --help\n", text);
    return PARIAN_E_ARGUMENT;
}

static parian_result check_options(const raw_options *raw, const parian_string_list *inputs)
{
    if (inputs->count != 1) {
        return usage_error(inputs->count ? "one INPUT expected, several given" : "no INPUT given");
    }
    if (!raw->output && !raw->dump && !raw->report) {
        return usage_error("no output: give -o OUT.parian");
    }
    if (raw->output && strcmp(raw->output, "-") == 0) {
        return usage_error("an asset is not written to stdout: give -o OUT.parian");
    }
    if (raw->kernel_given && raw->kernel % 2 == 0) {
        return usage_error("--kernel must be odd, 3 to 15");
    }
    if (raw->threshold_given && raw->absolute_given) {
        return usage_error("--threshold and --threshold-absolute exclude each other");
    }
    bool by_share = raw->form != PARIAN_FORM_PAPER && !raw->absolute_given && raw->threshold > 0;
    if (raw->hierarchy == PARIAN_HIERARCHY_ON && !by_share) {
        return usage_error("--hierarchy on takes --form parian and a --threshold above 0");
    }
    if (raw->scale_given && raw->unit_given) {
        return usage_error("--scale and --unit exclude each other");
    }
    if ((raw->force_local && raw->no_local) || (raw->force_global && raw->no_global)) {
        return usage_error("--force-... and --no-... of the same part exclude each other");
    }
    if (raw->no_local && raw->no_global) {
        return usage_error("--no-local and --no-global together leave nothing");
    }
    if ((raw->md || raw->depfile) && !raw->output) {
        return usage_error("-MD needs -o");
    }
    return PARIAN_OK;
}

/* Named qualities fill what was not given. */
static void apply_quality(raw_options *raw)
{
    static const struct {
        uint32_t vertices, atlas, kernel;
        double threshold;
    } named[] = {{2500, 256, 7, 0.01}, {10000, 512, 7, 0.002}, {16000, 1024, 9, 0.002}};
    int q = raw->quality_given ? raw->quality : 1;
    raw->vertices = raw->vertices_given ? raw->vertices : named[q].vertices;
    raw->atlas = raw->atlas_given ? raw->atlas : named[q].atlas;
    raw->kernel = raw->kernel_given ? raw->kernel : named[q].kernel;
    raw->threshold = raw->threshold_given ? raw->threshold : named[q].threshold;
    if (!raw->absolute_given) {
        raw->threshold_absolute =
            raw->form == PARIAN_FORM_PAPER && !raw->threshold_given ? 1e-5 : 0;
    }
}

static void fill_desc(const raw_options *raw, const char *input, parian_bake_options *options)
{
    static const double units[] = {1e-3, 1e-2, 1};
    parian_bake_desc *d = &options->desc;
    d->input = input;
    d->output = raw->output;
    d->material = options->materials.item;
    d->material_count = options->materials.count;
    d->scale_m = raw->scale_given ? raw->scale : 0;
    d->unit_m = raw->unit_given ? units[raw->unit] : 0;
    d->keep_origin = raw->keep_origin;
    d->bssrdf = (parian_bssrdf)raw->bssrdf;
    d->fit_fdr = raw->fdr == 1;
    d->form = (parian_form)raw->form;
    d->atlas_size = raw->atlas;
    d->kernel_width = raw->kernel;
    d->transfer_vertices = raw->vertices;
    d->local_form = LOCAL_FORMS[raw->local];
    /* The stage takes 0 for its default; a threshold of exactly 0 means nothing is dropped. */
    d->threshold = raw->threshold > 0 ? raw->threshold : -1;
    d->threshold_absolute = raw->threshold_absolute;
    d->hierarchy = (parian_hierarchy)raw->hierarchy;
    d->force_local = raw->force_local;
    d->force_global = raw->force_global;
    d->no_local = raw->no_local;
    d->no_global = raw->no_global;
    d->dump_folder = raw->dump;
    d->report_path = raw->report;
    if (raw->depfile) {
        d->depfile_path = raw->depfile;
    } else if (raw->md) {
        snprintf(options->depfile, sizeof options->depfile, "%s.d", raw->output);
        d->depfile_path = options->depfile;
    }
}

parian_result parian_bake_options_parse(int argc, char **argv, parian_bake_options *options)
{
    raw_options raw = {0};
    parian_string_list inputs = {0};
    parian_result r = parse_table(argc, argv, &raw, options, &inputs);
    if (r != PARIAN_OK || options->common.help || options->common.version) {
        return r;
    }
    apply_quality(&raw);
    if (!options->list_materials && !options->print_config) {
        r = check_options(&raw, &inputs);
    }
    if (r == PARIAN_OK) {
        fill_desc(&raw, inputs.count ? inputs.item[0] : NULL, options);
    }
    return r;
}
