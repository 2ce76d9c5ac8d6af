/* main.c - parian-bake: from a model and a medium to an asset.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "bake/cli/bake_options.h"
#include "bake/cli/reference_command.h"
#include "tool/media_file.h"
#include "tool/session.h"

static int list_materials(void)
{
    printf("%-22s %-29s %-29s %5s  %s\n", "name", "sigma_s' R G B (1/mm)", "sigma_a R G B (1/mm)",
           "eta", "source");
    for (uint32_t i = 0; i < parian_media_preset_count(); i++) {
        const parian_medium *m = parian_media_preset(i);
        printf("%-22s", m->name);
        for (int c = 0; c < 3; c++) {
            printf(" %9.5g", m->sigma_s_prime[c] * 1e-3);
        }
        for (int c = 0; c < 3; c++) {
            printf(" %9.5g", m->sigma_a[c] * 1e-3);
        }
        printf(" %5.3g  %s\n", m->eta, m->source);
    }
    return fflush(stdout) == 0 ? 0 : 2;
}

static int print_config(const parian_bake_desc *desc)
{
    char *text = parian_settings_json(desc);
    if (!text) {
        fprintf(stderr, "parian-bake: out of memory\n");
        return 4;
    }
    puts(text);
    cJSON_free(text);
    return fflush(stdout) == 0 ? 0 : 2;
}

static int run_bake(parian_bake_options *options)
{
    parian_session *session = NULL;
    parian_result r = parian_session_create("parian-bake", &options->common, &session);
    if (r != PARIAN_OK) {
        fprintf(stderr, "parian-bake: %s\n", parian_result_text(r));
        return parian_result_exit_status(r);
    }
    r = parian_bake_run(parian_session_env(session), &options->desc);
    parian_session_end_progress(session);
    int status = parian_session_exit(session, r);
    parian_session_destroy(session);
    return status;
}

int main(int argc, char **argv)
{
    static parian_bake_options options;
    if (argc > 1 && strcmp(argv[1], "reference") == 0) {
        return parian_reference_command(argc, argv);
    }
    parian_result r = parian_bake_options_parse(argc, argv, &options);
    if (r != PARIAN_OK) {
        return parian_result_exit_status(r);
    }
    if (options.common.help || options.common.version) {
        return EXIT_SUCCESS;
    }
    if (options.list_materials) {
        return list_materials();
    }
    return options.print_config ? print_config(&options.desc) : run_bake(&options);
}
