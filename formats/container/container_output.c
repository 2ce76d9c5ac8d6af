/* container_output.c - a file that appears under its name only when it is complete.
 *
 * SPDX-License-Identifier: MIT
 */
#include "container/container_output.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"

enum { NAME_TRIES = 1000, SUFFIX_SIZE = 64 };

static parian_result fail(const parian_output *output, const char *what)
{
    return parian_fail(output->env, PARIAN_E_IO, "%s: %s: %s", output->path, what, strerror(errno));
}

/* Bytes of the path up to and with its last slash. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* A target that could not be replaced in the end is refused at the beginning. */
static parian_result check_target(const parian_env *env, const char *path)
{
    struct stat status;
    size_t length = strlen(path);
    if (length == 0) {
        return parian_fail(env, PARIAN_E_IO, "the name of the output file is empty");
    }
    if (stat(path, &status) == 0) {
        if (S_ISDIR(status.st_mode)) {
            return parian_fail(env, PARIAN_E_IO, "%s: is a folder, expected the name of a file",
                               path);
        }
        if (!S_ISREG(status.st_mode)) {
            return parian_fail(env, PARIAN_E_IO, "%s: is not a regular file and cannot be replaced",
                               path);
        }
    } else if (path[length - 1] == '/') {
        return parian_fail(env, PARIAN_E_IO, "%s: ends with a slash, expected the name of a file",
                           path);
    }
    return PARIAN_OK;
}

static parian_result create_temporary(parian_output *output)
{
    size_t folder = folder_length(output->path);
    memcpy(output->temporary, output->path, folder);
    for (int i = 0; i < NAME_TRIES && output->file < 0; i++) {
        snprintf(output->temporary + folder, SUFFIX_SIZE, ".parian-%ld-%d.tmp", (long)getpid(), i);
        output->file = open(output->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (output->file < 0 && errno != EEXIST) {
            break;
        }
    }
    return output->file >= 0 ? PARIAN_OK : fail(output, "cannot write into its folder");
}

parian_result parian_output_open(const parian_env *env, const char *path, parian_output *output)
{
    memset(output, 0, sizeof *output);
    output->env = env;
    output->file = -1;
    parian_result result = check_target(env, path);
    if (result != PARIAN_OK) {
        return result;
    }
    size_t size = strlen(path) + 1;
    if (!PARIAN_NEW(env, output->path, size) ||
        !PARIAN_NEW(env, output->temporary, size + SUFFIX_SIZE)) {
        parian_output_discard(output);
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its name", path);
    }
    memcpy(output->path, path, size);
    result = create_temporary(output);
    if (result != PARIAN_OK) {
        parian_output_discard(output);
    }
    return result;
}

static parian_result write_at(parian_output *output, const uint8_t *data, uint64_t size,
                              uint64_t offset)
{
    for (uint64_t done = 0; done < size;) {
        ssize_t written = pwrite(output->file, data + done, size - done, (off_t)(offset + done));
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            return fail(output, "cannot write");
        }
        done += (uint64_t)written;
    }
    return PARIAN_OK;
}

parian_result parian_output_append(parian_output *output, const void *data, uint64_t size)
{
    parian_result result = write_at(output, data, size, output->size);
    output->size += size;
    return result;
}

parian_result parian_output_rewrite(parian_output *output, const void *data, uint64_t size)
{
    return write_at(output, data, size, 0);
}

/* Make the new name durable; a file system that cannot do this has done what it can. */
static void flush_folder(const parian_output *output)
{
    size_t length = folder_length(output->path);
    output->temporary[length] = 0;
    int folder = open(length ? output->temporary : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        fsync(folder);
        close(folder);
    }
}

parian_result parian_output_commit(parian_output *output)
{
    parian_result result = PARIAN_OK;
    if (fsync(output->file) != 0 && errno != EINVAL && errno != EROFS) {
        result = fail(output, "cannot write");
    }
    if (close(output->file) != 0 && result == PARIAN_OK) {
        result = fail(output, "cannot write");
    }
    output->file = -1;
    if (result == PARIAN_OK && rename(output->temporary, output->path) != 0) {
        result = fail(output, "cannot rename the finished file to this name");
    }
    if (result == PARIAN_OK) {
        flush_folder(output);
    } else {
        unlink(output->temporary);
    }
    parian_output_discard(output);
    return result;
}

void parian_output_discard(parian_output *output)
{
    if (output->file >= 0) {
        close(output->file);
        unlink(output->temporary);
    }
    parian_free(output->env, output->path);
    parian_free(output->env, output->temporary);
    output->path = output->temporary = NULL;
    output->file = -1;
}
