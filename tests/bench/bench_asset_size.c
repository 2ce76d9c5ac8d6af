/* bench_asset_size.c - bytes of assets by part, array, codec and level: what chose the codecs.
 *
 *   bench_asset_size ASSET.parian...
 *
 * Prints Markdown: bytes of each asset by part, and for each throughput factor and texel; bytes of
 * each array under each codec, and of all assets at each zstd level with seconds, summed over the
 * assets. Never a verdict.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "parian/format.h"
#include "support/test_support.h"
#include "tool/session.h"

enum { NAMES_MAX = 64, LEVELS = 5, CODECS = 4, LEVEL_OF_CODECS = 3 };
static const int level_of[LEVELS] = {1, 3, 6, 9, 19};

typedef struct array_sum {
    char name[PARIAN_CHUNK_NAME_MAX];
    uint64_t decoded, stored[CODECS];
    parian_codec chosen;
} array_sum;

static array_sum sums[NAMES_MAX];
static size_t sum_count;
static uint64_t level_bytes[LEVELS];
static double level_write[LEVELS], level_read[LEVELS], level_decoded;

static void expect(parian_result result, const char *what)
{
    if (result != PARIAN_OK) {
        fprintf(stderr, "bench_asset_size: %s: %s\n", what, parian_result_text(result));
        exit(1);
    }
}

static bool begins(const char *name, const char *with)
{
    return strncmp(name, with, strlen(with)) == 0;
}

/* Stored bytes of the chunks whose names begin so. */
static double stored(const parian_reader *reader, const char *with)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        const parian_chunk_info *info = parian_reader_chunk(reader, i);
        sum += begins(info->name, with) ? info->stored_size : 0;
    }
    return (double)sum;
}

static double rows_of(const parian_reader *reader, const char *name)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        const parian_chunk_info *info = parian_reader_chunk(reader, i);
        sum += strcmp(info->name, name) == 0 ? info->shape[0] : 0;
    }
    return (double)sum;
}

static void print_parts(const parian_reader *reader, const char *path)
{
    const char *name = strrchr(path, '/');
    double surface =
               stored(reader, "vertex.") + stored(reader, "triangle.") + stored(reader, "corner."),
           texels = stored(reader, "texel."), gutter = stored(reader, "gutter."),
           border = stored(reader, "border."), blend = stored(reader, "blend."),
           local = stored(reader, "local."), factors = stored(reader, "operator.");
    double texel_count = rows_of(reader, "texel.area"),
           factor_count = rows_of(reader, "operator.factor");
    printf("| %s | %.1f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.1f | %.2f | %.1f |\n",
           name ? name + 1 : path, 1e-6 * (double)parian_reader_file_size(reader), 1e-6 * surface,
           1e-6 * texels, 1e-6 * gutter, 1e-6 * border, 1e-6 * (blend + local), 1e-6 * factors,
           1e-6 * factor_count, factor_count > 0 ? factors / (3 * factor_count) : 0,
           texel_count > 0 ? (texels + gutter + border + blend + local) / texel_count : 0);
}

static array_sum *find_sum(const parian_chunk_info *info)
{
    for (size_t i = 0; i < sum_count; i++) {
        if (strcmp(sums[i].name, info->name) == 0) {
            return &sums[i];
        }
    }
    if (sum_count == NAMES_MAX) {
        exit(1);
    }
    memcpy(sums[sum_count].name, info->name, sizeof info->name);
    sums[sum_count].chosen = info->codec;
    return &sums[sum_count++];
}

static void *read_chunk(const parian_env *env, const parian_reader *reader, uint32_t index)
{
    void *data = parian_alloc(env, parian_reader_chunk(reader, index)->size, 1);
    expect(data ? parian_reader_read(reader, index, data) : PARIAN_E_NOMEM, "read");
    return data;
}

/* The arrays as they are, with one codec (or their own, where codec is negative) at a level. */
static parian_reader *rewrite(const parian_env *env, const parian_reader *reader, void **data,
                              int codec, int level, double *seconds)
{
    const char *path = test_scratch("bench.parian");
    const parian_writer_desc desc = {.path = path, .compression_level = level};
    parian_writer *writer;
    parian_reader *written;
    double start = parian_seconds();
    expect(parian_writer_begin(env, &desc, &writer), "write");
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        parian_chunk_info info = *parian_reader_chunk(reader, i);
        bool real = info.element >= PARIAN_ELEMENT_F16;
        if (codec >= 0) {
            info.codec = codec == PARIAN_CODEC_DELTA_ZSTD && real ? PARIAN_CODEC_SHUFFLE_ZSTD
                                                                  : (parian_codec)codec;
        }
        expect(parian_writer_chunk(writer, &info, data[i]), "write");
    }
    expect(parian_writer_finish(writer), "write");
    *seconds = parian_seconds() - start;
    expect(parian_reader_open(env, path, NULL, &written), "open");
    return written;
}

