/* vertex_frame.c - the transfer surface seen from its vertices: areas, fans, normals, coordinate
 * arrays.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "core/clones.h"
#include "core/lanes.h"
#include "core/memory.h"
#include "core/small_maths.h"
#include "core/vertex_frame.h"

static double corner_angle(const double a[3], const double b[3])
{
    double n[3];
    parian_cross3(a, b, n);
    return atan2(sqrt(parian_dot3(n, n)), parian_dot3(a, b));
}

/* Add a triangle to the sums of its corners. Linear interpolation over a triangle with edges l
 * exceeds a smooth function by (l1^2 + l2^2 + l3^2) / 48 times its Laplacian, on the average. */
static void add_triangle(const parian_body *body, uint32_t t, parian_vertex_frame *frame,
                         double (*normal)[3], double (*sum)[2])
{
    const uint32_t *corner = body->triangle[t];
    double edge[3][3], squares = 0, n[3];
    for (int k = 0; k < 3; k++) {
        parian_sub3(body->vertex_position[corner[(k + 1) % 3]], body->vertex_position[corner[k]],
                    edge[k]);
        squares += parian_dot3(edge[k], edge[k]);
    }
    parian_cross3(edge[0], edge[1], n);
    double length = sqrt(parian_dot3(n, n)), area = 0.5 * length;
    frame->triangle_area[t] = (float)area;
    for (int k = 0; k < 3; k++) {
        double back[3] = {-edge[(k + 2) % 3][0], -edge[(k + 2) % 3][1], -edge[(k + 2) % 3][2]};
        double angle = length > 0 ? corner_angle(edge[k], back) / length : 0;
        for (int j = 0; j < 3; j++) {
            normal[corner[k]][j] += angle * n[j];
        }
        sum[corner[k]][0] += area;
        sum[corner[k]][1] += area * squares / 48;
    }
}

static void finish_vertices(const parian_body *body, parian_vertex_frame *frame,
                            double (*normal)[3], double (*sum)[2])
{
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        double length = sqrt(parian_dot3(normal[v], normal[v]));
        frame->area[v] = (float)(sum[v][0] / 3);
        frame->bias[v] = sum[v][0] > 0 ? (float)(sum[v][1] / sum[v][0]) : 0;
        frame->bias_max = fmaxf(frame->bias_max, frame->bias[v]);
        for (int k = 0; k < 3; k++) {
            frame->normal[v][k] = length > 0 ? (float)(normal[v][k] / length) : k == 2;
        }
    }
}

static void make_fans(const parian_body *body, parian_vertex_frame *frame)
{
    uint32_t *offset = frame->fan_offset;
    memset(offset, 0, ((size_t)body->vertex_count + 1) * sizeof *offset);
    for (size_t i = 0; i < (size_t)body->triangle_count * 3; i++) {
        offset[body->triangle[i / 3][i % 3] + 1]++;
    }
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        offset[v + 1] += offset[v];
    }
    for (size_t i = 0; i < (size_t)body->triangle_count * 3; i++) {
        frame->fan[offset[body->triangle[i / 3][i % 3]]++] = (uint32_t)(i / 3);
    }
    memmove(offset + 1, offset, body->vertex_count * sizeof *offset);
    offset[0] = 0;
}

parian_result parian_vertex_frame_make(const parian_env *env, const parian_body *body,
                                       parian_vertex_frame *frame)
{
    size_t vertices = body->vertex_count, triangles = body->triangle_count;
    size_t padded = (vertices + 15) & ~(size_t)15;
    double(*normal)[3] = NULL, (*sum)[2] = NULL;
    parian_result result = PARIAN_E_NOMEM;
    memset(frame, 0, sizeof *frame);
    if (vertices == 0 || triangles == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "a transfer surface without triangles");
    }
    if (!PARIAN_NEW0(env, frame->area, padded) || !PARIAN_NEW0(env, frame->bias, padded) ||
        !PARIAN_NEW(env, frame->normal, vertices) || !PARIAN_NEW0(env, normal, vertices) ||
        !PARIAN_NEW0(env, sum, vertices) || !PARIAN_NEW(env, frame->triangle_area, triangles) ||
        !PARIAN_NEW(env, frame->fan_offset, vertices + 1) ||
        !PARIAN_NEW(env, frame->fan, triangles * 3)) {
        parian_fail(env, result, "no memory for the areas of %zu vertices", vertices);
        goto done;
    }
    for (uint32_t t = 0; t < triangles; t++) {
        add_triangle(body, t, frame, normal, sum);
    }
    finish_vertices(body, frame, normal, sum);
    make_fans(body, frame);
    result = parian_point_arrays_make(env, body->vertex_position, frame->normal, body->vertex_count,
                                      &frame->points);
done:
    parian_free(env, normal);
    parian_free(env, sum);
    if (result != PARIAN_OK) {
        parian_vertex_frame_free(env, frame);
    }
    return result;
}

void parian_vertex_frame_free(const parian_env *env, parian_vertex_frame *frame)
{
    parian_free(env, frame->area);
    parian_free(env, frame->bias);
    parian_free(env, frame->normal);
    parian_free(env, frame->triangle_area);
    parian_free(env, frame->fan_offset);
    parian_free(env, frame->fan);
    parian_point_arrays_free(env, &frame->points);
    memset(frame, 0, sizeof *frame);
}

parian_result parian_row_make(const parian_env *env, const parian_vertex_frame *frame,
                              parian_row *row)
{
    size_t padded = frame->points.padded;
    if (!PARIAN_NEW(env, row->base, padded * 4)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a row of %zu factors", padded);
    }
    row->r2 = row->base;
    for (int c = 0; c < 3; c++) {
        row->value[c] = row->base + (size_t)(c + 1) * padded;
    }
    return PARIAN_OK;
}

void parian_row_free(const parian_env *env, parian_row *row)
{
    parian_free(env, row->base);
    memset(row, 0, sizeof *row);
}

PARIAN_CLONES
double parian_row_dot(const float *weight, const float *value, uint32_t padded)
{
    parian_lanes w, v, lane = {0};
    for (uint32_t i = 0; i < padded; i += 16) {
        PARIAN_LANES_LOAD(w, weight + i);
        PARIAN_LANES_LOAD(v, value + i);
        lane += w * v;
    }
    double sum = 0;
    for (int k = 0; k < 16; k++) {
        sum += lane[k];
    }
    return sum;
}
