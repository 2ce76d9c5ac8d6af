/* import_check.h - checks of mesh files before a library reads them, and what those checks share.
 *
 * Each check walks a whole file, refuses what is cut short, out of range or not a number with one
 * line that names file and place, and writes a plain file of the same format (positions and faces
 * only) for OpenMesh.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_IMPORT_CHECK_H
#define PARIAN_BAKE_IMPORT_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

/* A file in memory; data[size] is NUL. */
typedef struct parian_model_bytes {
    const char *path; /* for messages */
    const char *data;
    size_t size;
} parian_model_bytes;

/* A growing buffer. */
typedef struct parian_plain_file {
    const parian_env *env;
    char *data;
    size_t size, capacity;
    bool binary; /* STL and PLY: read in binary mode */
} parian_plain_file;

/* Fill plain (zeroed by the caller but for env; the caller frees plain->data). Errors:
 * PARIAN_E_FORMAT, PARIAN_E_UNSUPPORTED, PARIAN_E_NOMEM, each with its line logged. */
parian_result parian_check_obj(const parian_model_bytes *file, parian_plain_file *plain);
parian_result parian_check_off(const parian_model_bytes *file, parian_plain_file *plain);
parian_result parian_check_ply(const parian_model_bytes *file, parian_plain_file *plain);
parian_result parian_check_stl(const parian_model_bytes *file, parian_plain_file *plain);

/* Append bytes, an unsigned number in decimal. Errors: PARIAN_E_NOMEM, logged. */
parian_result parian_plain_append(parian_plain_file *plain, const void *bytes, size_t size);
parian_result parian_plain_number(parian_plain_file *plain, uint64_t number);

/* A position in a text. */
typedef struct parian_scan {
    const char *at, *end;
    uint32_t line; /* of `at`, from 1 */
} parian_scan;

/* A word or a line inside a text; not terminated. */
typedef struct parian_span {
    const char *begin, *end;
} parian_span;

/* The next line that holds more than blanks and a '#' comment, without its comment; a line that
 * ends in a backslash goes on in the next. False at the end of the text. */
bool parian_scan_line(parian_scan *scan, parian_span *line);
/* The next blank-separated word of a line, cut off its front. False at its end. */
bool parian_scan_word(parian_span *line, parian_span *word);
bool parian_span_is(parian_span word, const char *text);
/* True when the whole word is a finite number; a whole number in [lowest, highest]. */
bool parian_span_finite(parian_span word, double *value);
bool parian_span_integer(parian_span word, int64_t lowest, int64_t highest, int64_t *value);
/* The printable beginning of a word, for messages. */
const char *parian_span_show(parian_span word, char buffer[24]);

#endif
