/* inspect.h - the commands of parian-info and what they share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_INSPECT_H
#define PARIAN_INSPECT_H

#include <cjson/cJSON.h>

#include "core/body.h"
#include "parian/format.h"
#include "tool/options.h"

typedef struct inspect_options {
    parian_common_options common;
    parian_string_list assets;
    bool json;
    const char *chunk, *output;
    double tolerance;
    bool tolerance_given;
    uint32_t level; /* of repack: zstd's, 1 to 19 */
    int codec;      /* of repack: a choice of --codec */
} inspect_options;

/* The commands, each on one asset (compare: two). What is asked for goes to stdout. */
parian_result inspect_info(const parian_env *env, const inspect_options *options, const char *path);
parian_result inspect_chunks(const parian_env *env, const inspect_options *options,
                             const char *path);
parian_result inspect_validate(const parian_env *env, const inspect_options *options,
                               const char *path);
parian_result inspect_export(const parian_env *env, const inspect_options *options,
                             const char *path);
parian_result inspect_repack(const parian_env *env, const inspect_options *options,
                             const char *path);
/* *different tells whether the files differ. */
parian_result inspect_compare(const parian_env *env, const inspect_options *options,
                              bool *different);

/* Name of a chunk that is unique in its asset: "body0/texel.area", "body0/operator.factor@1",
 * "surrounding2/surrounding.position", "scene.lights". */
enum { INSPECT_NAME_MAX = 96 };
void inspect_chunk_name(const parian_chunk_info *info, char name[INSPECT_NAME_MAX]);
/* Index of the chunk of this name (or of the only one with this name behind the '/'), or -1. */
int64_t inspect_find_chunk(const parian_reader *reader, const char *name);

/* Print and free a JSON document; NULL is "no memory". */
parian_result inspect_print_json(const parian_env *env, cJSON *json);

/* "12.3 MB"; digits in groups of three. The buffers rotate, eight of them. */
const char *inspect_bytes(uint64_t bytes);
const char *inspect_count(uint64_t count);

/* ---- what info shows of a body ------------------------------------------------------------------
 */

typedef struct body_summary {
    double mean_free_path_m[3];   /* 1 / sigma_t' */
    double diffusion_length_m[3]; /* 1 / sigma_tr; infinite without absorption */
    double extent_m[3];           /* sides of the bounding box */
    double area_m2, texel_edge_m, vertex_edge_m;
    uint64_t factor_count, run_count;
    double kept_share; /* of the full vertex-to-vertex matrices, or 0 */
    uint64_t gpu_bytes;
} body_summary;

void inspect_summarise(const parian_body *body, body_summary *summary);
double inspect_longest(const double extent_m[3]);

/* Bytes of the file by part. */
enum { INSPECT_PART_MAX = 9 };
typedef struct part_sizes {
    const char *name[INSPECT_PART_MAX];
    uint64_t stored[INSPECT_PART_MAX], decoded[INSPECT_PART_MAX];
    size_t count;
} part_sizes;
void inspect_part_sizes(const parian_reader *reader, part_sizes *parts);

extern const char *const inspect_local_form_names[]; /* by parian_local_form */
extern const char *const inspect_local_form_texts[];

#endif
