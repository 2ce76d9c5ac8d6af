/* bench_walks.c - random walks in closed-form geometry: agreement with an independent program, and
 * events per second.
 *
 *   bench_walks [--photons N] [--roulette]
 *
 * The first table compares every total with its oracle (planar_oracles.h): ours, our standard error
 * and the oracle's in percent, the difference in combined standard errors and in percent. The
 * second, with --roulette, shows what the absence of absorption costs. Seconds and rates are of
 * processor time, so per core. N (default 2,000,000) is for a half-space; other shapes take twice
 * as many.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "support/planar_oracles.h"

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

typedef struct run {
    parian_planar_profile profile;
    double seconds;
} run;

static bool walk(const parian_planar_desc *desc, run *r)
{
    double start = cpu_seconds();
    parian_result result = parian_planar_profile_make(test_env(0), desc, &r->profile);
    r->seconds = cpu_seconds() - start;
    return result == PARIAN_OK;
}

static void print_total(const planar_oracle *oracle, int side, const run *r, uint64_t photons)
{
    const parian_planar_profile *p = &r->profile;
    double error = p->total_error[side], expected = oracle->total[side];
    double theirs = error * sqrt((double)photons / PLANAR_ORACLE_PHOTONS);
    double difference = p->total[side] - expected;
    printf("| %s%s | %.6f | %.3f %% | %.6f | %.3f %% | %+.2f | %+.3f %% | %.1f | %.1f |\n",
           oracle->name,
           oracle->shape != PARIAN_SLAB ? ""
           : side                       ? ", far side"
                                        : ", lit side",
           p->total[side], 100 * error / p->total[side], expected, 100 * theirs / expected,
           difference / hypot(error, theirs), 100 * difference / expected, r->seconds,
           (double)p->books.events / r->seconds * 1e-6);
}

static bool compare_with_oracles(uint64_t half_space_photons)
{
    printf("| body | ours | error | oracle | error | difference, SE | difference | s | million "
           "events/s |\n|---|---|---|---|---|---|---|---|---|\n");
    parian_walk_books all = {0};
    double seconds = 0, worst = 0;
    for (size_t i = 0; i < PLANAR_ORACLE_COUNT; i++) {
        const planar_oracle *oracle = &planar_oracles[i];
        uint64_t photons =
            oracle->shape == PARIAN_HALF_SPACE ? half_space_photons : 2 * half_space_photons;
        parian_planar_desc desc = planar_oracle_desc(oracle, photons, 7000 + i);
        run r;
        if (!walk(&desc, &r)) {
            return false;
        }
        for (int side = 0; side < (oracle->shape == PARIAN_SLAB ? 2 : 1); side++) {
            print_total(oracle, side, &r, photons);
        }
        parian_walk_books_add(&all, &r.profile.books);
        seconds += r.seconds;
        worst = fmax(worst, fabs(parian_walk_books_gap(&r.profile.books)));
        parian_planar_profile_free(test_env(0), &r.profile);
    }
    printf("\n%.0f million events in %.1f s of processor time: %.1f million per second and core; "
           "largest gap of the books %.1e\n",
           (double)all.events * 1e-6, seconds, (double)all.events * 1e-6 / seconds, worst);
    return true;
}

/* A half-space of eta 1.5 as absorption goes to nothing: how many events a walk takes, and how the
 * standard error falls. */
static bool price_of_no_absorption(void)
{
    static const double sigma_a[] = {1e-2, 1e-4, 1e-6, 0};
    static const uint64_t photons[] = {10000, 100000, 1000000};
    printf("\n| sigma_a / sigma_t | photons | total | standard error | events per photon | s |\n"
           "|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < 4; i++) {
        for (size_t k = 0; k < 3; k++) {
            parian_planar_desc desc = {
                .shape = PARIAN_HALF_SPACE,
                .medium = parian_walk_medium_of(1 - sigma_a[i], sigma_a[i], 0, 1.5),
                .photons = photons[k],
                .seed = 8000 + i};
            run r;
            if (!walk(&desc, &r)) {
                return false;
            }
            printf("| %g | %llu | %.5f | %.5f | %.0f | %.1f |\n", sigma_a[i],
                   (unsigned long long)photons[k], r.profile.total[0], r.profile.total_error[0],
                   (double)r.profile.books.events / (double)photons[k], r.seconds);
            parian_planar_profile_free(test_env(0), &r.profile);
        }
    }
    return true;
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0); /* a row shows when it is done */
    uint64_t photons = 2000000;
    bool roulette = false;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--roulette") == 0) {
            roulette = true;
        } else if (strcmp(argv[i], "--photons") == 0 && i + 1 < argc) {
            photons = strtoull(argv[++i], NULL, 10);
        } else {
            fprintf(stderr, "usage: bench_walks [--photons N] [--roulette]\n");
            return 2;
        }
    }
    bool good = compare_with_oracles(photons);
    return good && (!roulette || price_of_no_absorption()) ? 0 : 1;
}
