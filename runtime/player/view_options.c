/* view_options.c - the command line of parian-view.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/memory.h"
#include "view_sequence.h"

enum {
    SIZE_MAX_PIXELS = 16384,
    WINDOW_WIDTH = 1280,
    FRAMES_MAX = 1000000,
    REFINE_MAX = 4096,
    OPTION_MAX = 32
};
static const double EXPOSURE_LIMIT = 60, RADIANCE_LIMIT = 1e6, TINT_LIMIT = 10;

static size_t fill_table(parian_view_options *o, parian_option table[OPTION_MAX])
{
    const parian_option rows[] = {
        PARIAN_FLAG_ROW("--headless", &o->headless,
                        "Render without a window, through EGL; no display is needed."),
        PARIAN_FLAG_ROW("--cpu", &o->cpu,
                        "Evaluate in C instead of OpenGL; implies --headless and needs no EGL."),
        {"--size", NULL, PARIAN_OPTION_STRING, &o->size_text, "WxH",
         "Pixels of the picture (960x720) or window (1280x720: the panel takes 336).", 0, 0, NULL,
         NULL},
        {"--image", NULL, PARIAN_OPTION_STRING, &o->image, "FILE",
         "Write the picture: .png (tone-mapped sRGB) or .exr (linear radiance).", 0, 0, NULL, NULL},
        {"--light", NULL, PARIAN_OPTION_LIST, &o->lights, "SPEC",
         "Add a light, e.g. point:0,0.1,0.2:intensity=1 or directional:0,0,-1:irradiance=1; "
         "repeatable. "
         "(The asset's own lights, else a key light and one behind.)",
         0, 0, NULL, NULL},
        {"--lights", NULL, PARIAN_OPTION_STRING, &o->lights_file, "FILE.json",
         "Add the lights of a lights file.", 0, 0, NULL, NULL},
        {"--camera", NULL, PARIAN_OPTION_STRING, &o->camera, "CAMERA",
         "orbit:YAW,PITCH[,DIST] in degrees, DIST in bounding radii of the bodies or with a unit, "
         "or a JSON file with eye, target, up, fov_deg. (A view that shows all bodies.)",
         0, 0, NULL, NULL},
        {"--camera-path", NULL, PARIAN_OPTION_STRING, &o->camera_path, "FILE.json",
         "Render along keyframes of the camera, --frames of them or as many as the file says; "
         "--image names a sequence, e.g. out-%04d.png. Implies --headless.",
         0, 0, NULL, NULL},
        {"--turntable", NULL, PARIAN_OPTION_COUNT, &o->turntable, "N",
         "Render N frames of one turn about the bodies; --image names a sequence. Implies "
         "--headless.",
         1, FRAMES_MAX, NULL, NULL},
        {"--view", NULL, PARIAN_OPTION_STRING, &o->view_text, "VIEW",
         "combined, local, global, irradiance, radiosity, opaque, normals, charts, error, "
         "atlas-irradiance, atlas-radiosity or atlas-charts (combined); headless also several, "
         "with commas between: %s in --image is the view's name.",
         0, 0, NULL, NULL},
        {"--reference", NULL, PARIAN_OPTION_STRING, &o->reference, "TRUTH",
         "What the error view compares with: a folder of parian-bake reference or --dump, or a "
         "picture of the same size.",
         0, 0, NULL, NULL},
        {"--error-scale", NULL, PARIAN_OPTION_NUMBER, &o->error_scale, "X",
         "Error that is shown in full red or blue, over the mean of the reference (0.1).", 1e-6,
         1e6, NULL, NULL},
        {"--method", NULL, PARIAN_OPTION_STRING, &o->method_text, "NAME",
         "How B is computed: transfer (transfer).", 0, 0, NULL, NULL},
        {"--exposure", NULL, PARIAN_OPTION_STRING, &o->exposure_text, "EV|auto",
         "Scale the picture by 2^EV before the tone curve; auto: from its log-average luminance. "
         "(From the lights.)",
         0, 0, NULL, NULL},
        {"--tone", NULL, PARIAN_OPTION_CHOICE, &o->tone, "CURVE",
         "neutral, linear (clamped) or reinhard (neutral).", 0, 0, "neutral|linear|reinhard", NULL},
        {"--medium", NULL, PARIAN_OPTION_STRING, &o->medium, "NAME|FILE.json",
         "Show the bodies in another medium than they were baked of, and tell what could not "
         "follow; names as "
         "parian-bake --list-materials.",
         0, 0, NULL, NULL},
        {"--size-factor", NULL, PARIAN_OPTION_NUMBER, &o->size_factor, "X",
         "Show the bodies, and all around them, as if they were X times as large as they were "
         "baked (1).",
         1e-3, 1e3, NULL, NULL},
        {"--tint", NULL, PARIAN_OPTION_STRING, &o->tint_text, "R,G,B",
         "Colour the light that scatters out, with numbers of 0 to 10, apart from transfer.", 0, 0,
         NULL, NULL},
        {"--background", NULL, PARIAN_OPTION_STRING, &o->background_text, "R,G,B",
         "Radiance behind everything (a dim grey in proportion to the lights; 0,0,0 for .exr).", 0,
         0, NULL, NULL},
        {"--roughness", NULL, PARIAN_OPTION_NUMBER, &o->roughness, "X",
         "Roughness of the surface reflection, 0.05 to 1 (0.35).", 0.05, 1, NULL, NULL},
        PARIAN_FLAG_ROW("--no-specular", &o->no_specular, "Leave the surface reflection out."),
        {"--frames", NULL, PARIAN_OPTION_COUNT, &o->frames, "N",
         "Frames to render, each with a full relight (1; 11 with --timings); a window closes after "
         "them.",
         1, FRAMES_MAX, NULL, NULL},
        {"--refine", NULL, PARIAN_OPTION_COUNT, &o->refine, "N",
         "Light with the mean of N sets of samples: softer, more exact shadows at N times the work "
         "(1; a window refines up to 64 by itself while nothing moves). Needs --headless or --cpu.",
         1, REFINE_MAX, NULL, NULL},
        {"--dump", NULL, PARIAN_OPTION_STRING, &o->dump, "DIR",
         "Write per-texel arrays as .npy: position, normal, area, irradiance, radiosity and its "
         "parts.",
         0, 0, NULL, NULL},
        {"--timings", NULL, PARIAN_OPTION_STRING, &o->timings, "FILE.json",
         "Write the median time of each pass over the frames.", 0, 0, NULL, NULL},
        {"--gl", NULL, PARIAN_OPTION_CHOICE, &o->gl, "API",
         "any, core (OpenGL 3.3 core) or es (OpenGL ES 3.0) (any: core if there is one).", 0, 0,
         "any|core|es", NULL},
    };
    memcpy(table, rows, sizeof rows);
    return sizeof rows / sizeof rows[0];
}

static const char *const epilogue =
    "Examples:\n"
    "  parian-view figurine.parian\n"
    "  parian-view figurine.parian --headless --image figurine.png \\\n"
    "      --light point:-0.1,0.1,-0.1:intensity=0.05 --camera orbit:30,10\n"
    "\n"
    "In the window: left mouse orbits, middle or Shift pans, wheel zooms, right mouse\n"
    "or L moves the light; H lists the keys.\n";

parian_result parian_view_options_parse(int argc, char **argv, parian_view_options *options)
{
    parian_option table[OPTION_MAX];
    parian_string_list positional = {.count = 0};
    *options = (parian_view_options){.width = 960,
                                     .height = 720,
                                     .error_scale = 0.1,
                                     .exposure_auto = true,
                                     .background = {-1, -1, -1}};
    const parian_command command = {
        .tool = "parian-view",
        .usage = "ASSET.parian [options]",
        .summary = "Relights and draws a translucent asset, in a window or headless.",
        .epilogue = epilogue,
        .options = table,
        .option_count = fill_table(options, table)};
    parian_result result =
        parian_options_parse(&command, &options->common, &positional, argc, argv, 1);
    if (result != PARIAN_OK || options->common.help || options->common.version) {
        return result;
    }
    if (positional.count != 1) {
        fprintf(stderr, "parian-view: error: %s (see parian-view --help)\n",
                positional.count ? "more than one asset" : "no asset given");
        return PARIAN_E_ARGUMENT;
    }
    options->asset = positional.item[0];
    options->headless =
        options->headless || options->cpu || options->turntable || options->camera_path;
    return PARIAN_OK;
}

bool parian_view_path_ends(const char *path, const char *ending)
{
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

static parian_result check_size(const parian_env *env, parian_view_options *o)
{
    unsigned width, height;
    char rest;
    if (!o->size_text) {
        o->width = o->headless || o->frames ? o->width : WINDOW_WIDTH;
        return PARIAN_OK;
    }
    if (strspn(o->size_text, "0123456789x") != strlen(o->size_text) || strlen(o->size_text) > 11 ||
        sscanf(o->size_text, "%ux%u%c", &width, &height, &rest) != 2 || width < 1 || height < 1 ||
        width > SIZE_MAX_PIXELS || height > SIZE_MAX_PIXELS) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "--size: '%s' is not WxH with sides of 1 to %d pixels", o->size_text,
                           SIZE_MAX_PIXELS);
    }
    o->width = width;
    o->height = height;
    return PARIAN_OK;
}

static parian_result check_exposure(const parian_env *env, parian_view_options *o)
{
    char *end;
    if (!o->exposure_text || strcmp(o->exposure_text, "auto") == 0) {
        o->exposure_auto = o->exposure_text != NULL;
        return PARIAN_OK;
    }
    double ev = strtod(o->exposure_text, &end);
    if (end == o->exposure_text || *end != '\0' || !(fabs(ev) <= EXPOSURE_LIMIT)) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "--exposure: '%s' is neither 'auto' nor a number of -%g to %g",
                           o->exposure_text, EXPOSURE_LIMIT, EXPOSURE_LIMIT);
    }
    o->exposure_ev = ev;
    return PARIAN_OK;
}

static parian_result read_color(const parian_env *env, const char *option, const char *text,
                                double most, double color[3])
{
    const char *at = text;
    for (int c = 0; at && c < 3; c++) {
        char *end;
        double value = strtod(at, &end);
        if (end == at || !(value >= 0 && value <= most) || *end != (c < 2 ? ',' : '\0')) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "%s: '%s' is not R,G,B with numbers of 0 to %g", option, text, most);
        }
        color[c] = value;
        at = end + 1;
    }
    return PARIAN_OK;
}

static parian_result check_tint(const parian_env *env, parian_view_options *o)
{
    parian_result result = read_color(env, "--tint", o->tint_text, TINT_LIMIT, o->tint);
    if (result == PARIAN_OK && o->tint_text && o->tint[0] + o->tint[1] + o->tint[2] == 0) {
        result =
            parian_fail(env, PARIAN_E_ARGUMENT, "--tint: '%s' leaves nothing to see", o->tint_text);
    }
    return result;
}

static parian_result check_method(const parian_env *env, const parian_view_options *o)
{
    static const char *const later[] = {"texture", "volume", "maps"};
    const char *text = o->method_text;
    if (!text) {
        return PARIAN_OK;
    }
    size_t length = strcspn(text, ":");
    if (length == strlen("transfer") && strncmp(text, "transfer", length) == 0) {
        return text[length] == '\0'
                   ? PARIAN_OK
                   : parian_fail(env, PARIAN_E_ARGUMENT, "--method: transfer has no setting '%s'",
                                 text + length + 1);
    }
    for (size_t i = 0; i < sizeof later / sizeof later[0]; i++) {
        if (strlen(later[i]) == length && strncmp(text, later[i], length) == 0) {
            return parian_fail(env, PARIAN_E_UNSUPPORTED,
                               "--method: '%s' is not supported by this version", later[i]);
        }
    }
    return parian_fail(env, PARIAN_E_ARGUMENT, "--method: '%.*s' is unknown; transfer was expected",
                       (int)length, text);
}

static parian_result check_views(const parian_env *env, parian_view_options *o)
{
    const char *unknown = NULL;
    o->display_count =
        parian_view_display_parse(o->view_text ? o->view_text : "combined", o->displays, &unknown);
    if (!o->display_count) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "--view: '%.*s' is unknown, or one too many",
                           (int)strcspn(unknown, ","), unknown);
    }
    if (o->display_count > 1 && !o->headless) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "several views need --headless or --cpu");
    }
    for (size_t i = 0; i < o->display_count; i++) {
        if (o->displays[i] == PARIAN_DISPLAY_ERROR && !o->reference) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "--view error needs a --reference");
        }
    }
    return PARIAN_OK;
}

static parian_result check_image(const parian_env *env, const parian_view_options *o)
{
    if (o->image && strcmp(o->image, "-") != 0 && !parian_view_path_ends(o->image, ".png") &&
        !parian_view_path_ends(o->image, ".exr")) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "--image: '%s' ends in neither .png nor .exr",
                           o->image);
    }
    return parian_view_sequence_check(env, o);
}

parian_result parian_view_options_check(const parian_env *env, parian_view_options *options)
{
    parian_result result = check_size(env, options);
    if (result == PARIAN_OK && options->timings && !options->headless) {
        result = parian_fail(env, PARIAN_E_ARGUMENT, "--timings needs --headless or --cpu");
    }
    if (result == PARIAN_OK && options->refine && !options->headless) {
        result = parian_fail(env, PARIAN_E_ARGUMENT, "--refine needs --headless or --cpu");
    }
    if (result == PARIAN_OK) {
        result = check_exposure(env, options);
    }
    if (result == PARIAN_OK) {
        result = read_color(env, "--background", options->background_text, RADIANCE_LIMIT,
                            options->background);
    }
    if (result == PARIAN_OK) {
        result = check_tint(env, options);
    }
    if (result == PARIAN_OK) {
        result = check_method(env, options);
    }
    if (result == PARIAN_OK) {
        result = check_views(env, options);
    }
    return result == PARIAN_OK ? check_image(env, options) : result;
}
