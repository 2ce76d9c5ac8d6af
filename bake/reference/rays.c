/* rays.c - Embree proposes triangles in floats; every candidate is decided in doubles.
 *
 * Each mesh has a tree of its own, in coordinates relative to its centre and extent, so that a
 * small body above a large floor keeps its precision. A ray enters the mesh's box in doubles and
 * starts a little before its origin in floats; the filter function then intersects the candidate
 * triangle in doubles and turns it down where it is the one that the ray starts on, lies behind the
 * origin or beyond the end.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/rays.h"

#include <string.h>

#include <embree3/rtcore.h>

#include "bake/reference/vec3d.h"
#include "core/memory.h"

/* In units of a mesh's extent. Rays start this far before their origin, above the rounding of float
 * coordinates (6e-8) and of Embree's tests; those from a triangle also this far to the side that
 * they go to, for a grazing ray that starts by an edge must not be found beyond the neighbour; and
 * no hit is nearer than this, above the rounding of doubles. */
static const double BACK_OFF = 1e-6, SIDE_STEP = 3e-7, DISTANCE_MIN = 1e-12;

typedef struct ray_mesh {
    RTCScene scene;          /* NULL for a mesh without triangles */
    double centre[3], scale; /* local = (world - centre) * scale */
    double lower[3], upper[3];
    uint32_t triangle_count;
    double (*position)[3];
    uint32_t (*triangle)[3];
} ray_mesh;

struct parian_rays {
    parian_env env;
    RTCDevice device;
    uint32_t count;
    ray_mesh *mesh;
};

/* What the filter function sees of a query. Embree passes the first member, and one ray at a time.
 */
typedef struct ray_query {
    struct RTCIntersectContext context;
    const ray_mesh *mesh;
    const parian_ray *ray;
    double nearest;      /* metres: hits count strictly before it */
    double distance_min; /* metres */
    uint32_t skip;
    parian_ray_hit *hit; /* NULL where only the fact counts */
    uint32_t mesh_index;
    bool found;
} ray_query;

/* ---- candidates, in doubles ---- */

typedef struct exact_hit {
    double distance, barycentric[3];
    double edge[2][3];
} exact_hit;

/* Move a place beside the triangle onto its rim; the distance along the ray follows. */
static void clamp_hit(const double from_corner[3], const parian_ray *ray, exact_hit *hit)
{
    double u = fmax(hit->barycentric[1], 0), v = fmax(hit->barycentric[2], 0);
    double sum = fmax(u + v, 1);
    hit->barycentric[1] = u / sum;
    hit->barycentric[2] = v / sum;
    hit->barycentric[0] = fmax(1 - u / sum - v / sum, 0);
    hit->distance = hit->barycentric[1] * vec3d_dot(hit->edge[0], ray->direction) +
                    hit->barycentric[2] * vec3d_dot(hit->edge[1], ray->direction) -
                    vec3d_dot(from_corner, ray->direction);
}

/* Whether the ray passes the triangle's plane farther than distance_min from its origin, and where.
 * A candidate that it passes outside by rounding is taken at a place of the rim. Source [Moeller97]
 */
static bool meet_triangle(const ray_mesh *mesh, uint32_t triangle, const parian_ray *ray,
                          double distance_min, exact_hit *hit)
{
    const uint32_t *corner = mesh->triangle[triangle];
    const double *a = mesh->position[corner[0]];
    double p[3], q[3], s[3];
    vec3d_sub(hit->edge[0], mesh->position[corner[1]], a);
    vec3d_sub(hit->edge[1], mesh->position[corner[2]], a);
    vec3d_sub(s, ray->origin, a);
    vec3d_cross(p, ray->direction, hit->edge[1]);
    vec3d_cross(q, s, hit->edge[0]);
    double inverse = 1 / vec3d_dot(hit->edge[0], p);
    hit->distance = vec3d_dot(hit->edge[1], q) * inverse;
    if (!(hit->distance > distance_min && isfinite(hit->distance))) {
        return false;
    }
    double u = vec3d_dot(s, p) * inverse, v = vec3d_dot(ray->direction, q) * inverse;
    hit->barycentric[0] = 1 - u - v;
    hit->barycentric[1] = u;
    hit->barycentric[2] = v;
    if (u < 0 || v < 0 || u + v > 1) {
        clamp_hit(s, ray, hit);
        hit->distance = fmax(hit->distance, distance_min);
    }
    return true;
}

