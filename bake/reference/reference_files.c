/* reference_files.c - files of one run that appear together or not at all, and the parts of
 * summaries.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/reference_files.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "core/memory.h"

static void remember(reference_files *files, const char *name)
{
    if (files->count < REFERENCE_FILES_MAX) {
        snprintf(files->name[files->count++], sizeof files->name[0], "%s", name);
    }
}

parian_result reference_files_npy(reference_files *files, const char *name, parian_element element,
                                  uint32_t rank, const uint64_t *shape, const void *data)
{
    parian_result r = parian_folder_create(files->env, files->folder);
    if (r == PARIAN_OK) {
        r = parian_npy_write(files->env, files->folder, name, element, rank, shape, data);
    }
    if (r == PARIAN_OK) {
        remember(files, name);
    }
    return r;
}

parian_result reference_files_text(reference_files *files, const char *name, const char *text)
{
    char *path = parian_path_join(files->env, files->folder, name);
    if (!path) {
        return parian_fail(files->env, PARIAN_E_NOMEM, "%s: no memory for its path", name);
    }
    parian_result r = parian_file_write(files->env, path, text, strlen(text));
    if (r == PARIAN_OK) {
        remember(files, name);
    }
    parian_free(files->env, path);
    return r;
}

parian_result reference_files_json(reference_files *files, const char *name, cJSON *object)
{
    char *text = object ? cJSON_Print(object) : NULL;
    cJSON_Delete(object);
    if (!text) {
        return parian_fail(files->env, PARIAN_E_NOMEM, "%s: no memory for it", name);
    }
    parian_result r = reference_files_text(files, name, text);
    cJSON_free(text);
    return r;
}

void reference_files_forget(const reference_files *files, const char *name)
{
    char *path = parian_path_join(files->env, files->folder, name);
    if (path) {
        unlink(path);
    }
    parian_free(files->env, path);
}

void reference_files_remove(const reference_files *files)
{
    for (size_t i = 0; i < files->count; i++) {
        reference_files_forget(files, files->name[i]);
    }
}

void reference_add_triple(cJSON *object, const char *name, const double value[3])
{
    cJSON *array = cJSON_AddArrayToObject(object, name);
    for (int c = 0; array && c < 3; c++) {
        cJSON_AddItemToArray(array, isfinite(value[c]) ? cJSON_CreateNumber(value[c])
                                                       : cJSON_CreateNull());
    }
}

void reference_add_medium(cJSON *parent, const char *name, const parian_medium *medium)
{
    cJSON *o = name ? cJSON_AddObjectToObject(parent, name) : parent;
    cJSON_AddStringToObject(o, "medium", medium->name);
    reference_add_triple(o, "sigma_s_prime_per_m", medium->sigma_s_prime);
    reference_add_triple(o, "sigma_a_per_m", medium->sigma_a);
    reference_add_triple(o, "g", medium->g);
    cJSON_AddNumberToObject(o, "eta", medium->eta);
    cJSON_AddBoolToObject(o, "reduced_only", medium->reduced_only);
}
