/* file_mapping.h - a whole file as read-only memory: mapped, or read where it cannot be mapped.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_FILE_MAPPING_H
#define PARIAN_FILE_MAPPING_H

#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_file_mapping {
    const uint8_t *data; /* [size] */
    uint64_t size;
    void *mapped; /* what to unmap, or */
    void *copy;   /* what to free */
} parian_file_mapping;

/* Errors: PARIAN_E_IO with the path and the system's reason, PARIAN_E_NOMEM. */
parian_result parian_file_mapping_open(const parian_env *env, const char *path,
                                       parian_file_mapping *mapping);
void parian_file_mapping_close(const parian_env *env, parian_file_mapping *mapping);

#endif