static void keep_hit(ray_query *query, uint32_t triangle, const exact_hit *exact)
{
    parian_ray_hit *hit = query->hit;
    query->nearest = exact->distance;
    hit->mesh = query->mesh_index;
    hit->triangle = triangle;
    hit->distance = exact->distance;
    vec3d_copy(hit->barycentric, exact->barycentric);
    vec3d_cross(hit->normal, exact->edge[0], exact->edge[1]);
}

static void filter_candidate(const struct RTCFilterFunctionNArguments *args)
{
    ray_query *query = (ray_query *)args->context;
    uint32_t triangle = ((const struct RTCHit *)args->hit)->primID;
    exact_hit exact;
    if (triangle == query->skip) {
        args->valid[0] = 0;
        return;
    }
    if (!meet_triangle(query->mesh, triangle, query->ray, query->distance_min, &exact) ||
        !(exact.distance < query->nearest)) {
        args->valid[0] = 0;
        return;
    }
    query->found = true;
    if (query->hit) {
        keep_hit(query, triangle, &exact);
    }
}

/* ---- rays ---- */

/* Distance at which a ray comes into a mesh's box, 0 from inside; false where it misses it before
 * length. */
static bool enter_box(const ray_mesh *mesh, const parian_ray *ray, double length, double *enter)
{
    double first = 0, last = length;
    for (int k = 0; k < 3; k++) {
        double o = ray->origin[k], d = ray->direction[k];
        if (d == 0) {
            if (o < mesh->lower[k] || o > mesh->upper[k]) {
                return false;
            }
            continue;
        }
        double inverse = 1 / d;
        double t0 = ((d > 0 ? mesh->lower[k] : mesh->upper[k]) - o) * inverse;
        double t1 = ((d > 0 ? mesh->upper[k] : mesh->lower[k]) - o) * inverse;
        first = t0 > first ? t0 : first;
        last = t1 < last ? t1 : last;
    }
    *enter = first;
    return first <= last;
}

static bool is_inside_box(const ray_mesh *mesh, const double p[3])
{
    return p[0] >= mesh->lower[0] && p[0] <= mesh->upper[0] && p[1] >= mesh->lower[1] &&
           p[1] <= mesh->upper[1] && p[2] >= mesh->lower[2] && p[2] <= mesh->upper[2];
}

/* Move the local origin off the triangle that the ray starts on. */
static void step_aside(const ray_mesh *mesh, const parian_ray *ray, double origin[3])
{
    const uint32_t *corner = mesh->triangle[ray->triangle];
    const double *a = mesh->position[corner[0]];
    double u[3], v[3], normal[3];
    vec3d_sub(u, mesh->position[corner[1]], a);
    vec3d_sub(v, mesh->position[corner[2]], a);
    vec3d_cross(normal, u, v);
    double length = vec3d_length(normal);
    if (length > 0) {
        double side = vec3d_dot(normal, ray->direction) < 0 ? -SIDE_STEP : SIDE_STEP;
        vec3d_add_scaled(origin, normal, side / length);
    }
}

static void make_local(const ray_mesh *mesh, const parian_ray *ray, bool from_triangle,
                       double enter, double length, struct RTCRay *local)
{
    double o[3];
    for (int k = 0; k < 3; k++) {
        o[k] = (ray->origin[k] + enter * ray->direction[k] - mesh->centre[k]) * mesh->scale -
               BACK_OFF * ray->direction[k];
    }
    if (from_triangle) {
        step_aside(mesh, ray, o);
    }
    local->org_x = (float)o[0];
    local->org_y = (float)o[1];
    local->org_z = (float)o[2];
    local->dir_x = (float)ray->direction[0];
    local->dir_y = (float)ray->direction[1];
    local->dir_z = (float)ray->direction[2];
    local->tnear = 0;
    local->tfar = (float)((length - enter) * mesh->scale * (1 + BACK_OFF) + 2 * BACK_OFF);
    local->time = 0;
    local->mask = 0xFFFFFFFFu;
    local->id = 0;
    local->flags = 0;
}

