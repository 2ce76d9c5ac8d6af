/* models_main.c - parian-models: writes the example models, a slide, and damaged files for tests.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "models.h"
#include "slide.h"
#include "tool/files.h"
#include "tool/session.h"

typedef struct models_options {
    const char *folder, *slide, *nasty;
    uint32_t triangle_count;
    bool list;
    parian_common_options common;
    parian_string_list names;
} models_options;

static const model_entry *find_model(const char *name)
{
    for (uint32_t i = 0; i < model_count; i++) {
        if (strcmp(model_table[i].name, name) == 0) {
            return &model_table[i];
        }
    }
    return NULL;
}

static parian_result usage_error(const char *text, const char *what)
{
    fprintf(stderr, "parian-models: %s%s; see parian-models --help\n", text, what);
    return PARIAN_E_ARGUMENT;
}

static parian_result parse(models_options *options, int argc, char **argv)
{
    const parian_option table[] = {
        {.name = "-o",
         .kind = PARIAN_OPTION_STRING,
         .value = &options->folder,
         .argument = "DIR",
         .help = "The folder that NAME.glb is written to; created where it is missing."},
        {.name = "--triangles",
         .kind = PARIAN_OPTION_COUNT,
         .value = &options->triangle_count,
         .argument = "N",
         .help = "About this many triangles in the body (each model has its own default).",
         .minimum = 1000,
         .maximum = 4000000},
        {.name = "--slide",
         .kind = PARIAN_OPTION_STRING,
         .value = &options->slide,
         .argument = "FILE.png",
         .help = "Write a picture of 8 x 8 checks for a projecting light."},
        {.name = "--nasty",
         .kind = PARIAN_OPTION_STRING,
         .value = &options->nasty,
         .argument = "DIR",
         .help = "Write small damaged model files."},
        {.name = "--list",
         .kind = PARIAN_OPTION_FLAG,
         .value = &options->list,
         .help = "Print the names of the models and what they are."},
    };
    const parian_command command = {
        .tool = "parian-models",
        .usage = "-o DIR [NAME...] | --slide FILE.png | --nasty DIR | --list",
        .summary = "Generates Parian's example models: closed, manifold meshes in metres with "
                   "their media\n"
                   "and lights as glTF extensions. Without a NAME, all of them.",
        .options = table,
        .option_count = sizeof table / sizeof table[0]};
    parian_result result =
        parian_options_parse(&command, &options->common, &options->names, argc, argv, 1);
    if (result != PARIAN_OK || options->common.help || options->common.version) {
        return result;
    }
    if (!options->folder && !options->slide && !options->nasty && !options->list) {
        return usage_error("nothing to do: give -o DIR, --slide, --nasty or --list", "");
    }
    for (size_t i = 0; i < options->names.count; i++) {
        if (!find_model(options->names.item[i])) {
            return usage_error("no model is called ", options->names.item[i]);
        }
    }
    return PARIAN_OK;
}

static parian_result write_models(const parian_env *env, const models_options *options)
{
    const size_t count = options->names.count ? options->names.count : model_count;
    parian_result result = parian_folder_create(env, options->folder);
    for (size_t i = 0; result == PARIAN_OK && i < count; i++) {
        const model_entry *entry =
            options->names.count ? find_model(options->names.item[i]) : &model_table[i];
        result = parian_cancelled(env)
                     ? PARIAN_E_INTERRUPTED
                     : model_write(env, entry, options->triangle_count, options->folder);
    }
    return result;
}

static parian_result run(const parian_env *env, const models_options *options)
{
    parian_result result = PARIAN_OK;
    for (uint32_t i = 0; options->list && i < model_count; i++) {
        printf("%-10s %s\n", model_table[i].name, model_table[i].summary);
    }
    if (options->slide) {
        result = slide_write(env, options->slide);
    }
    if (result == PARIAN_OK && options->nasty) {
        result = parian_folder_create(env, options->nasty);
        result = result == PARIAN_OK ? nasty_write(env, options->nasty) : result;
    }
    return result == PARIAN_OK && options->folder ? write_models(env, options) : result;
}

int main(int argc, char **argv)
{
    static models_options options;
    parian_session *session = NULL;
    parian_result result = parse(&options, argc, argv);
    if (result != PARIAN_OK || options.common.help || options.common.version) {
        return parian_result_exit_status(result);
    }
    result = parian_session_create("parian-models", &options.common, &session);
    if (result != PARIAN_OK) {
        fprintf(stderr, "parian-models: %s\n", parian_result_text(result));
        return parian_result_exit_status(result);
    }
    int status = parian_session_exit(session, run(parian_session_env(session), &options));
    parian_session_destroy(session);
    return status;
}
