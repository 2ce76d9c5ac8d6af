/* view_loader.c - opens an asset in a thread of its own; tells when a file on disk has changed.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_loader.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "core/memory.h"

/* ---- loading -----------------------------------------------------------------------------------
 */
static void *load(void *argument)
{
    parian_view_loader *loader = argument;
    loader->scene = NULL;
    loader->result = parian_scene_open(loader->env, loader->path, &loader->scene);
    atomic_store(&loader->done, true);
    return NULL;
}

parian_result parian_view_loader_begin(parian_view_loader *loader, const parian_env *env,
                                       const char *path)
{
    parian_view_loader_stop(loader);
    if (strlen(path) >= sizeof loader->path) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "a path of %zu bytes, at most %d were expected",
                           strlen(path), PARIAN_VIEW_PATH_MAX - 1);
    }
    memmove(loader->path, path, strlen(path) + 1);
    loader->env = env;
    atomic_store(&loader->done, false);
    if (pthread_create(&loader->thread, NULL, load, loader) != 0) {
        return parian_fail(env, PARIAN_E_NOMEM, "no thread to open %s in", path);
    }
    loader->busy = true;
    return PARIAN_OK;
}

bool parian_view_loader_take(parian_view_loader *loader, parian_result *result,
                             parian_scene **scene)
{
    if (!loader->busy || !atomic_load(&loader->done)) {
        return false;
    }
    pthread_join(loader->thread, NULL);
    loader->busy = false;
    *result = loader->result;
    *scene = loader->scene;
    return true;
}

void parian_view_loader_stop(parian_view_loader *loader)
{
    if (loader->busy) {
        pthread_join(loader->thread, NULL);
        loader->busy = false;
        if (loader->result == PARIAN_OK) {
            parian_scene_close(loader->scene);
        }
    }
}

/* ---- watching ----------------------------------------------------------------------------------
 */
static parian_view_stamp look(const char *path)
{
    struct stat found;
    if (stat(path, &found) != 0) {
        return (parian_view_stamp){.size = -1};
    }
    return (parian_view_stamp){.seconds = found.st_mtim.tv_sec,
                               .nanoseconds = found.st_mtim.tv_nsec,
                               .size = found.st_size,
                               .inode = (int64_t)found.st_ino};
}

static bool same(const parian_view_stamp *a, const parian_view_stamp *b)
{
    return a->seconds == b->seconds && a->nanoseconds == b->nanoseconds && a->size == b->size &&
           a->inode == b->inode;
}

void parian_view_watch_begin(parian_view_watch *watch, const char *path)
{
    watch->known = watch->last = look(path);
}

bool parian_view_watch_changed(parian_view_watch *watch, const char *path)
{
    const parian_view_stamp now = look(path);
    const bool settled = same(&now, &watch->last);
    watch->last = now;
    if (now.size < 0 || !settled || same(&now, &watch->known)) {
        return false;
    }
    watch->known = now;
    return true;
}
