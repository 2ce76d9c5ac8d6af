/* view_relay.h - an env between the session and the window: the window shows what is loading and
 * the last line, and a failure that does not end the program is a warning.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_RELAY_H
#define PARIAN_VIEW_RELAY_H

#include <pthread.h>

#include "parian/env.h"

enum { PARIAN_VIEW_LINE_MAX = 400, PARIAN_VIEW_STAGE_MAX = 48 };

typedef struct parian_view_relay {
    parian_env env; /* to be used; everything goes on to the session's */
    const parian_env *session;
    pthread_mutex_t mutex;           /* the rest */
    char line[PARIAN_VIEW_LINE_MAX]; /* the last error or warning */
    unsigned line_count;             /* lines so far: tells a new one */
    char stage[PARIAN_VIEW_STAGE_MAX];
    double fraction;
    bool soft; /* errors are warnings */
} parian_view_relay;

/* The relay stays where it is until everything made with its env is gone. */
void parian_view_relay_init(parian_view_relay *relay, const parian_env *session);
void parian_view_relay_destroy(parian_view_relay *relay);

/* Whether errors from now on are warnings: nothing of what follows ends the program. */
void parian_view_relay_set_soft(parian_view_relay *relay, bool soft);

/* Copies, for any thread; line is empty and the count 0 before the first one. */
unsigned parian_view_relay_line(parian_view_relay *relay, char line[PARIAN_VIEW_LINE_MAX]);
double parian_view_relay_progress(parian_view_relay *relay, char stage[PARIAN_VIEW_STAGE_MAX]);

#endif
