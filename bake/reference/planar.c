/* planar.c - random walks in a half-space, a slab and a ball: what leaves each side, by distance
 * from the entry.
 *
 * Photons are split into batches whose number depends on the number of photons alone; each photon
 * draws from a stream of its own, batches are added up in order, and their scatter gives the
 * standard errors.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/planar.h"

#include <string.h>

#include "bake/reference/planar_geometry.h"
#include "core/memory.h"

enum { BATCH_MIN = 1024, BATCH_MAX = 16384, BATCH_PHOTONS = 16384, WAVE = 16, BIN_MAX = 1 << 20 };

/* What one batch gathers. */
typedef struct tally {
    double total[2], unscattered;
    double *bin[2];
    parian_walk_books books;
} tally;

typedef struct walk {
    planar_ray ray;
    double weight;
    uint64_t event; /* scattering events so far */
    parian_random random;
} walk;

/* Sums over batches of a quantity S_b: of S_b^2 and S_b n_b, for its standard error. */
typedef struct spread {
    double sum, square, cross;
} spread;

typedef struct planar_run {
    const parian_planar_desc *desc;
    uint64_t batch_count, first; /* first batch of the wave */
    tally wave[WAVE];
    double *wave_bins; /* [WAVE][2][bin_count] */
    spread *bins;      /* [2][bin_count] */
    spread total[2], unscattered;
    double count_square; /* sum of n_b^2 */
} planar_run;

/* Photons are numbered; batch b has those from here on. */
static uint64_t first_photon(const planar_run *run, uint64_t batch)
{
    uint64_t n = run->desc->photons, share = n / run->batch_count, rest = n % run->batch_count;
    return batch * share + (batch < rest ? batch : rest);
}

/* Cosine-distributed light that crosses the boundary: a cosine outside, kept with the probability
 * that it is transmitted. All is symmetric about z, so the azimuth is 0. */
static void enter(const parian_planar_desc *desc, walk *w)
{
    double eta = desc->medium.eta, cone = eta < 1 ? eta * eta : 1; /* beyond it nothing enters */
    double sin2 = 0, inside = 1, reflectance = 0;
    while (!desc->normal_incidence) {
        sin2 = cone * parian_random_unit(&w->random);
        reflectance = parian_walk_fresnel(sqrt(1 - sin2), eta, &inside);
        if (parian_random_unit(&w->random) >= reflectance) {
            break;
        }
    }
    w->ray = (planar_ray){.direction = {sqrt(sin2) / eta, 0, -inside}};
    w->ray.position[2] = desc->shape == PARIAN_SPHERE ? desc->size : 0;
    w->weight = 1;
    w->event = 0;
}

static void deposit(const parian_planar_desc *desc, const walk *w, int side, double out, tally *t)
{
    t->total[side] += out;
    if (w->event == 0) {
        t->unscattered += out;
    }
    if (desc->bin_count > 0) {
        double place = planar_reach(desc->shape, desc->size, w->ray.position) / desc->bin_width;
        uint32_t last = desc->bin_count - 1;
        t->bin[side][place < last ? (uint32_t)place : last] += out;
    }
}

/* At the boundary: part leaves, the rest is mirrored. Updates what is left of the flight; false
 * when the walk ended. */
static inline bool cross(const parian_planar_desc *desc, parian_planar_shape shape, walk *w,
                         double *flight, tally *t)
{
    double normal[3], beyond;
    planar_land(shape, desc->size, &w->ray, normal);
    double cosine = planar_dot(w->ray.direction, normal);
    cosine = cosine < 0 ? 0 : cosine > 1 ? 1 : cosine;
    double reflectance = parian_walk_fresnel(cosine, 1 / desc->medium.eta, &beyond);
    parian_walk_reflect(w->ray.direction, normal);
    if (reflectance < 1) {
        double out = parian_walk_leave(&w->weight, reflectance, &t->books);
        deposit(desc, w, shape == PARIAN_SLAB && normal[2] < 0, out, t);
        return parian_walk_roulette(&w->weight, PARIAN_WALK_THRESHOLD, PARIAN_WALK_TARGET,
                                    &w->random, &t->books);
    }
    if (!(*flight < INFINITY)) { /* reflected for ever, and nothing to stop it */
        t->books.lost += w->weight;
        t->books.lost_walks++;
        return false;
    }
    if (shape == PARIAN_SLAB) {
        *flight = planar_skip_slab(desc->size, &w->ray, *flight);
    } else if (shape == PARIAN_SPHERE) {
        *flight = planar_skip_sphere(desc->size, cosine, &w->ray, *flight);
    }
    return true;
}

