/* container_output.h - a file that appears under its name only when it is complete.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CONTAINER_OUTPUT_H
#define PARIAN_CONTAINER_OUTPUT_H

#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_output {
    const parian_env *env;
    int file; /* -1 when closed */
    char *path;
    char *temporary; /* beside path */
    uint64_t size;   /* bytes appended so far */
} parian_output;

/* Make the temporary file. Errors: PARIAN_E_IO with path and reason, PARIAN_E_NOMEM. */
parian_result parian_output_open(const parian_env *env, const char *path, parian_output *output);
parian_result parian_output_append(parian_output *output, const void *data, uint64_t size);
/* Write over bytes at the beginning of the file. */
parian_result parian_output_rewrite(parian_output *output, const void *data, uint64_t size);
/* Flush to the disk and rename; on error no file is left. */
parian_result parian_output_commit(parian_output *output);
/* Remove the temporary file, if there is one, and free. */
void parian_output_discard(parian_output *output);

#endif
