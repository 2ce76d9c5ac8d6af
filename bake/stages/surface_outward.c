/* surface_outward.c - turns components so that their outside is outside.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/surface_steps.h"
#include "core/memory.h"

/* An open component counts as inside out if it is nearly closed (the mean of its normals is short:
 * 0 for a closed surface, 1 for a flat sheet) and holds this share of the volume of a sphere of its
 * area, negative. */
static const double open_volume_min = 0.1, open_mean_normal_max = 0.25;

/* Tests of a point against all triangles are skipped where they would take seconds. */
static const double solid_angle_budget = 3e8;

static const double pi = 3.14159265358979323846;

typedef struct component {
    uint32_t first, count; /* triangles: in the order of `outward.order` */
    uint32_t boundary_edges;
    double area;
    double volume;      /* about the centroid */
    double mean_normal; /* its length */
    bool turn;
} component;

typedef struct outward {
    parian_mesh *mesh;
    const uint32_t *mate;
    uint32_t *order; /* [triangle_count] triangles by component */
    uint32_t *label; /* [triangle_count] */
    component *components;
    uint32_t count;
} outward;

static void gather(outward *out)
{
    uint32_t filled = 0;
    memset(out->label, 0xFF, out->mesh->triangle_count * sizeof *out->label);
    for (uint32_t seed = 0; seed < out->mesh->triangle_count; seed++) {
        if (out->label[seed] != UINT32_MAX) {
            continue;
        }
        component *made = &out->components[out->count];
        *made = (component){.first = filled};
        out->order[filled++] = seed;
        out->label[seed] = out->count;
        for (uint32_t at = made->first; at < filled; at++) {
            for (uint32_t h = 3 * out->order[at]; h < 3 * out->order[at] + 3; h++) {
                uint32_t g = out->mate[h];
                if (g == SURFACE_NO_MATE) {
                    made->boundary_edges++;
                } else if (out->label[g / 3] == UINT32_MAX) {
                    out->label[g / 3] = out->count;
                    out->order[filled++] = g / 3;
                }
            }
        }
        made->count = filled - made->first;
        out->count++;
    }
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Corners of a triangle relative to an origin. */
static void corners_from(const parian_mesh *mesh, uint32_t t, const double origin[3],
                         double corner[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            corner[i][k] = mesh->position[mesh->triangle[t][i]][k] - origin[k];
        }
    }
}

static void measure(outward *out, component *c)
{
    double centroid[3] = {0, 0, 0}, normal[3] = {0, 0, 0}, corner[3][3];
    for (uint32_t i = 0; i < c->count; i++) {
        uint32_t t = out->order[c->first + i];
        double area = 0.5 * surface_doubled_area(out->mesh, t);
        for (int k = 0; k < 3; k++) {
            for (int v = 0; v < 3; v++) {
                centroid[k] += area / 3 * out->mesh->position[out->mesh->triangle[t][v]][k];
            }
        }
        c->area += area;
    }
    for (int k = 0; k < 3; k++) {
        centroid[k] /= c->area > 0 ? c->area : 1;
    }
    for (uint32_t i = 0; i < c->count; i++) {
        corners_from(out->mesh, out->order[c->first + i], centroid, corner);
        c->volume += determinant(corner[0], corner[1], corner[2]) / 6;
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            normal[k] += 0.5 * ((corner[1][u] - corner[0][u]) * (corner[2][v] - corner[0][v]) -
                                (corner[1][v] - corner[0][v]) * (corner[2][u] - corner[0][u]));
        }
    }
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    c->mean_normal = c->area > 0 ? length / c->area : 1;
}

/* How often the other closed components wind round a point. Source: [VanOosterom83] for the solid
 * angle. */
static double winding(const outward *out, const double point[3], uint32_t except)
{
    double sum = 0;
    for (uint32_t k = 0; k < out->count; k++) {
        const component *c = &out->components[k];
        double sign = c->turn ? -1 : 1;
        if (k == except || c->boundary_edges > 0 || sign * c->volume < 0) {
            continue;
        }
        for (uint32_t i = 0; i < c->count; i++) {
            double p[3][3], length[3];
            corners_from(out->mesh, out->order[c->first + i], point, p);
            for (int v = 0; v < 3; v++) {
                length[v] = sqrt(p[v][0] * p[v][0] + p[v][1] * p[v][1] + p[v][2] * p[v][2]);
            }
            double below = length[0] * length[1] * length[2];
            for (int v = 0; v < 3; v++) {
                const double *a = p[v], *b = p[(v + 1) % 3];
                below += (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * length[(v + 2) % 3];
            }
            sum += sign * 2 * atan2(determinant(p[0], p[1], p[2]), below);
        }
    }
    return sum / (4 * pi);
}

/* Closed components: all are turned together if they hold a negative volume in sum; then each that
 * still does is turned unless it lies inside another, as the wall of a cavity does. */
static void decide_closed(outward *out, parian_surface_report *report)
{
    double total = 0, tests = 0, closed_area = 0, open_area = 0;
    for (uint32_t k = 0; k < out->count; k++) {
        const component *c = &out->components[k];
        total += c->boundary_edges == 0 ? c->volume : 0;
        *(c->boundary_edges == 0 ? &closed_area : &open_area) += c->area;
    }
    report->inverted = total < 0 && closed_area > open_area;
    for (uint32_t k = 0; k < out->count; k++) {
        out->components[k].turn = out->components[k].boundary_edges == 0 && total < 0;
    }
    for (uint32_t k = 0; k < out->count; k++) {
        component *c = &out->components[k];
        double volume = c->turn ? -c->volume : c->volume;
        if (c->boundary_edges > 0 || volume >= 0) {
            continue;
        }
        tests += out->mesh->triangle_count;
        const double *point = out->mesh->position[out->mesh->triangle[out->order[c->first]][0]];
        bool cavity = tests < solid_angle_budget && winding(out, point, k) > 0.5;
        c->turn = cavity ? c->turn : !c->turn;
    }
}

static void decide_open(outward *out)
{
    for (uint32_t k = 0; k < out->count; k++) {
        component *c = &out->components[k];
        double sphere = c->area * sqrt(c->area / pi) / 6;
        if (c->boundary_edges > 0) {
            c->turn =
                c->mean_normal < open_mean_normal_max && c->volume < -open_volume_min * sphere;
        }
    }
}

parian_result surface_face_outward(const parian_env *env, parian_mesh *mesh, const uint32_t *mate,
                                   parian_surface_report *report)
{
    outward out = {.mesh = mesh, .mate = mate};
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW(env, out.order, mesh->triangle_count) ||
        !PARIAN_NEW(env, out.label, mesh->triangle_count) ||
        !PARIAN_NEW(env, out.components, mesh->triangle_count)) {
        parian_fail(env, result, "surface: out of memory for %u triangles", mesh->triangle_count);
        goto done;
    }
    gather(&out);
    for (uint32_t k = 0; k < out.count; k++) {
        measure(&out, &out.components[k]);
    }
    decide_closed(&out, report);
    decide_open(&out);
    report->components = out.count;
    for (uint32_t k = 0; k < out.count; k++) {
        const component *c = &out.components[k];
        report->boundary_edges += c->boundary_edges;
        for (uint32_t i = 0; i < c->count && c->turn; i++) {
            surface_turn_triangle(mesh, out.order[c->first + i]);
        }
        report->flipped_triangles += c->turn ? c->count : 0;
    }
    report->closed = report->boundary_edges == 0;
    result = PARIAN_OK;
done:
    parian_free(env, out.order);
    parian_free(env, out.label);
    parian_free(env, out.components);
    return result;
}
