/* quadrature_places.c - a body's strata in blocks, and the places that all receivers share, with
 * their light.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/quadrature_parts.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_maths.h"

enum { EXTENT_SAMPLES = 4 /* of each light of extent at a shared place */ };
static const double SIZE_OVER_DISTANCE = 0.35;
static const double SHARED_PART = 0.5; /* of the places of a replicate; the rest are fresh ones */

/* ---- guide -------------------------------------------------------------------------------------
 */
static double bssrdf_by_distance(const void *context, int channel, double r2)
{
    static const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    const double x[3] = {sqrt(r2), 0, 0};
    double R[3];
    parian_bssrdf_value(context, origin, up, up, x, up, R);
    return R[channel];
}

/* The BSSRDF on a plane under light along the normal. */
typedef struct guide_source {
    const parian_bssrdf_model *bssrdf;
    double total[3];
} guide_source;

static double guide_density(const void *context, int channel, double r2)
{
    const guide_source *s = context;
    return s->total[channel] > 0 ? bssrdf_by_distance(s->bssrdf, channel, r2) / s->total[channel]
                                 : 0;
}

/* Length on which a channel varies near 0: what the model says, or where it has fallen to half. */
static double channel_core(const parian_bssrdf_model *bssrdf, int channel)
{
    double r = parian_bssrdf_core_length(bssrdf, channel);
    double half = 0.5 * bssrdf_by_distance(bssrdf, channel, 0);
    for (int i = 0; i < 200 && bssrdf_by_distance(bssrdf, channel, r * r) < half; i++) {
        r *= 0.8;
    }
    return r;
}

/* Rough totals: steps of 4 % in distance from far below the core to far beyond it. */
static void add_totals(guide_source *source, double core)
{
    for (int i = -100; i < 500; i++) {
        double r = core * exp(0.04 * i);
        for (int c = 0; c < 3; c++) {
            source->total[c] +=
                2 * PARIAN_PI * r * r * 0.04 * bssrdf_by_distance(source->bssrdf, c, r * r);
        }
    }
}

static parian_result make_guide(const quadrature_job *job, const parian_medium *medium,
                                double diagonal, uint64_t places, quadrature_surface *surface)
{
    guide_source source = {.bssrdf = surface->bssrdf};
    double core = INFINITY;
    for (int c = 0; c < 3; c++) {
        if (medium->sigma_s_prime[c] > 0) {
            core = fmin(core, channel_core(surface->bssrdf, c));
        }
    }
    core = core > 0 && core < diagonal ? core : diagonal;
    add_totals(&source, core);
    surface->guide.core2 = core * core;
    surface->guide.tolerance = 1 / fmax(1, (1 - SHARED_PART) * (double)places);
    return parian_radial_table_make(job->env, guide_density, &source, core * core, diagonal,
                                    &surface->guide.density);
}

bool quadrature_must_split(const quadrature_guide *guide, double radius, double area, double r2)
{
    float density[3];
    if (radius * radius > SIZE_OVER_DISTANCE * SIZE_OVER_DISTANCE * (r2 + guide->core2)) {
        return true;
    }
    parian_radial_eval(&guide->density, (float)r2, density);
    return area * fmaxf(fmaxf(density[0], density[1]), density[2]) > guide->tolerance;
}

/* ---- strata and blocks -------------------------------------------------------------------------
 */
static void bound_block(const quadrature_surface *surface, quadrature_block *block)
{
    for (int a = 0; a < 3; a++) {
        block->lower[a] = INFINITY;
        block->upper[a] = -INFINITY;
    }
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        const parian_stratum *s = &surface->stratum[i];
        block->radius_max = fmax(block->radius_max, s->radius);
        block->area_max = fmax(block->area_max, s->area);
        for (int a = 0; a < 3; a++) {
            block->lower[a] = fmin(block->lower[a], s->centre[a]);
            block->upper[a] = fmax(block->upper[a], s->centre[a]);
        }
    }
}

