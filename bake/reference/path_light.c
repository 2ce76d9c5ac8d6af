/* path_light.c - how a walk meets lights: where it leaves, by connections through a facet, straight
 * at the receiver.
 *
 * A connection searches facets within a random radius s whose density falls as exp(-rate s): a path
 * of length l is found with probability exp(-rate l) and counts exp(rate l) as much. With rate
 * below the extinction the weight falls with l, and most searches are short. Deep inside a body
 * none is needed.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_parts.h"

#include "bake/reference/vec3d.h"

/* rate over sigma_t: higher is cheaper and noisier. */
static const double CONNECTION_RATE = 0.7;

static bool is_blocked(const path_scene *path, uint32_t body, uint32_t triangle, const double x[3],
                       const double direction[3], double distance)
{
    parian_ray ray = {.length = distance, .mesh = body, .triangle = triangle};
    vec3d_copy(ray.origin, x);
    vec3d_copy(ray.direction, direction);
    return parian_rays_blocked(path->scene->rays, &ray, PARIAN_RAY_NONE);
}

double parian_path_exit_light(const path_scene *path, int channel, const path_walker *walker,
                              const double direction[3])
{
    double sum = 0;
    int endless_blocked = -1; /* not asked yet */
    for (uint32_t l = 0; l < path->scene->light_count; l++) {
        double radiance[3] = {0}, distance = INFINITY;
        if (path->light[l].meeting != PATH_BY_EXIT) {
            continue;
        }
        parian_light_sampler_radiance(path->scene->sampler, l, walker->position, direction,
                                      radiance, &distance);
        if (!(radiance[channel] > 0)) {
            continue;
        }
        bool endless = !(distance < INFINITY);
        bool blocked = endless && endless_blocked >= 0
                           ? endless_blocked > 0
                           : is_blocked(path, walker->body, walker->triangle, walker->position,
                                        direction, distance);
        endless_blocked = endless ? blocked : endless_blocked;
        sum += blocked ? 0 : radiance[channel];
    }
    return sum;
}

double parian_path_visible_light(const path_scene *path, uint32_t light, int channel, uint32_t body,
                                 uint32_t triangle, const double x[3], double u, double v,
                                 double direction[3])
{
    parian_light_sample sample;
    if (!parian_light_sampler_sample(path->scene->sampler, light, x, u, v, &sample) ||
        !(sample.irradiance[channel] > 0)) {
        return 0;
    }
    vec3d_copy(direction, sample.direction);
    return is_blocked(path, body, triangle, x, sample.direction, sample.distance)
               ? 0
               : sample.irradiance[channel];
}

typedef struct connection {
    const path_scene *path;
    const path_walker *walker;
    const parian_path_medium *medium;
    uint32_t light;
    double rate; /* of the random radius; 0 where it has no end */
    bool leaves; /* at a receiver: the flux through it instead of the phase function */
    double sum;
} connection;

/* Irradiance at the far end of a path, W m^-2 in the medium's channel, without what the medium
 * takes; 0 in shadow. */
static double fluence_without_medium(const connection *c, const parian_refracted_path *found)
{
    double direction[3], margin = c->leaves ? 1e-9 * c->path->body[c->walker->body].extent : 0;
    parian_ray inside = {
        .length = found->length - margin, .mesh = c->walker->body, .triangle = found->triangle};
    vec3d_copy(inside.origin, found->entry);
    vec3d_copy(inside.direction, found->into);
    double light = parian_path_visible_light(c->path, c->light, c->medium->channel, c->walker->body,
                                             found->triangle, found->entry, 0, 0, direction);
    if (!(light > 0) || parian_rays_blocked(c->path->scene->rays, &inside, c->walker->body)) {
        return 0;
    }
    double distance2 = found->light_distance * found->light_distance;
    return found->factor * light * (c->path->light[c->light].point.at_infinity ? 1 : distance2);
}

/* Share of the flux at a receiver that leaves through it. */
static double leaving_share(const connection *c, const double into[3])
{
    double cosine = vec3d_dot(into, c->walker->normal), beyond;
    if (!(cosine > 0)) {
        return 0;
    }
    return cosine * (1 - parian_walk_fresnel(cosine, 1 / c->medium->walk.eta, &beyond));
}

static void add_connection(void *context, const parian_refracted_path *found)
{
    connection *c = context;
    double share = c->leaves ? leaving_share(c, found->into)
                             : parian_walk_phase(c->medium->walk.g,
                                                 -vec3d_dot(found->into, c->walker->direction));
    if (!(share > 0)) {
        return;
    }
    double fluence = fluence_without_medium(c, found);
    if (fluence > 0) {
        double depth =
            parian_path_medium_depth(c->medium, found->entry, found->into, found->length);
        c->sum += share * fluence * exp(c->rate * found->length - depth);
    }
}

/* Every connection of one light not longer than radius. */
static void search(const path_body *body, uint32_t light, double radius, uint32_t skip,
                   connection *c)
{
    const path_light *of = &c->path->light[light];
    c->light = light;
    if (of->index && radius <= body->index_length) {
        parian_refractor_index_paths(of->index[c->walker->body], c->walker->position, radius, skip,
                                     add_connection, c);
    } else {
        parian_refracted_paths(body->refractor, c->walker->position, &of->point, radius, skip,
                               add_connection, c);
    }
}

double parian_path_connection_rate(const parian_path_medium *medium)
{
    return CONNECTION_RATE * (medium->field ? medium->minorant : medium->walk.sigma_t);
}

double parian_path_connect(const path_scene *path, int channel, const path_walker *walker,
                           parian_random *random)
{
    const path_body *body = &path->body[walker->body];
    connection c = {.path = path,
                    .walker = walker,
                    .medium = &body->medium[channel],
                    .rate = parian_path_connection_rate(&body->medium[channel])};
    double radius = parian_walk_flight(c.rate, random);
    if (radius < parian_path_grid_distance(&body->grid, walker->position)) {
        return 0;
    }
    for (uint32_t l = 0; l < path->scene->light_count; l++) {
        if (path->light[l].meeting == PATH_BY_CONNECTION) {
            search(body, l, radius, PARIAN_REFRACTOR_NO_SKIP, &c);
        }
    }
    return c.sum;
}

double parian_path_straight(const path_scene *path, int channel, size_t receiver)
{
    const parian_receivers *r = path->receivers;
    path_walker at = {.body = r->body[receiver], .triangle = r->triangle[receiver]};
    const path_body *body = &path->body[at.body];
    connection c = {.path = path, .walker = &at, .medium = &body->medium[channel], .leaves = true};
    path_place(path, at.body, at.triangle, r->barycentric[receiver], at.position);
    vec3d_copy(at.normal, r->normal[receiver]);
    double radius = c.medium->minorant > 0 ? 60 / c.medium->minorant : INFINITY;
    for (uint32_t l = 0; l < path->scene->light_count; l++) {
        if (path->light[l].meeting == PATH_BY_CONNECTION) {
            search(body, l, radius, at.triangle, &c);
        }
    }
    return c.sum;
}
