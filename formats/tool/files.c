/* files.c - reading whole files, writing them atomically, folders.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/files.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/memory.h"

enum { READ_STEP = 1 << 20, NAME_TRIES = 100 };
static const size_t WRITE_STEP = (size_t)1 << 30; /* below what one write() takes */

static const char *shown(const char *path, bool reading)
{
    return strcmp(path, "-") != 0 ? path : reading ? "(stdin)" : "(stdout)";
}

/* ---- reading -----------------------------------------------------------------------------------
 */
static parian_result fail_errno(const parian_env *env, const char *doing, const char *path)
{
    return parian_fail(env, PARIAN_E_IO, "cannot %s '%s': %s", doing, path, strerror(errno));
}

static parian_result open_for_reading(const parian_env *env, const char *path, int *descriptor)
{
    struct stat status;
    int fd = strcmp(path, "-") == 0 ? dup(STDIN_FILENO) : open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return fail_errno(env, "read", shown(path, true));
    }
    if (fstat(fd, &status) == 0 && S_ISDIR(status.st_mode)) {
        close(fd);
        return parian_fail(env, PARIAN_E_IO,
                           "cannot read '%s': it is a folder, a file was expected", path);
    }
    *descriptor = fd;
    return PARIAN_OK;
}

/* The next bytes of a file, or 0 at its end, or -1; goes on after an interrupted call. */
static ssize_t read_some(int fd, void *data, size_t size)
{
    ssize_t got;
    do {
        got = read(fd, data, size);
    } while (got < 0 && errno == EINTR);
    return got;
}

/* A buffer of twice the size with the first `used` bytes. */
static uint8_t *grow(const parian_env *env, uint8_t *data, size_t used, size_t capacity)
{
    uint8_t *larger = parian_alloc(env, capacity, 1);
    if (larger) {
        memcpy(larger, data, used);
    }
    parian_free(env, data);
    return larger;
}

static parian_result read_all(const parian_env *env, const char *name, int fd, uint64_t size_max,
                              uint8_t **out, size_t *size)
{
    struct stat status;
    bool regular = fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
    if (regular && (uint64_t)status.st_size > size_max) {
        return parian_fail(env, PARIAN_E_LIMIT,
                           "%s: %" PRIu64 " bytes, at most %" PRIu64 " are read", name,
                           (uint64_t)status.st_size, size_max);
    }
    size_t capacity = (regular ? (size_t)status.st_size : (size_t)READ_STEP) + 2, used = 0;
    uint8_t *data = parian_alloc(env, capacity, 1);
    while (data) {
        ssize_t got = read_some(fd, data + used, capacity - used - 1);
        if (got < 0) {
            parian_free(env, data);
            return fail_errno(env, "read", name);
        }
        used += (size_t)got;
        if (got == 0) {
            data[used] = 0;
            *out = data;
            *size = used;
            return PARIAN_OK;
        }
        if (used > size_max) {
            parian_free(env, data);
            return parian_fail(env, PARIAN_E_LIMIT,
                               "%s: more than the %" PRIu64 " bytes that are read", name, size_max);
        }
        if (used + 1 >= capacity) {
            capacity *= 2;
            data = grow(env, data, used, capacity);
        }
    }
    return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for %zu bytes", name, capacity);
}

parian_result parian_file_read(const parian_env *env, const char *path, uint64_t size_max,
                               uint8_t **data, size_t *size)
{
    int fd;
    parian_result result = open_for_reading(env, path, &fd);
    if (result != PARIAN_OK) {
        return result;
    }
    result = read_all(env, shown(path, true), fd, size_max, data, size);
    close(fd);
    return result;
}

parian_result parian_file_hash(const parian_env *env, const char *path, uint64_t *hash)
{
    int fd;
    ssize_t got = -1;
    parian_result result = open_for_reading(env, path, &fd);
    if (result != PARIAN_OK) {
        return result;
    }
    XXH3_state_t *state = XXH3_createState();
    uint8_t *buffer = parian_alloc(env, READ_STEP, 1);
    if (!state || !buffer) {
        result = parian_fail(env, PARIAN_E_NOMEM, "%s: no memory to read it", path);
    } else {
        XXH3_64bits_reset(state);
        while ((got = read_some(fd, buffer, READ_STEP)) > 0) {
            XXH3_64bits_update(state, buffer, (size_t)got);
        }
        if (got < 0) {
            result = fail_errno(env, "read", path);
        } else {
            *hash = XXH3_64bits_digest(state);
        }
    }
    parian_free(env, buffer);
    XXH3_freeState(state);
    close(fd);
    return result;
}

/* ---- writing -----------------------------------------------------------------------------------
 */
static bool write_pieces(int fd, const parian_piece *pieces, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const uint8_t *data = pieces[i].data;
        size_t left = pieces[i].size;
        while (left > 0) {
            ssize_t put = write(fd, data, left < WRITE_STEP ? left : WRITE_STEP);
            if (put < 0 && errno != EINTR) {
                return false;
            }
            if (put > 0) {
                data += put;
                left -= (size_t)put;
            }
        }
    }
    return true;
}

static parian_result write_to_stdout(const parian_env *env, const parian_piece *pieces,
                                     size_t count)
{
    if (fflush(stdout) != 0 || !write_pieces(STDOUT_FILENO, pieces, count)) {
        return fail_errno(env, "write", "(stdout)");
    }
    return PARIAN_OK;
}

