/* reference_files.h - files of one run that appear together or not at all, and the parts of
 * summaries.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFERENCE_FILES_H
#define PARIAN_BAKE_REFERENCE_FILES_H

#include <cjson/cJSON.h>

#include "core/medium.h"
#include "tool/files.h"

enum { REFERENCE_FILES_MAX = 24 };

/* The files that a run has written so far. */
typedef struct reference_files {
    const parian_env *env;
    const char *folder;
    size_t count;
    char name[REFERENCE_FILES_MAX][64];
} reference_files;

/* Write one file of the folder. Errors: PARIAN_E_IO, PARIAN_E_NOMEM. */
parian_result reference_files_npy(reference_files *files, const char *name, parian_element element,
                                  uint32_t rank, const uint64_t *shape, const void *data);
parian_result reference_files_text(reference_files *files, const char *name, const char *text);
/* The same for a JSON object, which is deleted; NULL is PARIAN_E_NOMEM. */
parian_result reference_files_json(reference_files *files, const char *name, cJSON *object);
/* Remove one file of the folder, if it is there. */
void reference_files_forget(const reference_files *files, const char *name);
/* Remove what was written, after a failure. */
void reference_files_remove(const reference_files *files);

void reference_add_triple(cJSON *object, const char *name, const double value[3]);
void reference_add_medium(cJSON *parent, const char *name, const parian_medium *medium);

#endif
