/* path_medium.c - coefficients of a medium that varies on a grid of nodes: their value, bounds and
 * integral.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_medium.h"

#include "core/memory.h"

static size_t node_count(const parian_medium_field *field)
{
    return (size_t)field->size[0] * field->size[1] * field->size[2];
}

parian_path_medium parian_path_medium_make(const parian_reference_body *body, int channel)
{
    parian_path_medium m = {.walk = parian_walk_medium_make(&body->medium, channel),
                            .field = body->field,
                            .channel = channel};
    m.majorant = m.minorant = m.mean = m.walk.sigma_t;
    if (body->field) {
        const parian_medium_field *field = body->field;
        double sum = 0;
        m.majorant = 0;
        m.minorant = INFINITY;
        for (size_t i = 0; i < node_count(field); i++) {
            double t = (double)field->sigma_s[i][channel] + (double)field->sigma_a[i][channel];
            m.majorant = fmax(m.majorant, t);
            m.minorant = fmin(m.minorant, t);
            sum += t;
        }
        m.mean = sum / (double)node_count(field);
        m.majorant *= 1 + 1e-12; /* the trilinear value may exceed the nodes' by rounding */
    }
    return m;
}

static bool is_coefficient(double sigma)
{
    return sigma >= 0 && sigma < 1e15;
}

static parian_result check_field(const parian_env *env, const parian_reference_body *body)
{
    const parian_medium_field *field = body->field;
    for (int k = 0; k < 3; k++) {
        if (field->size[k] < 2 || field->size[k] > 4096 || !(field->upper[k] > field->lower[k])) {
            return parian_fail(
                env, PARIAN_E_ARGUMENT,
                "field of \"%s\": %u nodes from %g to %g m along axis %d, expected 2 to 4096 "
                "in an ascending box",
                body->name, field->size[k], field->lower[k], field->upper[k], k);
        }
    }
    for (size_t i = 0; i < node_count(field); i++) {
        for (int c = 0; c < 3; c++) {
            if (!is_coefficient((double)field->sigma_s[i][c]) ||
                !is_coefficient((double)field->sigma_a[i][c])) {
                return parian_fail(
                    env, PARIAN_E_ARGUMENT,
                    "field of \"%s\": sigma_s %g, sigma_a %g m^-1 at node %zu, channel %d, "
                    "expected 0 to 1e15",
                    body->name, (double)field->sigma_s[i][c], (double)field->sigma_a[i][c], i, c);
            }
        }
    }
    return PARIAN_OK;
}

parian_result parian_path_medium_check(const parian_env *env, const parian_reference_body *body)
{
    for (int c = 0; c < 3; c++) {
        const parian_medium *m = &body->medium;
        double g = m->reduced_only ? 0 : m->g[c];
        if (!is_coefficient(m->sigma_s_prime[c]) || !is_coefficient(m->sigma_a[c]) ||
            !(g > -1 && g < 1) || !(m->eta > 0.1 && m->eta < 10)) {
            return parian_fail(
                env, PARIAN_E_ARGUMENT,
                "medium of \"%s\": sigma_s' %g, sigma_a %g m^-1, g %g, eta %g in channel %d, "
                "expected coefficients of 0 to 1e15, |g| < 1, eta from 0.1 to 10",
                body->name, m->sigma_s_prime[c], m->sigma_a[c], g, m->eta, c);
        }
    }
    return body->field ? check_field(env, body) : PARIAN_OK;
}

/* x in units of nodes, held inside the grid. */
static void to_grid(const parian_medium_field *field, const double x[3], double grid[3])
{
    for (int k = 0; k < 3; k++) {
        double last = (double)(field->size[k] - 1);
        double u = (x[k] - field->lower[k]) / (field->upper[k] - field->lower[k]) * last;
        grid[k] = u < 0 ? 0 : u > last ? last : u;
    }
}

typedef struct grid_place {
    size_t first, step[3];
    double part[3];
} grid_place;

