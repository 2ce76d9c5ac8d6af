/* inspect_summary.c - lengths, sizes and memory of a body, as info shows them.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "inspect/inspect.h"

const char *const inspect_local_form_names[] = {"none", "rebuilt", "f16", "u8", "split", "only"};
const char *const inspect_local_form_texts[] = {
    "none: the global part alone",
    "kernels rebuilt at load",
    "kernels stored as fp16",
    "kernels stored as bytes with scales",
    "smooth split, rebuilt by distance",
    "full kernels rebuilt at load, no global part",
};

static void measure_box(const parian_body *body, double extent_m[3])
{
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t i = 0; i < body->vertex_count; i++) {
            low = fmin(low, body->vertex_position[i][k]);
            high = fmax(high, body->vertex_position[i][k]);
        }
        extent_m[k] = body->vertex_count ? high - low : 0;
    }
}

static double mean_edge(const parian_body *body)
{
    double sum = 0;
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        for (int c = 0; c < 3; c++) {
            const float *a = body->vertex_position[body->triangle[t][c]];
            const float *b = body->vertex_position[body->triangle[t][(c + 1) % 3]];
            sum += sqrt(pow((double)a[0] - b[0], 2) + pow((double)a[1] - b[1], 2) +
                        pow((double)a[2] - b[2], 2));
        }
    }
    return body->triangle_count ? sum / (3.0 * body->triangle_count) : 0;
}

/* Textures of the runtime: E, B and its parts, positions, normals, areas over the atlas at 16
 * bytes; kernels, factors and weights as halves; what leads to them as 32-bit indices. */
static uint64_t estimate_gpu_bytes(const parian_body *body, const body_summary *summary)
{
    uint64_t atlas = (uint64_t)body->atlas_size * body->atlas_size, texels = body->texel_count;
    uint64_t border_entries = body->border_offset[body->border_count];
    uint64_t taps =
        (texels - body->border_count) * body->kernel_width * body->kernel_width + border_entries;
    uint64_t bytes =
        atlas * (6 * 16 + 4) + texels * 4 + border_entries * 4 + (uint64_t)body->gutter_count * 36;
    bytes +=
        (uint64_t)body->triangle_count * 3 * (12 + 12 + 8) + (uint64_t)body->vertex_count * 3 * 16;
    bytes += summary->factor_count * 6 + summary->run_count * 12;
    if (body->local_form != PARIAN_LOCAL_NONE) {
        bytes += taps * 6;
    }
    return bytes + (body->blend_weight ? texels * 18 : 0);
}

void inspect_summarise(const parian_body *body, body_summary *summary)
{
    double entries = (double)body->vertex_count * body->vertex_count;
    memset(summary, 0, sizeof *summary);
    for (int c = 0; c < 3; c++) {
        double sigma_t = body->medium.sigma_s_prime[c] + body->medium.sigma_a[c];
        summary->mean_free_path_m[c] = 1 / sigma_t;
        summary->diffusion_length_m[c] = 1 / sqrt(3 * body->medium.sigma_a[c] * sigma_t);
    }
    measure_box(body, summary->extent_m);
    for (uint32_t i = 0; i < body->texel_count; i++) {
        summary->area_m2 += body->texel_area[i];
    }
    summary->texel_edge_m = body->texel_count ? sqrt(summary->area_m2 / body->texel_count) : 0;
    summary->vertex_edge_m = mean_edge(body);
    for (uint32_t i = 0; i < body->operator_count; i++) {
        const parian_operator *op = &body->operators[i];
        summary->factor_count += op->factor_total;
        summary->run_count += op->run_total;
    }
    summary->kept_share = entries > 0 ? (double)summary->factor_count / entries : 0;
    summary->gpu_bytes = estimate_gpu_bytes(body, summary);
}

double inspect_longest(const double extent_m[3])
{
    return fmax(extent_m[0], fmax(extent_m[1], extent_m[2]));
}

static size_t part_of(const char *name)
{
    static const struct {
        const char *prefix;
        size_t part;
    } table[] = {{"vertex.", 0},   {"triangle.", 0},   {"corner.", 0}, {"texel.", 1},
                 {"gutter.", 2},   {"border.", 3},     {"local.", 4},  {"blend.", 5},
                 {"operator.", 6}, {"surrounding.", 7}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        if (strncmp(name, table[i].prefix, strlen(table[i].prefix)) == 0) {
            return table[i].part;
        }
    }
    return 8;
}

void inspect_part_sizes(const parian_reader *reader, part_sizes *parts)
{
    static const char *const names[INSPECT_PART_MAX] = {"surface",
                                                        "texels",
                                                        "gutter",
                                                        "border lists",
                                                        "local kernels",
                                                        "blending weights",
                                                        "throughput factors",
                                                        "surroundings",
                                                        "settings, texts, table"};
    uint64_t stored = 0;
    memset(parts, 0, sizeof *parts);
    parts->count = INSPECT_PART_MAX;
    memcpy(parts->name, names, sizeof names);
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        const parian_chunk_info *info = parian_reader_chunk(reader, i);
        size_t part = part_of(info->name);
        parts->stored[part] += info->stored_size;
        parts->decoded[part] += info->size;
        stored += info->stored_size;
    }
    parts->stored[INSPECT_PART_MAX - 1] += parian_reader_file_size(reader) - stored;
}
