/* path_adjoint.c - walks from a receiver into the body, against the light, until they leave it.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_parts.h"

#include "bake/reference/vec3d.h"
#include "core/small_maths.h"

typedef struct adjoint_walk {
    const path_scene *path;
    int channel;
    path_walker at;
    double start;  /* pi T of the first crossing */
    double weight; /* after it */
    double inverse_eta2;
    double value, unscattered;
    uint64_t events;
    uint32_t meetings;
    parian_random random;
    parian_walk_books *books;
} adjoint_walk;

/* Choose a direction outside by the cosine and refract it inwards; false where nothing comes in. */
static bool enter(adjoint_walk *walk, size_t receiver)
{
    const parian_receivers *r = walk->path->receivers;
    const double *normal = r->normal[receiver];
    double outside[3], cos_azimuth, sin_azimuth, u = parian_random_unit(&walk->random);
    walk->at.body = r->body[receiver];
    walk->at.triangle = r->triangle[receiver];
    path_place(walk->path, walk->at.body, walk->at.triangle, r->barycentric[receiver],
               walk->at.position);
    parian_walk_azimuth(&walk->random, &cos_azimuth, &sin_azimuth);
    parian_walk_turn(normal, -sqrt(1 - u), sqrt(u), cos_azimuth, sin_azimuth, outside);
    double eta = walk->path->body[walk->at.body].medium[walk->channel].walk.eta;
    double reflectance = parian_walk_refract(outside, normal, eta, walk->at.direction);
    walk->start = PARIAN_PI * (1 - reflectance);
    walk->inverse_eta2 = 1 / (eta * eta);
    return reflectance < 1;
}

/* At the boundary: leave with the chance of transmission and gather what is seen there, or go on.
 */
static bool meet_boundary(adjoint_walk *walk)
{
    double inward[3], outside[3];
    for (int k = 0; k < 3; k++) {
        inward[k] = -walk->at.normal[k];
    }
    double eta = walk->path->body[walk->at.body].medium[walk->channel].walk.eta;
    double reflectance = parian_walk_refract(walk->at.direction, inward, 1 / eta, outside);
    if (!(parian_random_unit(&walk->random) < reflectance)) {
        double seen = walk->start * walk->weight *
                      parian_path_exit_light(walk->path, walk->channel, &walk->at, outside);
        walk->value += seen;
        walk->unscattered += walk->events == 0 ? seen : 0;
        walk->books->left += walk->weight;
        return false;
    }
    parian_walk_reflect(walk->at.direction, inward);
    return !parian_path_caught(&walk->weight, ++walk->meetings, &walk->random, walk->books);
}

static bool scatter(adjoint_walk *walk, double albedo)
{
    const path_scene *path = walk->path;
    parian_walk_absorb(&walk->weight, albedo, walk->books);
    if (!parian_walk_continue(&walk->weight, ++walk->events, &walk->random, walk->books)) {
        return false;
    }
    if (path->any_connection) {
        walk->value += walk->start * walk->weight * walk->inverse_eta2 *
                       parian_path_connect(path, walk->channel, &walk->at, &walk->random);
    }
    parian_walk_scatter(walk->at.direction, path->body[walk->at.body].medium[walk->channel].walk.g,
                        &walk->random);
    walk->meetings = 0;
    return true;
}

static void finish_walk(adjoint_walk *walk)
{
    for (;;) {
        double albedo;
        path_event event =
            parian_path_fly(walk->path, walk->channel, &walk->at, &walk->random, &albedo);
        if (event == PATH_IS_LOST) {
            walk->books->lost += walk->weight;
            walk->books->lost_walks++;
            return;
        }
        if (!(event == PATH_SCATTERS ? scatter(walk, albedo) : meet_boundary(walk))) {
            return;
        }
    }
}

void parian_path_adjoint(const path_scene *path, size_t receiver, int channel, uint64_t first,
                         uint32_t count, path_tally *tally, parian_walk_books *books)
{
    for (uint64_t i = first; i < first + count; i++) {
        adjoint_walk walk = {.path = path, .channel = channel, .weight = 1, .books = books};
        walk.random = parian_random_stream(path->seed, receiver, (uint64_t)channel, i);
        if (enter(&walk, receiver)) {
            books->started += 1;
            finish_walk(&walk);
        }
        tally->sum += walk.value;
        tally->square += walk.value * walk.value;
        tally->unscattered += walk.unscattered;
    }
}
