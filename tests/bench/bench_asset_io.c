/* bench_asset_io.c - how fast an asset opens: views with and without checksums, decoding, and what
 * the memory of the machine can do beside it. Never a verdict.
 *
 *   bench_asset_io ASSET.parian [repeats]
 *
 * The asset's arrays are written anew without compression (mapped views) and with what
 * ASSET has. Medians of repeats (default 9) with the files in the page cache; every repeat opens
 * the file anew, so that its pages are mapped again.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/memory.h"
#include "parian/format.h"
#include "support/test_support.h"
#include "tool/files.h"
#include "tool/session.h"

enum { REPEAT_MAX = 99, PIECES = 64 };

typedef struct bench {
    const parian_env *env;
    const char *coded, *raw; /* paths */
    uint64_t raw_size, coded_size, decoded_size;
    uint8_t *bytes, *copy; /* [raw_size] */
    void *array;           /* room for the largest chunk */
} bench;

static void expect(parian_result result, const char *what)
{
    if (result != PARIAN_OK) {
        fprintf(stderr, "bench_asset_io: %s: %s\n", what, parian_result_text(result));
        exit(1);
    }
}

static parian_reader *open_file(const bench *b, const char *path)
{
    parian_reader *reader;
    expect(parian_reader_open(b->env, path, NULL, &reader), path);
    return reader;
}

/* ---- what the machine can do --------------------------------------------------------------------
 */

static uint64_t piece_of(const bench *b, size_t index)
{
    return b->raw_size * index / PIECES / 8 * 8;
}

static void sum_piece(void *context, size_t index)
{
    const bench *b = context;
    uint64_t sum = 0;
    for (uint64_t i = piece_of(b, index); i + 8 <= piece_of(b, index + 1); i += 8) {
        uint64_t word;
        memcpy(&word, b->bytes + i, 8);
        sum += word;
    }
    volatile uint64_t keep = sum;
    (void)keep;
}

static void hash_piece(void *context, size_t index)
{
    const bench *b = context;
    uint64_t first = piece_of(b, index);
    volatile XXH64_hash_t keep = XXH3_64bits(b->bytes + first, piece_of(b, index + 1) - first);
    (void)keep;
}

static void sum_memory(bench *b)
{
    parian_par(b->env, PIECES, sum_piece, b);
}

static void hash_memory(bench *b)
{
    parian_par(b->env, PIECES, hash_piece, b);
}

static void copy_memory(bench *b)
{
    memcpy(b->copy, b->bytes, b->raw_size);
}

/* ---- what the reader does -----------------------------------------------------------------------
 */

static void open_raw(bench *b)
{
    parian_reader_close(open_file(b, b->raw));
}

static void view_unverified(bench *b)
{
    parian_reader *reader = open_file(b, b->raw);
    const void *view;
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        expect(parian_reader_map_unverified(reader, i, &view), "view");
    }
    parian_reader_close(reader);
}

static void view_verified(bench *b)
{
    parian_reader *reader = open_file(b, b->raw);
    const void *view;
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        expect(parian_reader_map(reader, i, &view), "view");
    }
    parian_reader_close(reader);
}

static void read_all(const bench *b, const char *path)
{
    parian_reader *reader = open_file(b, path);
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        expect(parian_reader_read(reader, i, b->array), "read");
    }
    parian_reader_close(reader);
}

static void read_raw(bench *b)
{
    read_all(b, b->raw);
}

static void decode_coded(bench *b)
{
    read_all(b, b->coded);
}

static void verify_coded(bench *b)
{
    parian_reader *reader = open_file(b, b->coded);
    expect(parian_reader_verify(reader), "verify");
    parian_reader_close(reader);
}

/* ---- the table ----------------------------------------------------------------------------------
 */

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(bench *b, void (*run)(bench *), int repeats)
{
    double seconds[REPEAT_MAX];
    run(b);
    for (int r = 0; r < repeats; r++) {
        double start = parian_seconds();
        run(b);
        seconds[r] = parian_seconds() - start;
    }
    qsort(seconds, (size_t)repeats, sizeof *seconds, compare_doubles);
    return seconds[repeats / 2];
}

static void prepare(bench *b, const char *path)
{
    const parian_writer_desc desc = {.path = test_scratch("raw.parian"), .no_compression = true};
    parian_writer *writer;
    size_t size = 0, largest = 1;
    b->coded = path;
    b->raw = desc.path;
    parian_reader *reader = open_file(b, path);
    b->coded_size = parian_reader_file_size(reader);
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        const parian_chunk_info *info = parian_reader_chunk(reader, i);
        largest = info->size > largest ? info->size : largest;
        b->decoded_size += info->size;
    }
    b->array = parian_alloc(b->env, largest, 1);
    expect(b->array ? PARIAN_OK : PARIAN_E_NOMEM, path);
    expect(parian_writer_begin(b->env, &desc, &writer), b->raw);
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        expect(parian_reader_read(reader, i, b->array), path);
        expect(parian_writer_chunk(writer, parian_reader_chunk(reader, i), b->array), b->raw);
    }
    expect(parian_writer_finish(writer), b->raw);
    parian_reader_close(reader);
    expect(parian_file_read(b->env, b->raw, UINT64_MAX, &b->bytes, &size), b->raw);
    b->raw_size = size;
    b->copy = parian_alloc(b->env, size, 1);
    expect(b->copy ? PARIAN_OK : PARIAN_E_NOMEM, path);
}

int main(int argc, char **argv)
{
    bench b = {.env = test_env(0)};
    int repeats = argc > 2 ? atoi(argv[2]) : 9;
    if (argc < 2 || repeats < 1 || repeats > REPEAT_MAX) {
        fprintf(stderr, "usage: bench_asset_io ASSET.parian [repeats]\n");
        return 1;
    }
    prepare(&b, argv[1]);
    const struct {
        const char *what;
        void (*run)(bench *);
        uint64_t bytes;
    } row[] = {{"sum of words in memory, all threads", sum_memory, b.raw_size},
               {"copy in memory, one thread", copy_memory, b.raw_size},
               {"XXH3-64 in memory, all threads", hash_memory, b.raw_size},
               {"raw: open", open_raw, b.raw_size},
               {"raw: open, views without verification", view_unverified, b.raw_size},
               {"raw: open, verify, views", view_verified, b.raw_size},
               {"raw: open, verify, copy out", read_raw, b.raw_size},
               {"coded: open, verify, decode", decode_coded, b.decoded_size},
               {"coded: open, verify by decoding, keep nothing", verify_coded, b.decoded_size}};
    double memory = 0;
    printf(
        "raw %.1f MB, coded %.1f MB\n\n| what | ms | GB/s | of the memory's |\n|---|---|---|---|\n",
        1e-6 * (double)b.raw_size, 1e-6 * (double)b.coded_size);
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        double seconds = median(&b, row[i].run, repeats);
        double rate = (double)row[i].bytes / seconds;
        memory = i == 0 ? rate : memory;
        printf("| %s | %.2f | %.2f | %.2f |\n", row[i].what, 1e3 * seconds, 1e-9 * rate,
               rate / memory);
    }
    parian_free(b.env, b.array);
    parian_free(b.env, b.copy);
    free(b.bytes);
    return 0;
}
