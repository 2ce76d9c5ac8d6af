/* progress.c - a progress bar on a terminal, or progress as JSON lines, on stderr.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/progress.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tool/session.h"

enum { BAR_WIDTH = 30 };
static const double DRAW_INTERVAL_S = 0.1;
static const double ESTIMATE_AFTER_S = 0.5; /* a guess from less is noise */

/* "12 s" or "3 min 05 s" until the stage ends, as far as its pace so far tells. */
static void write_estimate(char *text, size_t size, double elapsed, double fraction)
{
    text[0] = '\0';
    if (elapsed < ESTIMATE_AFTER_S || fraction <= 0.01 || fraction >= 1) {
        return;
    }
    double left = ceil(elapsed * (1 - fraction) / fraction);
    if (left < 60) {
        snprintf(text, size, "  %.0f s left", left);
    } else {
        snprintf(text, size, "  %.0f min %02.0f s left", floor(left / 60), fmod(left, 60));
    }
}

static void draw_bar(parian_progress_display *display, double fraction, double now)
{
    char bar[BAR_WIDTH + 1], estimate[48];
    int filled = (int)(fraction * BAR_WIDTH + 0.5);
    for (int i = 0; i < BAR_WIDTH; i++) {
        bar[i] = i < filled ? '#' : '.';
    }
    bar[BAR_WIDTH] = '\0';
    write_estimate(estimate, sizeof estimate, now - display->stage_start, fraction);
    fprintf(stderr, "\r\033[K%-16.16s [%s] %3.0f %%%s", display->stage, bar, floor(fraction * 100),
            estimate);
    fflush(stderr);
    display->drawn = true;
}

static void print_json(const parian_progress_display *display, double fraction, double now)
{
    fprintf(stderr, "{\"stage\":\"%s\",\"fraction\":%.3f,\"seconds\":%.3f}\n", display->stage,
            fraction, now - display->run_start);
    fflush(stderr);
}

/* Stage names are our own short words; anything that JSON or a terminal would mind is left out. */
static void copy_stage(char *to, const char *stage)
{
    size_t length = 0;
    for (; *stage && length + 1 < PARIAN_STAGE_NAME_MAX; stage++) {
        if ((unsigned char)*stage >= 0x20 && *stage != '"' && *stage != '\\' && *stage != 0x7f) {
            to[length++] = *stage;
        }
    }
    to[length] = '\0';
}

void parian_progress_show(parian_progress_display *display, const char *stage, double fraction)
{
    char name[PARIAN_STAGE_NAME_MAX];
    if (display->mode != PARIAN_PROGRESS_BAR && display->mode != PARIAN_PROGRESS_JSON) {
        return;
    }
    double now = parian_seconds();
    copy_stage(name, stage);
    bool new_stage = display->run_start <= 0 || strcmp(name, display->stage) != 0;
    fraction = fraction > 0 ? (fraction < 1 ? fraction : 1) : 0;
    if (!new_stage && now - display->last_draw < DRAW_INTERVAL_S && fraction < 1) {
        return;
    }
    display->run_start = display->run_start > 0 ? display->run_start : now;
    display->last_draw = now;
    if (new_stage) {
        display->stage_start = now;
        memcpy(display->stage, name, sizeof name);
    }
    if (display->mode == PARIAN_PROGRESS_BAR) {
        draw_bar(display, fraction, now);
    } else {
        print_json(display, fraction, now);
    }
}

void parian_progress_clear(parian_progress_display *display)
{
    if (display->drawn) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
        display->drawn = false;
    }
}
