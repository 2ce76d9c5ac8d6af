/* view_relay.c - an env between the session and the window.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_relay.h"

#include <stdio.h>
#include <string.h>

#include "core/memory.h"

static void *relay_alloc(void *user, size_t size)
{
    const parian_env *session = ((parian_view_relay *)user)->session;
    return parian_alloc(session, 1, size);
}

static void relay_free(void *user, void *ptr)
{
    parian_free(((parian_view_relay *)user)->session, ptr);
}

static void relay_log(void *user, parian_log_level level, const char *text)
{
    parian_view_relay *relay = user;
    pthread_mutex_lock(&relay->mutex);
    if (level <= PARIAN_LOG_WARNING) {
        snprintf(relay->line, sizeof relay->line, "%s", text);
        relay->line_count++;
    }
    if (level == PARIAN_LOG_ERROR && relay->soft) {
        level = PARIAN_LOG_WARNING;
    }
    pthread_mutex_unlock(&relay->mutex);
    parian_log(relay->session, level, "%s", text);
}

static void relay_par(void *user, size_t count, void (*body)(void *, size_t), void *context)
{
    parian_par(((parian_view_relay *)user)->session, count, body, context);
}

static void relay_progress(void *user, const char *stage, double fraction)
{
    parian_view_relay *relay = user;
    pthread_mutex_lock(&relay->mutex);
    snprintf(relay->stage, sizeof relay->stage, "%s", stage);
    relay->fraction = fraction;
    pthread_mutex_unlock(&relay->mutex);
    parian_progress(relay->session, stage, fraction);
}

static bool relay_cancelled(void *user)
{
    return parian_cancelled(((parian_view_relay *)user)->session);
}

void parian_view_relay_init(parian_view_relay *relay, const parian_env *session)
{
    *relay = (parian_view_relay){.session = session,
                                 .env = {.alloc = relay_alloc,
                                         .free = relay_free,
                                         .log = relay_log,
                                         .par = relay_par,
                                         .progress = relay_progress,
                                         .cancelled = relay_cancelled,
                                         .user = relay}};
    pthread_mutex_init(&relay->mutex, NULL);
}

void parian_view_relay_destroy(parian_view_relay *relay)
{
    pthread_mutex_destroy(&relay->mutex);
}

void parian_view_relay_set_soft(parian_view_relay *relay, bool soft)
{
    pthread_mutex_lock(&relay->mutex);
    relay->soft = soft;
    pthread_mutex_unlock(&relay->mutex);
}

unsigned parian_view_relay_line(parian_view_relay *relay, char line[PARIAN_VIEW_LINE_MAX])
{
    pthread_mutex_lock(&relay->mutex);
    memcpy(line, relay->line, sizeof relay->line);
    const unsigned count = relay->line_count;
    pthread_mutex_unlock(&relay->mutex);
    return count;
}

double parian_view_relay_progress(parian_view_relay *relay, char stage[PARIAN_VIEW_STAGE_MAX])
{
    pthread_mutex_lock(&relay->mutex);
    memcpy(stage, relay->stage, sizeof relay->stage);
    const double fraction = relay->fraction;
    pthread_mutex_unlock(&relay->mutex);
    return fraction;
}
