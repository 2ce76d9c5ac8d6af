/* session.h - a tool's surroundings: threads, log to stderr, progress bar, Ctrl-C.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_SESSION_H
#define PARIAN_TOOL_SESSION_H

#include "parian/env.h"
#include "tool/options.h"

/* One per process. The env in it logs to stderr ("parian-bake: warning: ..."), runs par on a thread
 * pool, draws progress, and reports cancelled after SIGINT or SIGTERM: a run then unwinds and
 * removes what it had begun to write. A second signal ends the process at once, after unlinking the
 * temporary files that were registered (files.h).
 *
 * Error lines are held back: parian_session_exit prints the first one of a failed run and nothing
 * of one that went well after all, so that a failed run has exactly one. With -v the later ones are
 * shown too. */
typedef struct parian_session parian_session;

/* Errors: PARIAN_E_NOMEM (said on stderr). */
parian_result parian_session_create(const char *tool, const parian_common_options *common,
                                    parian_session **session);
void parian_session_destroy(parian_session *session);
const parian_env *parian_session_env(parian_session *session);

/* Clear the progress line, if one is drawn. */
void parian_session_end_progress(parian_session *session);

/* Print the one line of a failed run and return the exit status; nothing is printed for PARIAN_OK.
 * May be called for each of several files: it forgets the line it printed. */
int parian_session_exit(parian_session *session, parian_result result);

/* Warnings logged so far, for reports: count and text of each (lives with the session). */
size_t parian_session_warning_count(const parian_session *session);
const char *parian_session_warning(const parian_session *session, size_t index);

/* Seconds on a monotonic clock. Peak resident memory of the process in bytes. */
double parian_seconds(void);
unsigned long long parian_peak_memory(void);

#endif
