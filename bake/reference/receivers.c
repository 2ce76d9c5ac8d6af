/* receivers.c - places on bodies: spread evenly by area, or nearest to points.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>

#include "bake/adapters/cgal_closest.h"
#include "bake/reference/reference_scene.h"
#include "bake/reference/vec3d.h"
#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

/* Nearest places keep this share of a triangle away from its edges, where a ray could not tell the
 * sides. */
static const double RIM_SHARE = 1e-6;
/* Of the bodies' width: points farther from any surface than this are worth a warning. */
static const double FAR_SHARE = 0.1;

static parian_result allocate_receivers(const parian_env *env, size_t count,
                                        parian_receivers *receivers)
{
    *receivers = (parian_receivers){.count = count};
    if (!PARIAN_NEW0(env, receivers->position, count) ||
        !PARIAN_NEW0(env, receivers->normal, count) ||
        !PARIAN_NEW0(env, receivers->smooth_normal, count) ||
        !PARIAN_NEW0(env, receivers->area, count) || !PARIAN_NEW0(env, receivers->body, count) ||
        !PARIAN_NEW0(env, receivers->triangle, count) ||
        !PARIAN_NEW0(env, receivers->barycentric, count)) {
        parian_receivers_free(env, receivers);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu receivers", count);
    }
    return PARIAN_OK;
}

/* Position and normals of a place whose triangle and barycentrics are known. A triangle without
 * area has the smooth normal, and where that vanishes the triangle's stands in. */
static void complete_receiver(const parian_reference_scene *scene, parian_receivers *receivers,
                              size_t i)
{
    const parian_mesh *mesh = &scene->bodies[receivers->body[i]].mesh;
    const uint32_t triangle = receivers->triangle[i], *corner = mesh->triangle[triangle];
    double *position = receivers->position[i], *normal = receivers->normal[i];
    double *smooth = receivers->smooth_normal[i], u[3], v[3];
    for (int k = 0; k < 3; k++) {
        double corner_normal[3];
        vec3d_from_float(corner_normal, mesh->corner_normal[triangle][k]);
        vec3d_add_scaled(position, mesh->position[corner[k]], receivers->barycentric[i][k]);
        vec3d_add_scaled(smooth, corner_normal, receivers->barycentric[i][k]);
    }
    vec3d_sub(u, mesh->position[corner[1]], mesh->position[corner[0]]);
    vec3d_sub(v, mesh->position[corner[2]], mesh->position[corner[0]]);
    vec3d_cross(normal, u, v);
    bool flat = vec3d_normalize(normal) > 0, round = vec3d_normalize(smooth) > 1e-9;
    if (!round) {
        vec3d_copy(smooth, normal);
    }
    if (!flat) {
        vec3d_copy(normal, smooth);
    }
}

/* ---- spread ---- */

/* All triangles of all bodies in a row that follows the surface, and the running sum of their
 * areas. */
typedef struct area_row {
    size_t count;
    uint32_t *body, *triangle; /* [count] */
    double *sum;               /* [count] area of this and those before, m^2 */
} area_row;

static void free_row(const parian_env *env, area_row *row)
{
    parian_free(env, row->body);
    parian_free(env, row->triangle);
    parian_free(env, row->sum);
}

static double triangle_area(const parian_mesh *mesh, uint32_t triangle)
{
    const uint32_t *corner = mesh->triangle[triangle];
    double u[3], v[3], normal[3];
    vec3d_sub(u, mesh->position[corner[1]], mesh->position[corner[0]]);
    vec3d_sub(v, mesh->position[corner[2]], mesh->position[corner[0]]);
    vec3d_cross(normal, u, v);
    return 0.5 * vec3d_length(normal);
}

