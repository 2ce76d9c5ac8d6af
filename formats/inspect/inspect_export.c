/* inspect_export.c - parian-info export: one chunk as .npy or .csv.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"
#include "inspect/inspect.h"
#include "inspect/inspect_values.h"
#include "tool/files.h"

enum { NUMBER_MAX = 32 };

static const char *extension_of(const char *path)
{
    const char *name = strrchr(path, '/'), *dot = strrchr(name ? name : path, '.');
    return dot ? dot : "";
}

static parian_result write_npy(const parian_env *env, const char *path,
                               const parian_chunk_info *info, const void *data)
{
    const char *slash = strrchr(path, '/');
    char *folder = parian_path_folder(env, path);
    if (!folder) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its name", path);
    }
    parian_result result = parian_npy_write(env, folder, slash ? slash + 1 : path, info->element,
                                            info->rank, info->shape, data);
    parian_free(env, folder);
    return result;
}

/* Rows are the slowest extent; everything behind it is a column. */
static parian_result write_csv(const parian_env *env, const char *path,
                               const parian_chunk_info *info, const void *data)
{
    size_t count = info->size / parian_element_size(info->element), used = 0;
    size_t columns = info->rank > 1 && info->shape[0] ? count / info->shape[0] : 1;
    char *text = parian_alloc(env, count + 1, NUMBER_MAX);
    if (!text) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for the text of %zu numbers", path,
                           count);
    }
    for (size_t i = 0; i < count; i++) {
        used += inspect_print_value(info->element, data, i, text + used, NUMBER_MAX - 1);
        text[used++] = (i + 1) % columns == 0 ? '\n' : ',';
    }
    parian_result result = parian_file_write(env, path, text, used);
    parian_free(env, text);
    return result;
}

static parian_result export_chunk(const parian_env *env, const inspect_options *options,
                                  const parian_reader *reader, uint32_t index)
{
    const parian_chunk_info *info = parian_reader_chunk(reader, index);
    void *data = parian_alloc(env, info->size, 1);
    if (!data) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the %" PRIu64 " bytes of %s",
                           info->size, info->name);
    }
    parian_result result = parian_reader_read(reader, index, data);
    if (result == PARIAN_OK) {
        bool npy = strcmp(extension_of(options->output), ".npy") == 0;
        result = (npy ? write_npy : write_csv)(env, options->output, info, data);
    }
    parian_free(env, data);
    return result;
}

parian_result inspect_export(const parian_env *env, const inspect_options *options,
                             const char *path)
{
    const char *extension = extension_of(options->output);
    parian_reader *reader;
    bool csv = strcmp(options->output, "-") == 0 || strcmp(extension, ".csv") == 0;
    if (!csv && strcmp(extension, ".npy") != 0) {
        return parian_fail(env, PARIAN_E_UNSUPPORTED, "%s: export writes .npy and .csv, not \"%s\"",
                           options->output, extension);
    }
    parian_result result = parian_reader_open(env, path, NULL, &reader);
    if (result != PARIAN_OK) {
        return result;
    }
    int64_t index = inspect_find_chunk(reader, options->chunk);
    result = index < 0 ? parian_fail(env, PARIAN_E_ARGUMENT,
                                     "%s: no chunk \"%s\"; parian-info chunks lists them", path,
                                     options->chunk)
                       : export_chunk(env, options, reader, (uint32_t)index);
    parian_reader_close(reader);
    return result;
}