static parian_result make_blocks(const parian_env *env, quadrature_surface *surface)
{
    size_t count = surface->stratum_count,
           blocks = (count + QUADRATURE_BLOCK - 1) / QUADRATURE_BLOCK;
    size_t padded = blocks * QUADRATURE_BLOCK;
    surface->block_count = blocks;
    if (!PARIAN_NEW0(env, surface->block, blocks) || !PARIAN_NEW0(env, surface->base, 9 * padded) ||
        !PARIAN_NEW(env, surface->arrival, count * surface->arrivals_per_place)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu places", count);
    }
    for (int a = 0; a < 3; a++) {
        surface->position[a] = surface->base + (size_t)a * padded;
        surface->normal[a] = surface->base + (size_t)(3 + a) * padded;
        surface->flux[a] = surface->base + (size_t)(6 + a) * padded;
    }
    for (size_t b = 0; b < blocks; b++) {
        quadrature_block *block = &surface->block[b];
        size_t first = b * QUADRATURE_BLOCK, rest = count - first;
        block->first = (uint32_t)first;
        block->count = (uint32_t)(rest < QUADRATURE_BLOCK ? rest : QUADRATURE_BLOCK);
        bound_block(surface, block);
    }
    return PARIAN_OK;
}

/* Tables for models that do not tell directions apart. Those of the dipole are the bake's own
 * transport, which wants a body with its box; photon beam diffusion goes by distance. */
static parian_result make_tables(const quadrature_job *job, const parian_reference_body *body,
                                 const double diagonal[3], quadrature_surface *surface)
{
    parian_reference_model model = job->desc->bssrdf.model;
    float corner[2][3] = {{0, 0, 0}, {(float)diagonal[0], (float)diagonal[1], (float)diagonal[2]}};
    parian_body box = {.medium = body->medium,
                       .bssrdf = model == PARIAN_REFERENCE_DIPOLE_FLUX ? PARIAN_BSSRDF_DIPOLE_FLUX
                                                                       : PARIAN_BSSRDF_DIPOLE,
                       .fit_fdr = job->desc->bssrdf.fit_fdr,
                       .vertex_count = 2,
                       .vertex_position = corner};
    surface->tabulated = !parian_bssrdf_is_directional(surface->bssrdf);
    if (!surface->tabulated) {
        return PARIAN_OK;
    }
    return model == PARIAN_REFERENCE_PBD
               ? parian_radial_table_make(
                     job->env, bssrdf_by_distance, surface->bssrdf, surface->guide.core2,
                     sqrt(parian_dot3(diagonal, diagonal)), &surface->model.value)
               : parian_transport_model_make(job->env, &box, PARIAN_MODEL_FULL, &surface->model);
}

uint32_t quadrature_count_arrivals(const parian_reference_scene *scene)
{
    uint32_t count = 0;
    for (uint32_t l = 0; l < scene->light_count; l++) {
        count += parian_light_is_delta(&scene->lights[l]) ? 1 : EXTENT_SAMPLES;
    }
    return count;
}

parian_result quadrature_surface_make(const quadrature_job *job, uint32_t body, uint64_t places,
                                      quadrature_surface *surface)
{
    const parian_reference_body *b = &job->scene->bodies[body];
    double lower[3], upper[3], diagonal[3];
    memset(surface, 0, sizeof *surface);
    surface->body = body;
    parian_mesh_bounds(&b->mesh, lower, upper);
    for (int a = 0; a < 3; a++) {
        diagonal[a] = upper[a] - lower[a];
    }
    parian_result r =
        parian_bssrdf_create(job->env, &b->medium, &job->desc->bssrdf, &surface->bssrdf);
    if (r == PARIAN_OK) {
        double length = sqrt(parian_dot3(diagonal, diagonal));
        r = make_guide(job, &b->medium, length, places, surface);
    }
    if (r == PARIAN_OK) {
        r = make_tables(job, b, diagonal, surface);
    }
    if (r == PARIAN_OK) {
        r = parian_strata_tree_make(job->env, &b->mesh, &surface->tree);
    }
    if (r == PARIAN_OK) {
        /* A cut by area has about 1.4 strata for each area_max. */
        double area_max = 1.4 * surface->tree.area / (SHARED_PART * (double)places);
        r = parian_strata_cut(job->env, &surface->tree, area_max, &surface->stratum,
                              &surface->stratum_count);
    }
    if (r == PARIAN_OK) {
        surface->arrivals_per_place =
            surface->tabulated ? 0 : quadrature_count_arrivals(job->scene);
        r = make_blocks(job->env, surface);
    }
    if (r != PARIAN_OK) {
        quadrature_surface_free(job->env, surface);
    }
    return r;
}

