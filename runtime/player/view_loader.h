/* view_loader.h - opens an asset in a thread of its own, so that the window stays alive; and tells
 * when a file on disk has changed.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_LOADER_H
#define PARIAN_VIEW_LOADER_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>

#include "parian/runtime.h"

enum { PARIAN_VIEW_PATH_MAX = 4096 };

typedef struct parian_view_loader {
    const parian_env *env;
    char path[PARIAN_VIEW_PATH_MAX];
    bool busy;
    pthread_t thread;
    atomic_bool done; /* of the thread: what follows is set */
    parian_result result;
    parian_scene *scene;
} parian_view_loader;

/* Begin to open the asset; env serves the scene too. Errors: PARIAN_E_ARGUMENT (too long a path),
 * PARIAN_E_NOMEM (no thread). */
parian_result parian_view_loader_begin(parian_view_loader *loader, const parian_env *env,
                                       const char *path);
/* True once for each begun load, when it is done: the result of opening, and the scene, which is
 * the caller's. */
bool parian_view_loader_take(parian_view_loader *loader, parian_result *result,
                             parian_scene **scene);
/* Wait for a load that runs, and drop what it opened. */
void parian_view_loader_stop(parian_view_loader *loader);

/* A file as it was when it was last looked at. */
typedef struct parian_view_stamp {
    int64_t seconds, nanoseconds, size, inode; /* size -1: there was no file */
} parian_view_stamp;
typedef struct parian_view_watch {
    parian_view_stamp known, last; /* what was loaded; what was found at the last look */
} parian_view_watch;

/* Take the file as it is now for the one that is known. */
void parian_view_watch_begin(parian_view_watch *watch, const char *path);
/* True when the file differs from the known one and from none found at the last look: it is there,
 * and whoever wrote it is done. The new state is then the known one. To be asked each half second.
 */
bool parian_view_watch_changed(parian_view_watch *watch, const char *path);

#endif
