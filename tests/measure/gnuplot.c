/* gnuplot.c - runs gnuplot on a script, without a shell.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/memory.h"
#include "tool/files.h"

extern char **environ;

enum { MESSAGE_MAX = 512, NAME_MAX_BYTES = 200, BASE_MAX = 64 };

parian_result parian_gnuplot_check_name(const parian_env *env, const char *name)
{
    size_t length = name ? strlen(name) : 0;
    bool sound = length > 0 && length <= NAME_MAX_BYTES;
    for (size_t i = 0; i < length; i++) {
        sound = sound && name[i] != '/' && (unsigned char)name[i] >= 0x20 && name[i] != 0x7f;
    }
    return sound ? PARIAN_OK
                 : parian_fail(env, PARIAN_E_ARGUMENT,
                               "a picture cannot have this name; expected 1 to %d bytes without "
                               "'/' and control "
                               "characters",
                               NAME_MAX_BYTES);
}

void parian_gnuplot_begin(parian_chart_text *script, const char *name)
{
    parian_chart_text_put(
        script,
        "# Draws the SVG and the PNG of this name: run gnuplot on this file in its folder.\n"
        "if (!exists('base')) base = './'.");
    parian_chart_text_put_quoted(script, name, NAME_MAX_BYTES);
    parian_chart_text_put(script, "\ndata = './'.");
    parian_chart_text_put_quoted(script, name, NAME_MAX_BYTES);
    parian_chart_text_put(
        script, ".'.dat'\n"
                "set encoding utf8\n"
                "set termoption noenhanced\n"
                "set border lc rgb '#606060'\n"
                "set tics textcolor rgb '#202020' scale 0.6,0.3\n"
                "set grid xtics ytics mxtics mytics lt 1 lc rgb '#d4d4d4' lw 1, lt 1 lc rgb "
                "'#eeeeee' lw 0.6\n");
}

void parian_gnuplot_finish(parian_chart_text *script, int width, int height, const char *plot)
{
    static const char *const kind[2][2] = {{"pngcairo", "png"}, {"svg dynamic", "svg"}};
    for (int i = 0; i < 2; i++) {
        parian_chart_text_put(
            script,
            "set terminal %s noenhanced size %d,%d font 'Sans,11' background rgb 'white'\n"
            "set output base.'.%s'\n%s\n",
            kind[i][0], width, height, kind[i][1], plot);
    }
    parian_chart_text_put(script, "unset output\n");
}

/* ---- the process -------------------------------------------------------------------------------
 */
/* Read a pipe to its end and keep the last line: gnuplot says there what is wrong, below the place.
 */
static void read_message(int fd, char message[MESSAGE_MAX])
{
    char text[4096], drained[512], *rest = NULL;
    size_t used = 0;
    for (;;) {
        char *to = used < sizeof text - 1 ? text + used : drained;
        ssize_t got =
            read(fd, to, used < sizeof text - 1 ? sizeof text - 1 - used : sizeof drained);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            break;
        }
        used += to != drained ? (size_t)got : 0;
    }
    text[used] = 0;
    message[0] = 0;
    for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        line += strspn(line, " \t^");
        if (*line) {
            snprintf(message, MESSAGE_MAX, "%s", line);
        }
    }
}

/* Start gnuplot in a folder; its complaints come out of *message_fd. Gives an errno, 0 on success.
 */
static int start(const char *folder, char *const arguments[], pid_t *child, int *message_fd)
{
    int ends[2];
    posix_spawn_file_actions_t actions;
    if (pipe2(ends, O_CLOEXEC) != 0) {
        return errno;
    }
    int error = posix_spawn_file_actions_init(&actions);
    if (error == 0) {
        error = posix_spawn_file_actions_addchdir_np(&actions, folder);
        error =
            error ? error : posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
        error =
            error ? error : posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
        error = error ? error : posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
        error = error ? error : posix_spawnp(child, "gnuplot", &actions, NULL, arguments, environ);
        posix_spawn_file_actions_destroy(&actions);
    }
    close(ends[1]);
    if (error) {
        close(ends[0]);
    } else {
        *message_fd = ends[0];
    }
    return error;
}