/* Trace one mesh; query->nearest is the end. */
static void trace_mesh(const parian_rays *rays, uint32_t index, ray_query *query)
{
    const ray_mesh *mesh = &rays->mesh[index];
    const parian_ray *ray = query->ray;
    bool from_triangle = ray->mesh == index && ray->triangle < mesh->triangle_count;
    double enter = 0;
    if (!mesh->scene ||
        (!is_inside_box(mesh, ray->origin) && !enter_box(mesh, ray, query->nearest, &enter))) {
        return;
    }
    struct RTCRayHit local;
    rtcInitIntersectContext(&query->context);
    query->mesh = mesh;
    query->mesh_index = index;
    query->skip = from_triangle ? ray->triangle : PARIAN_RAY_NONE;
    query->distance_min = DISTANCE_MIN / mesh->scale;
    make_local(mesh, ray, from_triangle, enter, query->nearest, &local.ray);
    if (query->hit) {
        local.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(mesh->scene, &query->context, &local);
    } else {
        rtcOccluded1(mesh->scene, &query->context, &local.ray);
    }
}

static void trace(const parian_rays *rays, uint32_t only_mesh, ray_query *query)
{
    if (only_mesh != PARIAN_RAY_NONE) {
        if (only_mesh < rays->count) {
            trace_mesh(rays, only_mesh, query);
        }
        return;
    }
    for (uint32_t m = 0; m < rays->count && !(query->found && !query->hit); m++) {
        trace_mesh(rays, m, query);
    }
}

bool parian_rays_nearest(const parian_rays *rays, const parian_ray *ray, uint32_t only_mesh,
                         parian_ray_hit *hit)
{
    ray_query query = {.ray = ray, .nearest = ray->length, .hit = hit};
    trace(rays, only_mesh, &query);
    if (query.found) {
        vec3d_normalize(hit->normal);
    }
    return query.found;
}

bool parian_rays_blocked(const parian_rays *rays, const parian_ray *ray, uint32_t only_mesh)
{
    ray_query query = {.ray = ray, .nearest = ray->length};
    trace(rays, only_mesh, &query);
    return query.found;
}

/* ---- creation ---- */

static parian_result check_mesh(const parian_env *env, const parian_mesh *mesh, uint32_t index)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->position[v];
        if (!(fabs(p[0]) < 1e12 && fabs(p[1]) < 1e12 && fabs(p[2]) < 1e12)) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "mesh %u, vertex %u: (%g, %g, %g), expected within 1e12 m", index, v,
                               p[0], p[1], p[2]);
        }
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            if (mesh->triangle[t][k] >= mesh->vertex_count) {
                return parian_fail(env, PARIAN_E_ARGUMENT, "mesh %u, triangle %u: vertex %u of %u",
                                   index, t, mesh->triangle[t][k], mesh->vertex_count);
            }
        }
    }
    return PARIAN_OK;
}

static parian_result copy_mesh(const parian_env *env, const parian_mesh *mesh, ray_mesh *to)
{
    if (!PARIAN_NEW(env, to->position, mesh->vertex_count) ||
        !PARIAN_NEW(env, to->triangle, mesh->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u triangles", mesh->triangle_count);
    }
    to->triangle_count = mesh->triangle_count;
    memcpy(to->position, mesh->position, mesh->vertex_count * sizeof *to->position);
    memcpy(to->triangle, mesh->triangle, mesh->triangle_count * sizeof *to->triangle);
    double extent = 0;
    parian_mesh_bounds(mesh, to->lower, to->upper);
    for (int k = 0; k < 3; k++) {
        to->centre[k] = 0.5 * (to->lower[k] + to->upper[k]);
        extent = fmax(extent, to->upper[k] - to->lower[k]);
    }
    extent = extent > 0 ? extent : 1; /* all in one point: nothing can be met */
    to->scale = 1 / extent;
    for (int k = 0; k < 3; k++) {
        to->lower[k] -= BACK_OFF * extent;
        to->upper[k] += BACK_OFF * extent;
    }
    return PARIAN_OK;
}

static bool fill_geometry(RTCGeometry geometry, const parian_mesh *mesh, const ray_mesh *to)
{
    float(*vertex)[3] = rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof *vertex, mesh->vertex_count);
    uint32_t(*index)[3] = rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof *index, mesh->triangle_count);
    if (!vertex || !index) {
        return false;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            vertex[v][k] = (float)((mesh->position[v][k] - to->centre[k]) * to->scale);
        }
    }
    memcpy(index, mesh->triangle, mesh->triangle_count * sizeof *index);
    rtcSetGeometryIntersectFilterFunction(geometry, filter_candidate);
    rtcSetGeometryOccludedFilterFunction(geometry, filter_candidate);
    rtcCommitGeometry(geometry);
    return true;
}

