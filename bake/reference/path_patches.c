/* path_patches.c - the discs around receivers that gather photons: found by place, measured by
 * clipping.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_parts.h"

#include "bake/reference/vec3d.h"
#include "core/memory.h"

/* A patch is the surface of the receiver's body within its radius that looks the same way. */
static const double SAME_SIDE = 0.3;
enum { PATCH_CELLS_MAX = 96 }; /* along an axis */

void parian_path_patches_free(path_scene *path)
{
    parian_free(path->env, path->patches.first);
    parian_free(path->env, path->patches.member);
    parian_free(path->env, path->patches.area);
    path->patches = (path_patches){0};
}

static void cell_range(const path_patches *p, const double low[3], const double high[3],
                       uint32_t from[3], uint32_t to[3])
{
    for (int k = 0; k < 3; k++) {
        double last = (double)(p->size[k] - 1);
        from[k] = (uint32_t)fmin(fmax((low[k] - p->lower[k]) * p->inverse, 0), last);
        to[k] = (uint32_t)fmin(fmax((high[k] - p->lower[k]) * p->inverse, 0), last);
    }
}

static size_t cell_of(const path_patches *p, const double x[3])
{
    uint32_t from[3], to[3];
    cell_range(p, x, x, from, to);
    return ((size_t)from[2] * p->size[1] + from[1]) * p->size[0] + from[0];
}

typedef void (*member_visit)(void *context, size_t receiver);

static void visit_box(const path_patches *p, const double low[3], const double high[3],
                      member_visit visit, void *context)
{
    uint32_t from[3], to[3];
    cell_range(p, low, high, from, to);
    for (uint32_t z = from[2]; z <= to[2]; z++) {
        for (uint32_t y = from[1]; y <= to[1]; y++) {
            size_t row = ((size_t)z * p->size[1] + y) * p->size[0];
            for (uint32_t i = p->first[row + from[0]]; i < p->first[row + to[0] + 1]; i++) {
                visit(context, p->member[i]);
            }
        }
    }
}

typedef struct place_query {
    const path_scene *path;
    uint32_t body;
    const double *position, *normal;
    path_patch_found found;
    void *context;
} place_query;

static void test_member(void *context, size_t receiver)
{
    const place_query *q = context;
    const parian_receivers *r = q->path->receivers;
    double to[3];
    vec3d_sub(to, r->position[receiver], q->position);
    double radius = q->path->patches.radius;
    if (r->body[receiver] == q->body && vec3d_dot(to, to) < radius * radius &&
        vec3d_dot(r->normal[receiver], q->normal) > SAME_SIDE) {
        q->found(q->context, receiver);
    }
}

void parian_path_patches_at(const path_scene *path, uint32_t body, const double position[3],
                            const double normal[3], path_patch_found found, void *context)
{
    place_query q = {path, body, position, normal, found, context};
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = position[k] - path->patches.radius;
        high[k] = position[k] + path->patches.radius;
    }
    visit_box(&path->patches, low, high, test_member, &q);
}

/* Signed area of the part of a disc around the origin that the triangle (origin, a, b) covers, in
 * the plane. */
static double disc_corner_area(double radius, const double a[2], const double b[2])
{
    double d[2] = {b[0] - a[0], b[1] - a[1]};
    double dd = d[0] * d[0] + d[1] * d[1], ad = a[0] * d[0] + a[1] * d[1];
    double aa = a[0] * a[0] + a[1] * a[1], turn = a[0] * b[1] - a[1] * b[0];
    if (!(dd > 0)) {
        return 0;
    }
    double root = ad * ad - dd * (aa - radius * radius), r2 = radius * radius;
    double low = 1, high = 0; /* the part of the edge inside the disc, as shares of its length */
    if (root > 0) {
        low = fmin(fmax((-ad - sqrt(root)) / dd, 0), 1);
        high = fmin(fmax((-ad + sqrt(root)) / dd, 0), 1);
    }
    if (!(low < high)) {
        return 0.5 * r2 * atan2(turn, a[0] * b[0] + a[1] * b[1]);
    }
    double p[2] = {a[0] + low * d[0], a[1] + low * d[1]};
    double q[2] = {a[0] + high * d[0], a[1] + high * d[1]};
    double before = low > 0 ? atan2(a[0] * p[1] - a[1] * p[0], a[0] * p[0] + a[1] * p[1]) : 0;
    double after = high < 1 ? atan2(q[0] * b[1] - q[1] * b[0], q[0] * b[0] + q[1] * b[1]) : 0;
    return 0.5 * (r2 * (before + after) + (p[0] * q[1] - p[1] * q[0]));
}