static parian_result run(const parian_env *env, const char *folder, const char *name,
                         const char *base)
{
    char script[NAME_MAX_BYTES + 16], setting[BASE_MAX + 16], message[MESSAGE_MAX];
    int fd = -1, status = 0;
    pid_t child;
    snprintf(script, sizeof script, "./%s.gp", name);
    snprintf(setting, sizeof setting, "base='./%s'", base);
    char *const arguments[] = {"gnuplot", "-d", "-e", setting, script, NULL};
    int error = start(folder, arguments, &child, &fd);
    if (error == ENOENT) {
        return parian_fail(
            env, PARIAN_E_UNSUPPORTED,
            "gnuplot is not installed: %s/%s.gp and .dat are written, its pictures are not", folder,
            name);
    }
    if (error) {
        return parian_fail(env, PARIAN_E_IO, "cannot run gnuplot: %s", strerror(error));
    }
    read_message(fd, message);
    close(fd);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        return parian_fail(env, PARIAN_E_IO, "gnuplot failed on '%s/%s.gp': %s", folder, name,
                           message[0] ? message : "it said nothing");
    }
    if (message[0]) {
        parian_log(env, PARIAN_LOG_DEBUG, "gnuplot on '%s/%s.gp': %s", folder, name, message);
    }
    return PARIAN_OK;
}

/* ---- files -------------------------------------------------------------------------------------
 */
typedef struct file_names {
    char *target, *temporary;
} file_names;

static char *join(const parian_env *env, const char *folder, const char *name, const char *suffix)
{
    char file[NAME_MAX_BYTES + BASE_MAX];
    snprintf(file, sizeof file, "%s%s", name, suffix);
    return parian_path_join(env, folder, file);
}

static parian_result write_text(const parian_env *env, const char *folder, const char *name,
                                const char *suffix, const parian_chart_text *text)
{
    char *path = join(env, folder, name, suffix);
    if (!path || text->failed) {
        parian_free(env, path);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for '%s/%s%s'", folder, name, suffix);
    }
    parian_result result = parian_file_write(env, path, text->text ? text->text : "", text->size);
    parian_free(env, path);
    return result;
}

/* gnuplot ends well without having drawn where there is nothing to draw. */
static parian_result keep(const parian_env *env, const file_names *file)
{
    struct stat status;
    if (stat(file->temporary, &status) != 0 || status.st_size == 0) {
        return parian_fail(env, PARIAN_E_IO, "gnuplot has not written '%s'", file->target);
    }
    if (rename(file->temporary, file->target) != 0) {
        return parian_fail(env, PARIAN_E_IO, "cannot write '%s': %s", file->target,
                           strerror(errno));
    }
    return PARIAN_OK;
}

static parian_result run_and_keep(const parian_env *env, const char *folder, const char *name)
{
    static atomic_uint counter;
    static const char *const suffix[2] = {".png", ".svg"};
    char base[BASE_MAX];
    file_names file[2] = {{0}};
    parian_result result = PARIAN_OK;
    snprintf(base, sizeof base, ".plot-%ld-%u.tmp", (long)getpid(), atomic_fetch_add(&counter, 1));
    for (int i = 0; i < 2; i++) {
        file[i].target = join(env, folder, name, suffix[i]);
        file[i].temporary = join(env, folder, base, suffix[i]);
        if (!file[i].target || !file[i].temporary) {
            result = parian_fail(env, PARIAN_E_NOMEM, "no memory for the names of '%s'", name);
        }
    }
    if (result == PARIAN_OK) {
        parian_temp_register(file[0].temporary);
        parian_temp_register(file[1].temporary);
        result = run(env, folder, name, base);
        for (int i = 0; i < 2; i++) {
            result = result == PARIAN_OK ? keep(env, &file[i]) : result;
            unlink(file[i].temporary);
            parian_temp_unregister(file[i].temporary);
        }
    }
    for (int i = 0; i < 2; i++) {
        parian_free(env, file[i].target);
        parian_free(env, file[i].temporary);
    }
    return result;
}

parian_result parian_gnuplot_draw(const parian_env *env, const char *folder, const char *name,
                                  const parian_chart_text *script, const parian_chart_text *data)
{
    parian_result result = parian_gnuplot_check_name(env, name);
    result = result == PARIAN_OK ? parian_folder_create(env, folder) : result;
    result = result == PARIAN_OK ? write_text(env, folder, name, ".dat", data) : result;
    result = result == PARIAN_OK ? write_text(env, folder, name, ".gp", script) : result;
    return result == PARIAN_OK ? run_and_keep(env, folder, name) : result;
}
