/* measure_main.c - parian-measure: methods and settings against ground truth.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "tests/measure/hard_cases.h"
#include "tests/measure/measure_run.h"
#include "tool/session.h"

/* Until there is a session, the one line of a mistake goes to stderr from here. */
static void print_mistake(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        fprintf(stderr, "parian-measure: error: %s\n", text);
    }
}

/* The command as it could be typed again; free with parian_free. */
static char *join_command(int argc, char **argv)
{
    parian_text text = {.env = NULL};
    parian_text_add(&text, "parian-measure");
    for (int i = 1; i < argc; i++) {
        bool plain = argv[i][0] && !strpbrk(argv[i], " \t\n'\"$\\*?;&|<>()");
        parian_text_add(&text, plain ? " %s" : " '%s'", argv[i]);
    }
    return text.text;
}

/* What is to be measured: an asset as it is, a model with each bake. */
static parian_result plan_assets(const parian_env *env, const parian_measure_options *o,
                                 parian_baked_asset *asset, size_t *count)
{
    parian_result r = PARIAN_OK;
    *count = 0;
    for (size_t i = 0; r == PARIAN_OK && i < o->inputs.count; i++) {
        size_t bakes =
            parian_path_is_asset(o->inputs.item[i]) || o->bakes.count == 0 ? 1 : o->bakes.count;
        for (size_t k = 0; r == PARIAN_OK && k < bakes; k++) {
            const char *bake = parian_path_is_asset(o->inputs.item[i]) || o->bakes.count == 0
                                   ? ""
                                   : o->bakes.item[k];
            if (*count == PARIAN_ASSETS_MAX) {
                return parian_fail(env, PARIAN_E_ARGUMENT, "more than %d assets",
                                   PARIAN_ASSETS_MAX);
            }
            r = parian_baked_asset_plan(env, o, o->inputs.item[i], bake, &asset[(*count)++]);
        }
    }
    return r;
}

static int run(const parian_measure_options *options, parian_baked_asset *asset, size_t count,
               const char *command)
{
    parian_session *session = NULL;
    parian_result r = parian_session_create("parian-measure", &options->common, &session);
    if (r != PARIAN_OK) {
        return parian_result_exit_status(r);
    }
    r = parian_measure_run_all(parian_session_env(session), options, asset, count, command);
    int status = parian_session_exit(session, r);
    parian_session_destroy(session);
    return status;
}

static int measure(int argc, char **argv)
{
    static parian_measure_options options;
    static parian_baked_asset asset[PARIAN_ASSETS_MAX];
    const parian_env env = {.log = print_mistake};
    size_t count = 0;
    parian_result r = parian_measure_options_parse(argc, argv, &options);
    if (r != PARIAN_OK || options.common.help || options.common.version) {
        return parian_result_exit_status(r);
    }
    r = plan_assets(&env, &options, asset, &count);
    int status = parian_result_exit_status(r);
    if (r == PARIAN_OK) {
        char *command = join_command(argc, argv);
        status = run(&options, asset, count, command ? command : "");
        parian_free(NULL, command);
    }
    for (size_t i = 0; i < count; i++) {
        parian_baked_asset_free(&env, &asset[i]);
    }
    return status;
}

static int hard_cases(int argc, char **argv)
{
    parian_hard_options options = {0};
    parian_result r = parian_hard_options_parse(argc, argv, &options);
    if (r != PARIAN_OK || options.common.help || options.common.version) {
        return parian_result_exit_status(r);
    }
    if (options.list) {
        return parian_hard_cases_list();
    }
    parian_session *session = NULL;
    r = parian_session_create("parian-measure", &options.common, &session);
    if (r != PARIAN_OK) {
        return parian_result_exit_status(r);
    }
    r = parian_hard_cases_run(parian_session_env(session), options.output, options.cases);
    int status = parian_session_exit(session, r);
    parian_session_destroy(session);
    return status;
}

int main(int argc, char **argv)
{
    return argc > 1 && strcmp(argv[1], "hard-cases") == 0 ? hard_cases(argc, argv)
                                                          : measure(argc, argv);
}