static parian_result write_directly(const parian_env *env, const char *path,
                                    const parian_piece *pieces, size_t count)
{
    int fd = open(path, O_WRONLY | O_CLOEXEC);
    if (fd < 0) {
        return fail_errno(env, "write", path);
    }
    bool ok = write_pieces(fd, pieces, count);
    parian_result result = ok ? PARIAN_OK : fail_errno(env, "write", path);
    close(fd);
    return result;
}

/* Open a new file of a name that nobody else uses, beside the target. */
static int open_temporary(const char *target, char *path, size_t size)
{
    static atomic_uint counter;
    for (int i = 0; i < NAME_TRIES; i++) {
        snprintf(path, size, "%s.%ld-%u.tmp", target, (long)getpid(),
                 atomic_fetch_add(&counter, 1u));
        int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0 || errno != EEXIST) {
            return fd;
        }
    }
    return -1;
}

static parian_result write_and_rename(const parian_env *env, const char *target, char *temporary,
                                      size_t size, const parian_piece *pieces, size_t count)
{
    struct stat status;
    int fd = open_temporary(target, temporary, size);
    if (fd < 0) {
        return fail_errno(env, "write", target);
    }
    parian_temp_register(temporary);
    if (stat(target, &status) == 0 && fchmod(fd, status.st_mode & 07777) != 0) {
        parian_log(env, PARIAN_LOG_DEBUG, "%s: its permissions could not be kept", target);
    }
    bool ok = write_pieces(fd, pieces, count) && fsync(fd) == 0;
    int error = errno;
    if (close(fd) != 0 && ok) {
        ok = false;
        error = errno;
    }
    if (ok && rename(temporary, target) != 0) {
        ok = false;
        error = errno;
    }
    parian_result result = PARIAN_OK;
    if (!ok) {
        unlink(temporary);
        errno = error;
        result = fail_errno(env, "write", target);
    }
    parian_temp_unregister(temporary);
    return result;
}

parian_result parian_file_write_pieces(const parian_env *env, const char *path,
                                       const parian_piece *pieces, size_t count)
{
    struct stat status;
    if (strcmp(path, "-") == 0) {
        return write_to_stdout(env, pieces, count);
    }
    parian_result result = parian_folder_create_parent(env, path);
    if (result != PARIAN_OK) {
        return result;
    }
    bool exists = stat(path, &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) {
        return parian_fail(env, PARIAN_E_IO,
                           "cannot write '%s': it is a folder, a file name was expected", path);
    }
    if (exists && !S_ISREG(status.st_mode)) {
        return write_directly(env, path, pieces, count);
    }
    char *real = exists ? realpath(path, NULL) : NULL; /* a link stays, its file is replaced */
    const char *target = real ? real : path;
    size_t size = strlen(target) + 64;
    char *temporary = parian_alloc(env, size, 1);
    result = temporary ? write_and_rename(env, target, temporary, size, pieces, count)
                       : parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its name", path);
    parian_free(env, temporary);
    free(real);
    return result;
}

parian_result parian_file_write(const parian_env *env, const char *path, const void *data,
                                size_t size)
{
    return parian_file_write_pieces(env, path, &(parian_piece){data, size}, 1);
}

/* ---- folders and paths -------------------------------------------------------------------------
 */
static parian_result make_folder(const parian_env *env, const char *path)
{
    struct stat status;
    if (mkdir(path, 0777) == 0) {
        return PARIAN_OK;
    }
    int error = errno;
    if (stat(path, &status) == 0) {
        return S_ISDIR(status.st_mode)
                   ? PARIAN_OK
                   : parian_fail(env, PARIAN_E_IO,
                                 "cannot create folder '%s': a file of that name exists", path);
    }
    errno = error;
    return fail_errno(env, "create folder", path);
}

parian_result parian_folder_create(const parian_env *env, const char *path)
{
    size_t length = strlen(path);
    char *part = parian_alloc(env, length + 1, 1);
    parian_result result = PARIAN_OK;
    if (!part) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its name", path);
    }
    for (size_t i = 1; i <= length && result == PARIAN_OK; i++) {
        if ((path[i] == '/' && path[i - 1] != '/') || (path[i] == '\0' && path[i - 1] != '/')) {
            memcpy(part, path, i);
            part[i] = '\0';
            result = make_folder(env, part);
        }
    }
    parian_free(env, part);
    return result;
}

char *parian_path_folder(const parian_env *env, const char *path)
{
    const char *slash = strrchr(path, '/');
    size_t length = !slash ? 1 : slash == path ? 1 : (size_t)(slash - path);
    char *folder = parian_alloc(env, length + 1, 1);
    if (folder) {
        memcpy(folder, slash ? path : ".", length);
        folder[length] = '\0';
    }
    return folder;
}

parian_result parian_folder_create_parent(const parian_env *env, const char *path)
{
    char *folder = parian_path_folder(env, path);
    if (!folder) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its name", path);
    }
    parian_result result = strchr(path, '/') ? parian_folder_create(env, folder) : PARIAN_OK;
    parian_free(env, folder);
    return result;
}

char *parian_path_join(const parian_env *env, const char *folder, const char *name)
{
    size_t length = strlen(folder), size = length + strlen(name) + 2;
    char *path = parian_alloc(env, size, 1);
    if (path) {
        bool slash = length > 0 && folder[length - 1] != '/';
        snprintf(path, size, "%s%s%s", folder, slash ? "/" : "", name);
    }
    return path;
}