static grid_place place_in_grid(const parian_medium_field *field, const double grid[3])
{
    grid_place at = {.step = {1, field->size[0], (size_t)field->size[0] * field->size[1]}};
    for (int k = 0; k < 3; k++) {
        uint32_t cell = (uint32_t)grid[k];
        cell = cell > field->size[k] - 2 ? field->size[k] - 2 : cell;
        at.part[k] = grid[k] - (double)cell;
        at.first += cell * at.step[k];
    }
    return at;
}

static double interpolate(const grid_place *at, const float (*value)[3], int channel)
{
    double plane[2];
    for (int z = 0; z < 2; z++) {
        double row[2];
        for (int y = 0; y < 2; y++) {
            size_t i = at->first + (size_t)y * at->step[1] + (size_t)z * at->step[2];
            double a = (double)value[i][channel], b = (double)value[i + 1][channel];
            row[y] = a + (b - a) * at->part[0];
        }
        plane[z] = row[0] + (row[1] - row[0]) * at->part[1];
    }
    return plane[0] + (plane[1] - plane[0]) * at->part[2];
}

void parian_path_medium_at(const parian_path_medium *medium, const double x[3], double *sigma_s,
                           double *sigma_a)
{
    if (!medium->field) {
        *sigma_s = medium->walk.sigma_s;
        *sigma_a = medium->walk.sigma_a;
        return;
    }
    double grid[3];
    to_grid(medium->field, x, grid);
    grid_place at = place_in_grid(medium->field, grid);
    *sigma_s = interpolate(&at, (const float(*)[3])medium->field->sigma_s, medium->channel);
    *sigma_a = interpolate(&at, (const float(*)[3])medium->field->sigma_a, medium->channel);
}

static double sigma_t_along(const parian_path_medium *medium, const double x[3],
                            const double direction[3], double t)
{
    double at[3], sigma_s, sigma_a;
    for (int k = 0; k < 3; k++) {
        at[k] = x[k] + t * direction[k];
    }
    parian_path_medium_at(medium, at, &sigma_s, &sigma_a);
    return sigma_s + sigma_a;
}

/* The next t above `from` at which the ray passes a plane of nodes; the end where there is none. */
typedef struct grid_planes {
    double next[3], step[3];
    uint32_t left[3]; /* planes still ahead */
} grid_planes;

static grid_planes planes_ahead(const parian_medium_field *field, const double x[3],
                                const double direction[3])
{
    grid_planes p = {.next = {INFINITY, INFINITY, INFINITY}};
    for (int k = 0; k < 3; k++) {
        double last = (double)(field->size[k] - 1);
        double pitch = (field->upper[k] - field->lower[k]) / last;
        double u = (x[k] - field->lower[k]) / pitch, speed = direction[k] / pitch;
        if (speed == 0) {
            continue;
        }
        double plane = speed > 0 ? floor(u) + 1 : ceil(u) - 1;
        plane = speed > 0 ? fmax(plane, 0) : fmin(plane, last);
        double count = speed > 0 ? last - plane + 1 : plane + 1;
        if (count >= 1) {
            p.left[k] = (uint32_t)count;
            p.next[k] = (plane - u) / speed;
            p.step[k] = 1 / fabs(speed);
        }
    }
    return p;
}

static double pass_plane(grid_planes *p, double end)
{
    int k = p->next[0] < p->next[1] ? 0 : 1;
    k = p->next[2] < p->next[k] ? 2 : k;
    double t = p->next[k];
    if (!(t < end)) {
        return end;
    }
    p->next[k] = --p->left[k] > 0 ? t + p->step[k] : INFINITY;
    return t;
}

double parian_path_medium_depth(const parian_path_medium *medium, const double x[3],
                                const double direction[3], double length)
{
    static const double node[2] = {0.21132486540518712, 0.78867513459481288};
    if (!medium->field) {
        return medium->walk.sigma_t * length;
    }
    grid_planes planes = planes_ahead(medium->field, x, direction);
    double sum = 0;
    for (double from = 0; from < length;) {
        double to = pass_plane(&planes, length), span = to - from;
        for (int i = 0; i < 2 && span > 0; i++) {
            sum += 0.5 * span * sigma_t_along(medium, x, direction, from + node[i] * span);
        }
        from = fmax(from, to);
        if (to >= length) {
            break;
        }
    }
    return sum;
}