/* Build the tree of one mesh. */
static parian_result build_tree(parian_rays *rays, const parian_mesh *mesh, ray_mesh *to)
{
    const parian_env *env = &rays->env;
    RTCGeometry geometry = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    bool filled = geometry && fill_geometry(geometry, mesh, to);
    to->scene = rtcNewScene(rays->device);
    if (filled && to->scene) {
        rtcSetSceneFlags(to->scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(to->scene, RTC_BUILD_QUALITY_HIGH);
        rtcAttachGeometry(to->scene, geometry);
        rtcCommitScene(to->scene);
    }
    if (geometry) {
        rtcReleaseGeometry(geometry);
    }
    enum RTCError error = rtcGetDeviceError(rays->device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the ray tree of %u triangles",
                           mesh->triangle_count);
    }
    if (error != RTC_ERROR_NONE || !filled || !to->scene) {
        return parian_fail(env, PARIAN_E_COMPUTE, "Embree failed on %u triangles (error %d)",
                           mesh->triangle_count, (int)error);
    }
    return PARIAN_OK;
}

/* Embree's own words go to the log; the failing call is reported by its result. */
static void log_device_error(void *user, enum RTCError code, const char *text)
{
    parian_log(user, PARIAN_LOG_ERROR, "Embree: %s (error %d)", text ? text : "no text", (int)code);
}

static parian_result fill_rays(const parian_mesh *const *meshes, uint32_t count, parian_rays *rays)
{
    const parian_env *env = &rays->env;
    if (!PARIAN_NEW0(env, rays->mesh, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u meshes", count);
    }
    rays->count = count;
    rays->device = rtcNewDevice("threads=1");
    if (!rays->device) {
        return parian_fail(env, PARIAN_E_COMPUTE, "Embree gives no device (error %d)",
                           (int)rtcGetDeviceError(NULL));
    }
    rtcSetDeviceErrorFunction(rays->device, log_device_error, &rays->env);
    for (uint32_t m = 0; m < count; m++) {
        parian_result r = check_mesh(env, meshes[m], m);
        if (r == PARIAN_OK && meshes[m]->triangle_count > 0) {
            r = copy_mesh(env, meshes[m], &rays->mesh[m]);
            r = r == PARIAN_OK ? build_tree(rays, meshes[m], &rays->mesh[m]) : r;
        }
        if (r != PARIAN_OK) {
            return r;
        }
    }
    return PARIAN_OK;
}

parian_result parian_rays_create(const parian_env *env, const parian_mesh *const *meshes,
                                 uint32_t count, parian_rays **rays)
{
    parian_rays *made = NULL;
    if (!PARIAN_NEW0(env, made, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for rays");
    }
    if (env) {
        made->env = *env;
    }
    parian_result r = fill_rays(meshes, count, made);
    if (r != PARIAN_OK) {
        parian_rays_destroy(made);
        return r;
    }
    *rays = made;
    return PARIAN_OK;
}

void parian_rays_destroy(parian_rays *rays)
{
    if (!rays) {
        return;
    }
    parian_env env = rays->env;
    for (uint32_t m = 0; rays->mesh && m < rays->count; m++) {
        if (rays->mesh[m].scene) {
            rtcReleaseScene(rays->mesh[m].scene);
        }
        parian_free(&env, rays->mesh[m].position);
        parian_free(&env, rays->mesh[m].triangle);
    }
    if (rays->device) {
        rtcReleaseDevice(rays->device);
    }
    parian_free(&env, rays->mesh);
    parian_free(&env, rays);
}
