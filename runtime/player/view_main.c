/* view_main.c - parian-view: relights and draws an asset, in a window or headless.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/session.h"
#include "view_headless.h"
#include "view_window.h"

static parian_result view(parian_session *session, parian_view_options *options)
{
    parian_view_app app = {.env = parian_session_env(session), .options = options};
    parian_result result = parian_view_options_check(app.env, options);
    if (result == PARIAN_OK) {
        result = options->headless ? parian_view_run_headless(&app) : parian_view_run_window(&app);
    }
    parian_view_app_close(&app);
    return result;
}

int main(int argc, char **argv)
{
    parian_view_options options;
    parian_session *session;
    parian_result result = parian_view_options_parse(argc, argv, &options);
    if (result != PARIAN_OK || options.common.help || options.common.version) {
        return parian_result_exit_status(result);
    }
    result = parian_session_create("parian-view", &options.common, &session);
    if (result != PARIAN_OK) {
        return parian_result_exit_status(result);
    }
    int status = parian_session_exit(session, view(session, &options));
    parian_session_destroy(session);
    return status;
}
