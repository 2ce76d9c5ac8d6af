/* bench_asset_io.c - bytes and seconds of throughput factors and kernels by codec: what chose the
 * codecs.
 *
 * Rows of exp(-sigma_tr r) / r over a sphere's vertices, scaled by a power of two per row, as fp16
 * RGB: the bytes of a real asset's factor array. Prints a table; never passes or fails on time.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"
#include "parian/format.h"
#include "support/test_support.h"
#include "tool/session.h"

enum { CUTS = 20 };

static void fill_row(const parian_mesh *mesh, uint32_t row, parian_half (*out)[3])
{
    static const double sigma_tr_per_m[3] = {110, 160, 210};
    float largest = 0;
    for (int pass = 0; pass < 2; pass++) {
        float scale = largest > 0 ? ldexpf(1, -ilogbf(largest)) : 1;
        for (uint32_t column = 0; column < mesh->vertex_count; column++) {
            double square = 1e-8;
            for (int k = 0; k < 3; k++) {
                double step = mesh->position[row][k] - mesh->position[column][k];
                square += step * step;
            }
            for (int c = 0; c < 3; c++) {
                double r = sqrt(square);
                float value = row == column ? 0 : (float)(exp(-sigma_tr_per_m[c] * r) / r);
                largest = fmaxf(largest, pass == 0 ? value : 0);
                out[column][c] = parian_half_from_float(value * scale);
            }
        }
    }
}

static void run(const parian_env *env, parian_codec codec, int level, const void *data,
                uint64_t rows, void *back)
{
    const char *path = test_scratch("bench.parian");
    parian_writer *writer;
    parian_reader *reader;
    parian_chunk_info info = {
        .name = "operator.factor", .element = PARIAN_ELEMENT_F16, .codec = codec, .rank = 2};
    info.shape[0] = rows;
    info.shape[1] = 3;
    parian_writer_desc desc = {.path = path, .compression_level = level};
    double start = parian_seconds();
    if (parian_writer_begin(env, &desc, &writer) != PARIAN_OK ||
        parian_writer_chunk(writer, &info, data) != PARIAN_OK ||
        parian_writer_finish(writer) != PARIAN_OK ||
        parian_reader_open(env, path, NULL, &reader) != PARIAN_OK) {
        exit(1);
    }
    double written = parian_seconds();
    parian_result result = parian_reader_read(reader, 0, back);
    double read = parian_seconds();
    const parian_chunk_info *stored = parian_reader_chunk(reader, 0);
    printf("%-14s level %d %8.1f MB -> %10.1f MB (%5.1f %%)  write %6.2f s  read %6.3f s\n",
           parian_codec_name(codec), level, (double)stored->size * 1e-6,
           (double)stored->stored_size * 1e-6,
           100.0 * (double)stored->stored_size / (double)stored->size, written - start,
           read - written);
    parian_reader_close(reader);
    if (result != PARIAN_OK) {
        exit(1);
    }
}

int main(void)
{
    const parian_env *env = test_env(0);
    parian_mesh mesh = {0};
    parian_half(*factor)[3], (*back)[3];
    if (test_sphere(env, 0.02, CUTS, &mesh) != PARIAN_OK) {
        return 1;
    }
    for (uint32_t i = 0; i < mesh.vertex_count; i++) { /* no two distances are the same */
        for (int k = 0; k < 3; k++) {
            mesh.position[i][k] += 2e-4 * sin(12.9898 * i + 78.233 * k);
        }
    }
    uint64_t count = (uint64_t)mesh.vertex_count * mesh.vertex_count;
    if (!PARIAN_NEW(env, factor, count) || !PARIAN_NEW0(env, back, count)) {
        return 1;
    }
    for (uint32_t row = 0; row < mesh.vertex_count; row++) {
        fill_row(&mesh, row, factor + (uint64_t)row * mesh.vertex_count);
    }
    memset(back, 1, count * sizeof *back); /* its pages are there before the clock runs */
    for (int level = 1; level <= 3; level += 2) {
        for (int codec = PARIAN_CODEC_RAW; codec <= PARIAN_CODEC_SHUFFLE_ZSTD; codec++) {
            run(env, (parian_codec)codec, level, factor, count, back);
        }
    }
    parian_free(env, factor);
    parian_free(env, back);
    parian_mesh_free(env, &mesh);
    return 0;
}
