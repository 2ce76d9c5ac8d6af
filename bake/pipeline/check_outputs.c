/* check_outputs.c - refuses outputs that could not be written, before any work is done.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "bake/pipeline/bake.h"
#include "core/memory.h"
#include "tool/files.h"

/* The nearest folder above that exists must be one that can be written into. */
static parian_result check_folder(const parian_env *env, const char *output, const char *folder)
{
    struct stat info;
    if (stat(folder, &info) == 0) {
        if (!S_ISDIR(info.st_mode)) {
            return parian_fail(env, PARIAN_E_IO, "%s: '%s' is a file, expected a folder", output,
                               folder);
        }
        return access(folder, W_OK | X_OK) == 0
                   ? PARIAN_OK
                   : parian_fail(env, PARIAN_E_IO, "%s: cannot write into '%s': %s", output, folder,
                                 strerror(errno));
    }
    if (errno != ENOENT && errno != ENOTDIR) {
        return parian_fail(env, PARIAN_E_IO, "%s: cannot reach '%s': %s", output, folder,
                           strerror(errno));
    }
    char *above = parian_path_folder(env, folder);
    parian_result r = above ? PARIAN_OK : PARIAN_E_NOMEM;
    if (above && strcmp(above, folder) != 0) {
        r = check_folder(env, output, above);
    }
    parian_free(env, above);
    return r;
}

static parian_result check_file(const parian_env *env, const char *path)
{
    struct stat info;
    size_t length = strlen(path);
    bool slash = length > 0 && path[length - 1] == '/';
    if (slash || length == 0 || (stat(path, &info) == 0 && S_ISDIR(info.st_mode))) {
        return parian_fail(env, PARIAN_E_IO, "'%s' names a folder, the name of a file was expected",
                           path);
    }
    char *folder = parian_path_folder(env, path);
    parian_result r = folder ? check_folder(env, path, folder) : PARIAN_E_NOMEM;
    parian_free(env, folder);
    return r;
}

/* The asset is renamed into its place: only a regular file can be replaced, and not the input. */
static parian_result check_asset(const parian_env *env, const parian_bake_desc *desc)
{
    struct stat output, input;
    parian_result r = check_file(env, desc->output);
    if (r != PARIAN_OK || stat(desc->output, &output) != 0) {
        return r;
    }
    if (!S_ISREG(output.st_mode)) {
        return parian_fail(env, PARIAN_E_IO, "%s: is not a regular file and cannot be replaced",
                           desc->output);
    }
    if (stat(desc->input, &input) == 0 && input.st_dev == output.st_dev &&
        input.st_ino == output.st_ino) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "%s: is the input, the asset would replace it",
                           desc->output);
    }
    return PARIAN_OK;
}

parian_result parian_check_outputs(const parian_env *env, const parian_bake_desc *desc)
{
    parian_result r = desc->output ? check_asset(env, desc) : PARIAN_OK;
    if (r == PARIAN_OK && desc->report_path && strcmp(desc->report_path, "-") != 0) {
        r = check_file(env, desc->report_path);
    }
    if (r == PARIAN_OK && desc->depfile_path && strcmp(desc->depfile_path, "-") != 0) {
        r = check_file(env, desc->depfile_path);
    }
    if (r == PARIAN_OK && desc->dump_folder) {
        r = check_folder(env, desc->dump_folder, desc->dump_folder);
    }
    return r;
}