/* Area of the part of a triangle within radius of x. */
static double area_within(const double *const corner[3], const double x[3], double radius)
{
    double a[3], b[3], normal[3], to[3], flat[3][2], axis[2][3], sum = 0;
    vec3d_sub(a, corner[1], corner[0]);
    vec3d_sub(b, corner[2], corner[0]);
    vec3d_cross(normal, a, b);
    if (!(vec3d_normalize(normal) > 0) || !(vec3d_normalize(a) > 0)) {
        return 0;
    }
    vec3d_copy(axis[0], a);
    vec3d_cross(axis[1], normal, axis[0]);
    vec3d_sub(to, corner[0], x);
    double height = vec3d_dot(to, normal), left = radius * radius - height * height;
    if (!(left > 0)) {
        return 0;
    }
    for (int i = 0; i < 3; i++) {
        vec3d_sub(to, corner[i], x);
        flat[i][0] = vec3d_dot(to, axis[0]);
        flat[i][1] = vec3d_dot(to, axis[1]);
    }
    for (int i = 0; i < 3; i++) {
        sum += disc_corner_area(sqrt(left), flat[i], flat[(i + 1) % 3]);
    }
    return fabs(sum);
}

typedef struct triangle_query {
    path_scene *path;
    uint32_t body;
    const double *corner[3];
    double normal[3];
} triangle_query;

static void add_area(void *context, size_t receiver)
{
    triangle_query *q = context;
    const parian_receivers *r = q->path->receivers;
    if (r->body[receiver] == q->body && vec3d_dot(r->normal[receiver], q->normal) > SAME_SIDE) {
        q->path->patches.area[receiver] +=
            area_within(q->corner, r->position[receiver], q->path->patches.radius);
    }
}

static void measure_triangle(path_scene *path, uint32_t body, uint32_t triangle)
{
    triangle_query q = {.path = path, .body = body};
    double low[3], high[3], a[3], b[3];
    for (int i = 0; i < 3; i++) {
        q.corner[i] = path_corner(path, body, triangle, i);
    }
    for (int k = 0; k < 3; k++) {
        const double radius = path->patches.radius;
        low[k] = fmin(q.corner[0][k], fmin(q.corner[1][k], q.corner[2][k])) - radius;
        high[k] = fmax(q.corner[0][k], fmax(q.corner[1][k], q.corner[2][k])) + radius;
    }
    vec3d_sub(a, q.corner[1], q.corner[0]);
    vec3d_sub(b, q.corner[2], q.corner[0]);
    vec3d_cross(q.normal, a, b);
    vec3d_normalize(q.normal);
    visit_box(&path->patches, low, high, add_area, &q);
}

static void lay_cells(path_patches *p, const parian_receivers *r)
{
    double upper[3], extent = 0;
    for (int k = 0; k < 3; k++) {
        p->lower[k] = INFINITY;
        upper[k] = -INFINITY;
        for (size_t i = 0; i < r->count; i++) {
            p->lower[k] = fmin(p->lower[k], r->position[i][k]);
            upper[k] = fmax(upper[k], r->position[i][k]);
        }
        extent = fmax(extent, upper[k] - p->lower[k]);
    }
    double cell = fmax(p->radius, extent / PATCH_CELLS_MAX);
    p->inverse = 1 / cell;
    for (int k = 0; k < 3; k++) {
        p->size[k] = (uint32_t)((upper[k] - p->lower[k]) * p->inverse) + 1;
    }
}

parian_result parian_path_patches_make(path_scene *path, double radius)
{
    path_patches *p = &path->patches;
    const parian_receivers *r = path->receivers;
    p->radius = radius;
    lay_cells(p, r);
    size_t cells = (size_t)p->size[0] * p->size[1] * p->size[2];
    if (!PARIAN_NEW0(path->env, p->first, cells + 1) ||
        !PARIAN_NEW(path->env, p->member, r->count) || !PARIAN_NEW0(path->env, p->area, r->count)) {
        return parian_fail(path->env, PARIAN_E_NOMEM, "no memory for %zu patches", r->count);
    }
    for (size_t i = 0; i < r->count; i++) {
        p->first[cell_of(p, r->position[i])]++;
    }
    uint32_t sum = 0;
    for (size_t c = 0; c <= cells;
         c++) { /* ends of the cells: filling from behind makes them starts */
        sum += p->first[c];
        p->first[c] = sum;
    }
    for (size_t i = r->count; i-- > 0;) {
        p->member[--p->first[cell_of(p, r->position[i])]] = (uint32_t)i;
    }
    for (uint32_t t = 0; t < path->triangle_total; t++) {
        uint32_t body = path->triangle_body[t];
        measure_triangle(path, body, t - path->body[body].first_triangle);
    }
    return PARIAN_OK;
}