/* One free flight with its reflections; false when the walk ended. */
static inline bool fly(const parian_planar_desc *desc, parian_planar_shape shape, walk *w, tally *t)
{
    double flight = parian_walk_flight(desc->medium.sigma_t, &w->random);
    for (;;) {
        double distance = planar_distance(shape, desc->size, &w->ray);
        if (flight < distance) {
            planar_advance(&w->ray, flight);
            return true;
        }
        if (!(distance < INFINITY)) { /* neither matter nor boundary ahead */
            t->books.lost += w->weight;
            t->books.lost_walks++;
            return false;
        }
        planar_advance(&w->ray, distance);
        flight -= distance;
        if (!cross(desc, shape, w, &flight, t)) {
            return false;
        }
    }
}

static inline void walk_batch(const parian_planar_desc *desc, parian_planar_shape shape,
                              uint64_t begin, uint64_t end, tally *t)
{
    for (uint64_t photon = begin; photon < end; photon++) {
        walk w = {.random = parian_random_stream(desc->seed, photon, 0, 0)};
        enter(desc, &w);
        t->books.started += 1;
        while (fly(desc, shape, &w, t)) {
            w.event++;
            parian_walk_absorb(&w.weight, desc->medium.albedo, &t->books);
            if (!parian_walk_continue(&w.weight, w.event, &w.random, &t->books)) {
                break;
            }
            parian_walk_scatter(w.ray.direction, desc->medium.g, &w.random);
        }
    }
}

/* The shapes apart, so that each has an inner loop of its own. */
static void run_batch(void *context, size_t index)
{
    planar_run *run = context;
    const parian_planar_desc *desc = run->desc;
    uint64_t batch = run->first + index;
    uint64_t begin = first_photon(run, batch), end = first_photon(run, batch + 1);
    tally t = {.bin = {run->wave_bins + (size_t)desc->bin_count * (2 * index),
                       run->wave_bins + (size_t)desc->bin_count * (2 * index + 1)}};
    memset(t.bin[0], 0, 2 * (size_t)desc->bin_count * sizeof *t.bin[0]);
    if (desc->shape == PARIAN_HALF_SPACE) {
        walk_batch(desc, PARIAN_HALF_SPACE, begin, end, &t);
    } else if (desc->shape == PARIAN_SLAB) {
        walk_batch(desc, PARIAN_SLAB, begin, end, &t);
    } else {
        walk_batch(desc, PARIAN_SPHERE, begin, end, &t);
    }
    run->wave[index] = t;
}

static void spread_add(spread *s, double value, double count)
{
    s->sum += value;
    s->square += value * value;
    s->cross += value * count;
}

/* Standard error of sum / n: from the scatter of the batches about the mean. */
static double spread_error(const planar_run *run, const spread *s)
{
    double n = (double)run->desc->photons, mean = s->sum / n, batches = (double)run->batch_count;
    double scatter = s->square - 2 * mean * s->cross + mean * mean * run->count_square;
    return scatter > 0 ? sqrt(scatter * batches / (batches - 1)) / n : 0;
}

static void add_wave(planar_run *run, size_t count, parian_planar_profile *profile)
{
    size_t bins = run->desc->bin_count;
    for (size_t i = 0; i < count; i++) {
        const tally *t = &run->wave[i];
        uint64_t batch = run->first + i;
        double photons = (double)(first_photon(run, batch + 1) - first_photon(run, batch));
        run->count_square += photons * photons;
        spread_add(&run->unscattered, t->unscattered, photons);
        parian_walk_books_add(&profile->books, &t->books);
        for (size_t side = 0; side < 2; side++) {
            spread_add(&run->total[side], t->total[side], photons);
            for (size_t k = 0; k < bins; k++) {
                spread_add(&run->bins[side * bins + k], t->bin[side][k], photons);
            }
        }
    }
}

static parian_result run_all(const parian_env *env, planar_run *run, parian_planar_profile *profile)
{
    for (run->first = 0; run->first < run->batch_count; run->first += WAVE) {
        if (parian_cancelled(env)) {
            return parian_fail(env, PARIAN_E_INTERRUPTED, "random walks stopped after %llu of %llu",
                               (unsigned long long)first_photon(run, run->first),
                               (unsigned long long)run->desc->photons);
        }
        uint64_t left = run->batch_count - run->first;
        size_t count = left < WAVE ? (size_t)left : WAVE;
        parian_par(env, count, run_batch, run);
        add_wave(run, count, profile);
        parian_progress(env, "random walks",
                        (double)(run->first + count) / (double)run->batch_count);
    }
    return PARIAN_OK;
}