/* Append one body's triangles along a curve through their centres. */
static parian_result append_body(const parian_env *env, const parian_mesh *mesh, uint32_t body,
                                 area_row *row)
{
    double(*centre)[3] = NULL, sum = row->count > 0 ? row->sum[row->count - 1] : 0;
    uint32_t *order = NULL;
    parian_result r = PARIAN_E_NOMEM;
    if (!PARIAN_NEW0(env, centre, mesh->triangle_count) ||
        !PARIAN_NEW(env, order, mesh->triangle_count)) {
        parian_fail(env, r, "no memory to order %u triangles", mesh->triangle_count);
        goto cleanup;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            vec3d_add_scaled(centre[t], mesh->position[mesh->triangle[t][k]], 1.0 / 3);
        }
    }
    r = parian_transfer_curve(env, mesh->triangle_count, (const double(*)[3])centre, order);
    for (uint32_t i = 0; r == PARIAN_OK && i < mesh->triangle_count; i++) {
        sum += triangle_area(mesh, order[i]);
        row->body[row->count] = body;
        row->triangle[row->count] = order[i];
        row->sum[row->count++] = sum;
    }
cleanup:
    parian_free(env, order);
    parian_free(env, centre);
    return r;
}

static parian_result make_row(const parian_env *env, const parian_reference_scene *scene,
                              area_row *row)
{
    size_t total = 0;
    for (uint32_t b = 0; b < scene->body_count; b++) {
        total += scene->bodies[b].mesh.triangle_count;
    }
    if (!PARIAN_NEW(env, row->body, total) || !PARIAN_NEW(env, row->triangle, total) ||
        !PARIAN_NEW(env, row->sum, total)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the areas of %zu triangles", total);
    }
    parian_result r = PARIAN_OK;
    for (uint32_t b = 0; r == PARIAN_OK && b < scene->body_count; b++) {
        r = append_body(env, &scene->bodies[b].mesh, b, row);
    }
    if (r == PARIAN_OK && !(row->count > 0 && row->sum[row->count - 1] > 0)) {
        r = parian_fail(env, PARIAN_E_FORMAT, "the bodies have no area to spread receivers on");
    }
    return r;
}

/* One random place in each of count equal shares of the row. Along a triangle it goes by strips of
 * equal area; across, by the golden ratio, so that the shares of one large triangle are even in
 * both directions. */
static void place_in_shares(const area_row *row, uint64_t seed, parian_receivers *receivers)
{
    static const double golden = 0.61803398874989484820;
    parian_random shift = parian_random_stream(seed, receivers->count, 1, 0);
    const double total = row->sum[row->count - 1], across_shift = parian_random_unit(&shift);
    size_t at = 0;
    for (size_t i = 0; i < receivers->count; i++) {
        parian_random random = parian_random_stream(seed, i, 0, 0);
        double target =
            ((double)i + parian_random_unit(&random)) / (double)receivers->count * total;
        while (at + 1 < row->count && row->sum[at] <= target) {
            at++;
        }
        double before = at > 0 ? row->sum[at - 1] : 0, share = row->sum[at] - before;
        double along = share > 0 ? sqrt(fmin(fmax((target - before) / share, 0), 1)) : 0.5;
        double across = across_shift + golden * (double)i;
        across -= floor(across);
        receivers->body[i] = row->body[at];
        receivers->triangle[i] = row->triangle[at];
        receivers->barycentric[i][0] = 1 - along;
        receivers->barycentric[i][1] = along * (1 - across);
        receivers->barycentric[i][2] = along * across;
        receivers->area[i] = total / (double)receivers->count;
    }
}

parian_result parian_receivers_spread(const parian_env *env, const parian_reference_scene *scene,
                                      size_t count, uint64_t seed, parian_receivers *receivers)
{
    area_row row = {0};
    parian_receivers made = {0};
    if (count == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "0 receivers asked for, expected at least 1");
    }
    parian_result r = make_row(env, scene, &row);
    if (r == PARIAN_OK) {
        r = allocate_receivers(env, count, &made);
    }
    if (r == PARIAN_OK) {
        place_in_shares(&row, seed, &made);
        for (size_t i = 0; i < count; i++) {
            complete_receiver(scene, &made, i);
        }
        *receivers = made;
    }
    free_row(env, &row);
    return r;
}

/* ---- nearest ---- */

static void keep_off_rim(double barycentric[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        barycentric[k] = fmax(barycentric[k], RIM_SHARE);
        sum += barycentric[k];
    }
    vec3d_scale(barycentric, 1 / sum);
}