void quadrature_surface_free(const parian_env *env, quadrature_surface *surface)
{
    parian_strata_tree_free(env, &surface->tree);
    parian_radial_table_free(env, &surface->guide.density);
    parian_transport_model_free(env, &surface->model);
    parian_bssrdf_destroy(env, surface->bssrdf);
    parian_free(env, surface->stratum);
    parian_free(env, surface->block);
    parian_free(env, surface->base);
    parian_free(env, surface->arrival);
    memset(surface, 0, sizeof *surface);
}

/* ---- light -------------------------------------------------------------------------------------
 */
static void add_arrival(quadrature_surface *surface, quadrature_block *block, uint32_t place,
                        const double direction[3], const double E[3], double weight)
{
    size_t at = (size_t)block->first * surface->arrivals_per_place + block->arrival_count++;
    quadrature_arrival *arrival = &surface->arrival[at];
    arrival->place = place;
    for (int a = 0; a < 3; a++) {
        arrival->direction[a] = (float)direction[a];
        arrival->flux[a] = (float)(E[a] * weight);
    }
}

/* All lights at one place; samples of a light of extent share its weight. */
static void light_place(const quadrature_job *job, quadrature_surface *surface,
                        quadrature_block *block, uint32_t index, const parian_place *place)
{
    double area = surface->stratum[index].area;
    for (uint32_t l = 0; l < job->scene->light_count; l++) {
        uint32_t count = parian_light_is_delta(&job->scene->lights[l]) ? 1 : EXTENT_SAMPLES;
        for (uint32_t s = 0; s < count; s++) {
            double direction[3], E[3], at[2];
            quadrature_lattice_at(&job->lattice, (uint64_t)index * count + s, at);
            parian_reference_light_sample_at(job->scene, l, place, at[0], at[1], direction, E);
            if (!(E[0] > 0 || E[1] > 0 || E[2] > 0)) {
                continue;
            }
            block->lit = true;
            for (int c = 0; c < 3; c++) {
                surface->flux[c][index] += (float)(E[c] * area / count);
            }
            if (surface->arrivals_per_place) {
                add_arrival(surface, block, index, direction, E, area / count);
            }
        }
    }
}

static void light_block(void *context, size_t b)
{
    quadrature_job *job = context;
    quadrature_surface *surface = &job->surface;
    quadrature_block *block = &surface->block[b];
    block->arrival_count = 0;
    block->lit = false;
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        parian_place place;
        parian_random random = parian_random_stream(job->desc->seed ^ QUADRATURE_SALT,
                                                    2 * job->replicate, surface->body, i);
        parian_stratum_place(&surface->tree, &surface->stratum[i], surface->body, &random, &place);
        for (int a = 0; a < 3; a++) {
            surface->position[a][i] = (float)(place.position[a] - surface->tree.origin[a]);
            surface->normal[a][i] = (float)place.smooth_normal[a];
            surface->flux[a][i] = 0;
        }
        light_place(job, surface, block, i, &place);
    }
}

void quadrature_light_places(quadrature_job *job)
{
    parian_random random = parian_random_stream(job->desc->seed ^ QUADRATURE_SALT,
                                                2 * job->replicate, job->surface.body, UINT64_MAX);
    job->lattice = quadrature_lattice_make(&random);
    parian_par(job->env, job->surface.block_count, light_block, job);
}
