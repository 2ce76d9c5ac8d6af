/* progress.h - a progress bar on a terminal, or progress as JSON lines, on stderr.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_PROGRESS_H
#define PARIAN_TOOL_PROGRESS_H

#include <stdbool.h>

enum { PARIAN_STAGE_NAME_MAX = 48 };

typedef enum parian_progress_mode {
    PARIAN_PROGRESS_AUTO = 0, /* a bar on a terminal, else nothing */
    PARIAN_PROGRESS_BAR = 1,
    PARIAN_PROGRESS_JSON = 2, /* {"stage":"global","fraction":0.42,"seconds":1.2} a line */
    PARIAN_PROGRESS_NONE = 3
} parian_progress_mode;

/* State of one display; zeroed with a mode other than AUTO is ready. One thread at a time. */
typedef struct parian_progress_display {
    parian_progress_mode mode;
    bool drawn; /* a bar stands on the current line */
    char stage[PARIAN_STAGE_NAME_MAX];
    double run_start, stage_start, last_draw; /* seconds; run_start 0 means not begun */
} parian_progress_display;

/* Show the stage and how far it is; draws at most ten times a second, and at changes of stage. */
void parian_progress_show(parian_progress_display *display, const char *stage, double fraction);
/* Remove the bar from the terminal. */
void parian_progress_clear(parian_progress_display *display);

#endif