/* Take over what one body has nearer than those before it. */
static parian_result search_body(const parian_env *env, const parian_reference_scene *scene,
                                 uint32_t body, const double (*point)[3], double *distance,
                                 parian_receivers *receivers)
{
    parian_closest *closest = NULL;
    parian_closest_hit *hit = NULL;
    parian_closest_query query = {.count = receivers->count, .point = point};
    parian_result r = parian_closest_create(env, &scene->bodies[body].mesh, &closest);
    if (r == PARIAN_OK && !PARIAN_NEW(env, hit, receivers->count)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu receivers", receivers->count);
    }
    if (r == PARIAN_OK) {
        r = parian_closest_find(env, closest, &query, hit);
    }
    for (size_t i = 0; r == PARIAN_OK && i < receivers->count; i++) {
        if (hit[i].triangle != 0xFFFFFFFFu && hit[i].distance < distance[i]) {
            distance[i] = hit[i].distance;
            receivers->body[i] = body;
            receivers->triangle[i] = hit[i].triangle;
            vec3d_copy(receivers->barycentric[i], hit[i].barycentric);
        }
    }
    parian_free(env, hit);
    parian_closest_destroy(closest);
    return r;
}

static parian_result check_points(const parian_env *env, const double (*point)[3], size_t count)
{
    if (count == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "0 receivers asked for, expected at least 1");
    }
    for (size_t i = 0; i < count; i++) {
        const double *p = point[i];
        if (!(fabs(p[0]) < 1e12 && fabs(p[1]) < 1e12 && fabs(p[2]) < 1e12)) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "receiver %zu: (%g, %g, %g), expected within 1e12 m", i, p[0], p[1],
                               p[2]);
        }
    }
    return PARIAN_OK;
}

/* A file in other units, or for another place, is moved a long way: say so. */
static void warn_of_moves(const parian_env *env, const parian_reference_scene *scene,
                          const double *distance, size_t count)
{
    double farthest = 0;
    for (size_t i = 0; i < count; i++) {
        farthest = fmax(farthest, distance[i]);
    }
    if (farthest > FAR_SHARE * scene->extent) {
        parian_log(
            env, PARIAN_LOG_WARNING,
            "receivers were moved by up to %.3g m to the nearest surface of bodies %.3g m wide",
            farthest, scene->extent);
    }
}

static parian_result search_bodies(const parian_env *env, const parian_reference_scene *scene,
                                   const double (*point)[3], parian_receivers *receivers)
{
    double *distance = NULL;
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW(env, distance, receivers->count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu receivers", receivers->count);
    }
    for (size_t i = 0; i < receivers->count; i++) {
        distance[i] = INFINITY;
    }
    for (uint32_t b = 0; r == PARIAN_OK && b < scene->body_count; b++) {
        r = search_body(env, scene, b, point, distance, receivers);
    }
    if (r == PARIAN_OK) {
        warn_of_moves(env, scene, distance, receivers->count);
    }
    parian_free(env, distance);
    return r;
}

parian_result parian_receivers_nearest(const parian_env *env, const parian_reference_scene *scene,
                                       const double (*point)[3], size_t count,
                                       parian_receivers *receivers)
{
    parian_receivers made = {0};
    parian_result r = check_points(env, point, count);
    if (r == PARIAN_OK) {
        r = allocate_receivers(env, count, &made);
    }
    if (r == PARIAN_OK) {
        r = search_bodies(env, scene, point, &made);
    }
    if (r != PARIAN_OK) {
        parian_receivers_free(env, &made);
        return r;
    }
    for (size_t i = 0; i < count; i++) {
        keep_off_rim(made.barycentric[i]);
        complete_receiver(scene, &made, i);
        made.area[i] = 1;
    }
    *receivers = made;
    return PARIAN_OK;
}

void parian_receiver_place(const parian_receivers *receivers, size_t index, parian_place *place)
{
    place->body = receivers->body[index];
    place->triangle = receivers->triangle[index];
    vec3d_copy(place->position, receivers->position[index]);
    vec3d_copy(place->normal, receivers->normal[index]);
    vec3d_copy(place->smooth_normal, receivers->smooth_normal[index]);
    vec3d_copy(place->barycentric, receivers->barycentric[index]);
}
