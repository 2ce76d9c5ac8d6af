/* file_mapping.c - a whole file as read-only memory: mapped, or read where it cannot be mapped.
 *
 * SPDX-License-Identifier: MIT
 */
#include "container/file_mapping.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"

static parian_result read_copy(const parian_env *env, const char *path, int file,
                               parian_file_mapping *mapping)
{
    uint8_t *copy = parian_alloc(env, mapping->size, 1);
    if (!copy) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for %llu bytes", path,
                           (unsigned long long)mapping->size);
    }
    for (uint64_t done = 0; done < mapping->size;) {
        ssize_t got = read(file, copy + done, mapping->size - done);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            const char *reason = got < 0 ? strerror(errno) : "the file became shorter";
            parian_free(env, copy);
            return parian_fail(env, PARIAN_E_IO, "%s: cannot read: %s", path, reason);
        }
        done += (uint64_t)got;
    }
    mapping->data = mapping->copy = copy;
    return PARIAN_OK;
}

static parian_result map_open_file(const parian_env *env, const char *path, int file,
                                   parian_file_mapping *mapping)
{
    struct stat status;
    if (fstat(file, &status) != 0) {
        return parian_fail(env, PARIAN_E_IO, "%s: cannot read: %s", path, strerror(errno));
    }
    if (S_ISDIR(status.st_mode)) {
        return parian_fail(env, PARIAN_E_IO, "%s: is a folder, expected a file", path);
    }
    if (!S_ISREG(status.st_mode)) {
        return parian_fail(env, PARIAN_E_IO, "%s: is not a regular file", path);
    }
    mapping->size = (uint64_t)status.st_size;
    if (mapping->size == 0) {
        mapping->data = (const uint8_t *)"";
        return PARIAN_OK;
    }
    void *mapped = mmap(NULL, mapping->size, PROT_READ, MAP_PRIVATE, file, 0);
    if (mapped == MAP_FAILED) {
        return read_copy(env, path, file, mapping);
    }
    mapping->data = mapping->mapped = mapped;
    return PARIAN_OK;
}

parian_result parian_file_mapping_open(const parian_env *env, const char *path,
                                       parian_file_mapping *mapping)
{
    memset(mapping, 0, sizeof *mapping);
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) {
        return parian_fail(env, PARIAN_E_IO, "%s: cannot open: %s", path, strerror(errno));
    }
    parian_result result = map_open_file(env, path, file, mapping);
    close(file);
    return result;
}

void parian_file_mapping_close(const parian_env *env, parian_file_mapping *mapping)
{
    if (mapping->mapped) {
        munmap(mapping->mapped, mapping->size);
    }
    parian_free(env, mapping->copy);
    memset(mapping, 0, sizeof *mapping);
}