static void finish(const planar_run *run, parian_planar_profile *profile)
{
    double n = (double)run->desc->photons;
    size_t bins = run->desc->bin_count;
    profile->unscattered = run->unscattered.sum / n;
    profile->unscattered_error = spread_error(run, &run->unscattered);
    for (size_t side = 0; side < 2; side++) {
        profile->total[side] = run->total[side].sum / n;
        profile->total_error[side] = spread_error(run, &run->total[side]);
        for (size_t k = 0; k < bins; k++) {
            profile->bin[side][k] = run->bins[side * bins + k].sum / n;
            profile->bin_error[side][k] = spread_error(run, &run->bins[side * bins + k]);
        }
    }
}

/* Whether x is finite and at least, or above, zero. */
static bool is_coefficient(double x)
{
    return x >= 0 && x < INFINITY;
}

static bool is_positive(double x)
{
    return x > 0 && x < INFINITY;
}

static parian_result check(const parian_env *env, const parian_planar_desc *desc)
{
    const parian_walk_medium *m = &desc->medium;
    if (desc->shape > PARIAN_SPHERE ||
        (desc->shape != PARIAN_HALF_SPACE && !is_positive(desc->size))) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "a shape of kind %d and size %g m; expected a half-space, or a slab or "
                           "sphere of positive size",
                           (int)desc->shape, desc->size);
    }
    if (!is_coefficient(m->sigma_s) || !is_coefficient(m->sigma_a) ||
        !is_coefficient(m->sigma_s + m->sigma_a) || !(fabs(m->g) < 1) || !is_positive(m->eta)) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "a medium of sigma_s %g, sigma_a %g m^-1, g %g, eta %g; expected coefficients "
            "from 0 up, g in (-1, 1), eta above 0",
            m->sigma_s, m->sigma_a, m->g, m->eta);
    }
    if (desc->shape == PARIAN_HALF_SPACE && !(m->sigma_s + m->sigma_a > 0)) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "an empty half-space: light never comes back");
    }
    if (desc->photons < 2 || desc->bin_count > BIN_MAX ||
        (desc->bin_count > 0 && !is_positive(desc->bin_width))) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "%llu photons, %u bins of %g m; expected at least 2 photons, at most %d bins of "
            "positive width",
            (unsigned long long)desc->photons, desc->bin_count, desc->bin_width, BIN_MAX);
    }
    return PARIAN_OK;
}

static uint64_t choose_batch_count(uint64_t photons)
{
    uint64_t count = photons / BATCH_PHOTONS;
    count = count < BATCH_MIN ? BATCH_MIN : count > BATCH_MAX ? BATCH_MAX : count;
    return count < photons ? count : photons;
}

static bool allocate(const parian_env *env, planar_run *run, parian_planar_profile *profile)
{
    size_t bins = run->desc->bin_count;
    for (int side = 0; side < 2; side++) {
        if (!PARIAN_NEW0(env, profile->bin[side], bins) ||
            !PARIAN_NEW0(env, profile->bin_error[side], bins)) {
            return false;
        }
    }
    return PARIAN_NEW(env, run->wave_bins, 2 * WAVE * bins) &&
           PARIAN_NEW0(env, run->bins, 2 * bins);
}

parian_result parian_planar_profile_make(const parian_env *env, const parian_planar_desc *desc,
                                         parian_planar_profile *profile)
{
    *profile = (parian_planar_profile){0};
    parian_result result = check(env, desc);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_planar_desc copy = *desc; /* with the derived coefficients made sure of */
    copy.medium = parian_walk_medium_of(desc->medium.sigma_s, desc->medium.sigma_a, desc->medium.g,
                                        desc->medium.eta);
    planar_run run = {.desc = &copy, .batch_count = choose_batch_count(desc->photons)};
    if (!allocate(env, &run, profile)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for %u bins", desc->bin_count);
    } else {
        result = run_all(env, &run, profile);
    }
    if (result == PARIAN_OK) {
        finish(&run, profile);
    } else {
        parian_planar_profile_free(env, profile);
    }
    parian_free(env, run.wave_bins);
    parian_free(env, run.bins);
    return result;
}

void parian_planar_profile_free(const parian_env *env, parian_planar_profile *profile)
{
    if (profile) {
        for (int side = 0; side < 2; side++) {
            parian_free(env, profile->bin[side]);
            parian_free(env, profile->bin_error[side]);
        }
        *profile = (parian_planar_profile){0};
    }
}
