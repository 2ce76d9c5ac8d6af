/* path_forward.c - photons from a light into the bodies, until they leave; they are counted in
 * receivers' patches.
 *
 * The remainder (light that is reflected inside before it first scatters) is forced: the photon's
 * first flight goes to the boundary whatever scatters before it, weighted by transmittance and
 * reflectance. In a body that is optically thick the weight is nothing and roulette ends the photon
 * there.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_parts.h"

#include "bake/reference/vec3d.h"
#include "core/small_maths.h"

/* Photons of the remainder that weigh less than this live on with as much. */
static const double FORCED_WEIGHT = 0.02;

/* Draws of photons are apart from those of walks. */
static const uint64_t PHOTON_SEED = 0x50484F544F4E5321u;

typedef struct photon {
    const path_scene *path;
    int channel;
    path_walker at;
    double power;  /* W times the count of photons, at the start */
    double weight; /* of it, now */
    uint64_t events;
    uint32_t meetings;
    parian_random random;
    parian_walk_books books; /* in units of power */
    double (*flux)[2];
    double leaving; /* W times the count: for deposit */
} photon;

/* Triangle with cumulative[t] <= u < cumulative[t + 1]. */
static uint32_t choose_triangle(const double *cumulative, uint32_t count, double u)
{
    uint32_t low = 0, high = count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (cumulative[middle] <= u) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static double place_on_triangle(photon *p, uint32_t body, uint32_t triangle, double normal[3])
{
    double u = sqrt(parian_random_unit(&p->random)), v = parian_random_unit(&p->random);
    double barycentric[3] = {1 - u, u * (1 - v), u * v}, a[3], b[3];
    vec3d_sub(a, path_corner(p->path, body, triangle, 1), path_corner(p->path, body, triangle, 0));
    vec3d_sub(b, path_corner(p->path, body, triangle, 2), path_corner(p->path, body, triangle, 0));
    vec3d_cross(normal, a, b);
    path_place(p->path, body, triangle, barycentric, p->at.position);
    p->at.body = body;
    p->at.triangle = triangle;
    return 0.5 * vec3d_normalize(normal);
}

/* Choose a place on the surface and let the light in there; false where none comes. */
static bool start_photon(photon *p, uint32_t light)
{
    const path_scene *path = p->path;
    const double *cumulative = path->light[light].cumulative;
    uint32_t flat =
        choose_triangle(cumulative, path->triangle_total, parian_random_unit(&p->random));
    uint32_t body = path->triangle_body[flat];
    double chance = cumulative[flat + 1] - cumulative[flat], normal[3], to_light[3], travel[3];
    double area = place_on_triangle(p, body, flat - path->body[body].first_triangle, normal);
    double u = parian_random_unit(&p->random), v = parian_random_unit(&p->random);
    double irradiance = parian_path_visible_light(path, light, p->channel, body, p->at.triangle,
                                                  p->at.position, u, v, to_light);
    double cosine = irradiance > 0 ? vec3d_dot(to_light, normal) : 0;
    if (!(cosine > 0) || !(chance > 0)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        travel[k] = -to_light[k];
    }
    double reflectance = parian_walk_refract(
        travel, normal, path->body[body].medium[p->channel].walk.eta, p->at.direction);
    p->power = irradiance * cosine * (1 - reflectance) * area / chance;
    return p->power > 0;
}

static void deposit(void *context, size_t receiver)
{
    photon *p = context;
    double density = p->leaving / p->path->patches.area[receiver];
    p->flux[receiver][0] += density;
    p->flux[receiver][1] += p->events == 0 ? density : 0;
}

/* Some leaves, the rest is reflected. */
static bool meet_boundary(photon *p)
{
    double eta = p->path->body[p->at.body].medium[p->channel].walk.eta, beyond;
    double cosine = fmin(vec3d_dot(p->at.direction, p->at.normal), 1);
    double reflectance = parian_walk_fresnel(cosine, 1 / eta, &beyond);
    p->leaving = p->power * parian_walk_leave(&p->weight, reflectance, &p->books);
    if (p->flux && p->leaving > 0) {
        parian_path_patches_at(p->path, p->at.body, p->at.position, p->at.normal, deposit, p);
    }
    if (!(p->weight > 0) || !parian_walk_roulette(&p->weight, PARIAN_WALK_THRESHOLD,
                                                  PARIAN_WALK_TARGET, &p->random, &p->books)) {
        return false;
    }
    parian_walk_reflect(p->at.direction, p->at.normal);
    return !parian_path_caught(&p->weight, ++p->meetings, &p->random, &p->books);
}

static bool scatter(photon *p, double albedo)
{
    parian_walk_absorb(&p->weight, albedo, &p->books);
    if (!parian_walk_continue(&p->weight, ++p->events, &p->random, &p->books)) {
        return false;
    }
    parian_walk_scatter(p->at.direction, p->path->body[p->at.body].medium[p->channel].walk.g,
                        &p->random);
    p->meetings = 0;
    return true;
}

static void finish_photon(photon *p)
{
    for (;;) {
        double albedo;
        path_event event = parian_path_fly(p->path, p->channel, &p->at, &p->random, &albedo);
        if (event == PATH_IS_LOST) {
            p->books.lost += p->weight;
            p->books.lost_walks++;
            return;
        }
        if (!(event == PATH_SCATTERS ? scatter(p, albedo) : meet_boundary(p))) {
            return;
        }
    }
}

/* Bring the photon unscattered to the boundary and reflect it there; false where it ends. */
static bool reflect_before_scattering(photon *p)
{
    const parian_path_medium *medium = &p->path->body[p->at.body].medium[p->channel];
    double from[3], distance, beyond;
    vec3d_copy(from, p->at.position);
    if (!parian_path_boundary(p->path, &p->at, INFINITY, &distance)) {
        return false;
    }
    double depth = parian_path_medium_depth(medium, from, p->at.direction, distance);
    double cosine = fmin(vec3d_dot(p->at.direction, p->at.normal), 1);
    p->weight = exp(-depth) * parian_walk_fresnel(cosine, 1 / medium->walk.eta, &beyond);
    if (!(p->weight > 0) ||
        !parian_walk_roulette(&p->weight, FORCED_WEIGHT, FORCED_WEIGHT, &p->random, &p->books)) {
        return false;
    }
    parian_walk_reflect(p->at.direction, p->at.normal);
    p->meetings = 1;
    return true;
}

static void book_photon(const photon *p, parian_walk_books *books)
{
    parian_walk_books scaled = p->books;
    scaled.started *= p->power;
    scaled.left *= p->power;
    scaled.absorbed *= p->power;
    scaled.roulette_added *= p->power;
    scaled.roulette_removed *= p->power;
    scaled.lost *= p->power;
    parian_walk_books_add(books, &scaled);
}

void parian_path_forward(const path_scene *path, const path_photons *photons, double (*flux)[2],
                         parian_walk_books *books)
{
    if (!path->light[photons->light].cumulative) {
        return;
    }
    for (uint64_t i = photons->first; i < photons->first + photons->count; i++) {
        photon p = {.path = path, .channel = photons->channel, .weight = 1, .flux = flux};
        p.random = parian_random_stream(path->seed ^ PHOTON_SEED,
                                        photons->light * 2u + (photons->share == PATH_EVERYTHING),
                                        (uint64_t)photons->channel, i);
        if (!start_photon(&p, photons->light)) {
            continue;
        }
        p.books.started = 1;
        if (photons->share == PATH_EVERYTHING || reflect_before_scattering(&p)) {
            finish_photon(&p);
        }
        book_photon(&p, books);
    }
}