static void measure_codecs(const parian_env *env, const parian_reader *reader, void **data)
{
    for (int codec = PARIAN_CODEC_ZSTD; codec <= PARIAN_CODEC_DELTA_ZSTD; codec++) {
        double seconds;
        parian_reader *written = rewrite(env, reader, data, codec, LEVEL_OF_CODECS, &seconds);
        for (uint32_t i = 0; i < parian_reader_chunk_count(written); i++) {
            const parian_chunk_info *info = parian_reader_chunk(written, i);
            array_sum *sum = find_sum(parian_reader_chunk(reader, i));
            sum->stored[codec] += info->stored_size;
            sum->decoded += codec == PARIAN_CODEC_ZSTD ? info->size : 0;
        }
        parian_reader_close(written);
    }
}

static void measure_levels(const parian_env *env, const parian_reader *reader, void **data)
{
    for (int l = 0; l < LEVELS; l++) {
        double seconds;
        parian_reader *written = rewrite(env, reader, data, -1, level_of[l], &seconds);
        level_write[l] += seconds;
        level_bytes[l] += parian_reader_file_size(written);
        for (uint32_t i = 0; i < parian_reader_chunk_count(written); i++) {
            double start = parian_seconds();
            expect(parian_reader_read(written, i, data[i]), "read");
            level_read[l] += parian_seconds() - start;
            level_decoded += l == 0 ? (double)parian_reader_chunk(written, i)->size : 0;
        }
        parian_reader_close(written);
    }
}

static void measure_asset(const parian_env *env, const char *path)
{
    parian_reader *reader;
    void **data;
    expect(parian_reader_open(env, path, NULL, &reader), path);
    uint32_t count = parian_reader_chunk_count(reader);
    expect(PARIAN_NEW0(env, data, count) ? PARIAN_OK : PARIAN_E_NOMEM, path);
    for (uint32_t i = 0; i < count; i++) {
        data[i] = read_chunk(env, reader, i);
    }
    print_parts(reader, path);
    measure_codecs(env, reader, data);
    measure_levels(env, reader, data);
    for (uint32_t i = 0; i < count; i++) {
        parian_free(env, data[i]);
    }
    parian_free(env, data);
    parian_reader_close(reader);
}

static int compare_sums(const void *a, const void *b)
{
    const array_sum *x = a, *y = b;
    return (x->decoded < y->decoded) - (x->decoded > y->decoded);
}

static void print_sums(void)
{
    qsort(sums, sum_count, sizeof *sums, compare_sums);
    printf("\n| array | MB | zstd %% | shuffle %% | delta %% | written with "
           "|\n|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < sum_count && sums[i].decoded > 100000; i++) {
        const array_sum *sum = &sums[i];
        double whole = 0.01 * (double)sum->decoded;
        printf("| `%s` | %.1f | %.1f | %.1f | %.1f | %s |\n", sum->name, 1e-4 * whole,
               (double)sum->stored[1] / whole, (double)sum->stored[2] / whole,
               (double)sum->stored[3] / whole, parian_codec_name(sum->chosen));
    }
    printf("\n| level | MB | write s | read MB/s |\n|---|---|---|---|\n");
    for (int l = 0; l < LEVELS; l++) {
        printf("| %d | %.1f | %.2f | %.0f |\n", level_of[l], 1e-6 * (double)level_bytes[l],
               level_write[l], 1e-6 * level_decoded / level_read[l]);
    }
}

int main(int argc, char **argv)
{
    const parian_env *env = test_env(0);
    if (argc < 2) {
        fprintf(stderr, "usage: bench_asset_size ASSET.parian...\n");
        return 1;
    }
    printf(
        "| asset | MB | surface | texels | gutter | lists | weights | factors | million factors | "
        "bytes a channel | bytes a texel |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 1; i < argc; i++) {
        measure_asset(env, argv[i]);
    }
    print_sums();
    return 0;
}
