/* body_schema.h - which chunk carries which array of a body, with element, shape and codec; rule
 * numbers.
 *
 * One table serves writer and reader, so that they cannot differ.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_BODY_SCHEMA_H
#define PARIAN_CORE_BODY_SCHEMA_H

#include "core/body.h"
#include "parian/format.h"

/* Rules of the schema, numbered as in docs/format.md. */
enum {
    RULE_CHUNK_MISSING = 201,
    RULE_CHUNK_SHAPE = 202,
    RULE_COUNTS = 203,
    RULE_CHUNK_UNEXPECTED = 204,
    RULE_CHUNK_UNKNOWN = 206,
    RULE_TEXT = 207,
    RULE_SETTING = 211,
    RULE_ATLAS_SIZE = 212,
    RULE_KERNEL_WIDTH = 213,
    RULE_MEDIUM = 214,
    RULE_FINITE = 221,
    RULE_INDEX = 222,
    RULE_ASCENDING = 223,
    RULE_BARYCENTRIC = 224,
    RULE_AREA = 225,
    RULE_NORMAL = 226,
    RULE_ALBEDO = 227,
    RULE_GUTTER_WEIGHT = 228,
    RULE_GUTTER_OWNED = 229,
    RULE_OFFSETS = 230,
    RULE_BORDER_SELF = 231,
    RULE_WINDOW = 232,
    RULE_UV = 233,
    RULE_REGISTER = 241,
    RULE_RUNS = 242,
    RULE_FACTOR_COUNT = 243,
    RULE_KERNEL_SCALE = 251,
    RULE_SPLIT_RADIUS = 252
};

/* Counts that shapes are made of. In a shape, values below SCHEMA_COUNT are fixed extents. */
typedef enum schema_count {
    SCHEMA_COUNT = 0x100,
    COUNT_VERTEX = SCHEMA_COUNT,
    COUNT_TRIANGLE,
    COUNT_TEXEL,
    COUNT_GUTTER,
    COUNT_BORDER,
    COUNT_BORDER_OFFSET, /* border texels + 1 */
    COUNT_BORDER_ENTRY,  /* entries of all border lists */
    COUNT_INTERIOR,      /* texels that are not border texels */
    COUNT_WIDTH,         /* of a kernel */
    COUNT_ROW,
    COUNT_ROW_OFFSET, /* rows + 1 */
    COUNT_RUN,
    COUNT_FACTOR,
    SCHEMA_COUNT_END
} schema_count;

typedef struct parian_schema_counts {
    uint64_t value[SCHEMA_COUNT_END - SCHEMA_COUNT];
} parian_schema_counts;

typedef enum schema_when {
    WHEN_ALWAYS,
    WHEN_PRESENT, /* optional: exactly when the pointer is not NULL */
    WHEN_BLEND,   /* forms REBUILT, F16, U8 with a global part */
    WHEN_F16,
    WHEN_U8,
    WHEN_SPLIT
} schema_when;

typedef struct parian_schema_array {
    const char *name;
    parian_element element;
    parian_codec codec;
    schema_when when;
    bool in_place; /* the field is the array itself, not a pointer to it */
    size_t field;  /* offset in parian_body, parian_operator or parian_surrounding */
    uint32_t rank;
    uint16_t shape[PARIAN_CHUNK_RANK_MAX];
} parian_schema_array;

/* Tables that end with a NULL name. */
extern const parian_schema_array parian_body_arrays[];
extern const parian_schema_array parian_operator_arrays[];
extern const parian_schema_array parian_surrounding_arrays[];

/* Words of the chunks that hold scalars. */
enum {
    SETTING_BSSRDF,
    SETTING_FIT_FDR,
    SETTING_PAPER_FORM,
    SETTING_REDUCED_ONLY,
    SETTING_ATLAS_SIZE,
    SETTING_CHART_COUNT,
    SETTING_LOCAL_FORM,
    SETTING_KERNEL_WIDTH,
    SETTING_OPERATOR_COUNT,
    SETTING_VERTEX_COUNT,
    SETTING_TRIANGLE_COUNT,
    SETTING_TEXEL_COUNT,
    SETTING_GUTTER_COUNT,
    SETTING_BORDER_COUNT,
    SETTING_BORDER_ENTRY_COUNT,
    SETTING_RESERVED,
    SETTING_TOTAL,

    OPERATOR_SOURCE = 0,
    OPERATOR_TARGET,
    OPERATOR_ROW_COUNT,
    OPERATOR_COLUMN_COUNT,
    OPERATOR_RUN_TOTAL,
    OPERATOR_FACTOR_TOTAL,
    OPERATOR_TOTAL
};

/* Whether a body must have (1), may have (0) or must not have (-1) an array. */
int parian_schema_presence(const parian_schema_array *array, const parian_body *body);

/* The extents of an array. */
void parian_schema_shape(const parian_schema_array *array, const parian_schema_counts *counts,
                         uint64_t shape[PARIAN_CHUNK_RANK_MAX]);

/* Fill the counts of a body, an operator or a surrounding; border entries are given apart, because
 * they stand behind a pointer. */
void parian_schema_body_counts(const parian_body *body, uint64_t border_entries,
                               parian_schema_counts *counts);
void parian_schema_operator_counts(const parian_operator *op, parian_schema_counts *counts);
void parian_schema_surrounding_counts(const parian_surrounding *surrounding,
                                      parian_schema_counts *counts);

/* Check every value of a body (its stored arrays, not the derived ones) or of a surrounding;
 * `where` begins the message. Errors: PARIAN_E_FORMAT with the rule, PARIAN_E_NOMEM. Threads: uses
 * env->par. */
parian_result parian_body_check(const parian_env *env, const parian_body *body, const char *where);
parian_result parian_surrounding_check(const parian_env *env, const parian_surrounding *surrounding,
                                       const char *where);

/* What of it can be checked before any array is there: settings, counts, medium. */
parian_result parian_body_check_settings(const parian_env *env, const parian_body *body,
                                         const char *where);
/* One operator: offsets, columns, counts, factors. All of a body: the same, and how they chain. */
parian_result parian_operator_check(const parian_env *env, const parian_operator *op,
                                    const char *where);
parian_result parian_operators_check(const parian_env *env, const parian_body *body,
                                     const char *where);

#endif
