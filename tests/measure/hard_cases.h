/* hard_cases.h - the cases that break naive code, each baked, relit and compared with a truth.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_HARD_CASES_H
#define PARIAN_MEASURE_HARD_CASES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/mesh.h"
#include "parian/env.h"
#include "parian/light.h"
#include "parian/result.h"

/* What B is compared with. */
typedef enum parian_hard_truth {
    PARIAN_HARD_QUADRATURE =
        0,               /* the same BSSRDF on the same surface: the error of the discretisation */
    PARIAN_HARD_PATH,    /* path tracing: the error of the model as well */
    PARIAN_HARD_LAMBERT, /* C(infinity) E: what is left when light does not travel */
    PARIAN_HARD_REFUSED /* the bake must refuse; quadrature is compared with path tracing instead */
} parian_hard_truth;

/* Models: hard_meshes.c. */
typedef enum parian_hard_shape {
    PARIAN_SHAPE_SPHERE = 0,
    PARIAN_SHAPE_UNEVEN_SPHERE, /* triangles of very different size */
    PARIAN_SHAPE_ZERO_AREA,     /* a sphere with triangles of no area between others */
    PARIAN_SHAPE_BOWL,          /* a sphere without its upper part */
    PARIAN_SHAPE_TOUCHING,      /* two cubes that share an edge of four triangles */
    PARIAN_SHAPE_BOX,
    PARIAN_SHAPE_CREASE, /* an L: a concave crease */
    PARIAN_SHAPE_SHEET   /* 40 x 40 x 1 */
} parian_hard_shape;

typedef enum parian_hard_light {
    PARIAN_HARD_SUN = 0, /* directional, from above, and a tenth of it from everywhere */
    PARIAN_HARD_SKY,     /* from everywhere */
    PARIAN_HARD_SPOT,    /* a narrow cone, in the dark */
    PARIAN_HARD_NIGHT    /* a light that meets nothing */
} parian_hard_light;

typedef struct parian_hard_case {
    const char *name;
    parian_hard_shape shape;
    double size_m;                       /* longest side */
    double sigma_s_prime[3], sigma_a[3]; /* in units of 1 / size */
    double g, eta;                       /* g 0: coefficients are given reduced */
    parian_hard_light light;
    parian_hard_truth truth;
    double error_max, energy_max; /* of L2, and of |energy ratio - 1| */
    double minimum;               /* smallest B over the mean of the truth that is allowed */
    bool flux; /* the dipole with the true gradient at the receiver, in the bake and the quadrature
                */
    const char *reason; /* why these numbers */
} parian_hard_case;

extern const parian_hard_case parian_hard_case_table[];
extern const size_t parian_hard_case_count;

/* What a case gave. */
typedef struct parian_hard_outcome {
    bool finite, pass, measured;    /* measured: energy_ratio and error are there */
    double energy_ratio, error;     /* of the worst channel */
    double minimum, standard_error; /* of B and of the truth, over the mean of the truth */
    double seconds;
    uint64_t texels, receivers;
    char note[256]; /* what a failing stage said */
} parian_hard_outcome;

/* Print the names, one a line, to stdout. Returns an exit status. */
int parian_hard_cases_list(void);
/* Run all cases, or those that `names` gives with commas between them, and write hard-cases.csv,
 * hard-cases.md and the models into the folder. A case that falls short is a finding, no failure.
 * Errors: PARIAN_E_ARGUMENT (an unknown name), PARIAN_E_IO, PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED.
 */
parian_result parian_hard_cases_run(const parian_env *env, const char *folder, const char *names);

/* ---- hard_meshes.c ---- */
/* A model whose longest side is size_m. Errors: PARIAN_E_NOMEM. */
parian_result parian_hard_mesh(const parian_env *env, parian_hard_shape shape, double size_m,
                               parian_mesh *mesh);
/* Write a mesh as OFF, metres. Errors: PARIAN_E_IO, PARIAN_E_NOMEM. */
parian_result parian_hard_mesh_write(const parian_env *env, const parian_mesh *mesh,
                                     const char *path);
/* The lights of a case; returns how many. */
enum { PARIAN_HARD_LIGHTS_MAX = 2 };
size_t parian_hard_lights(parian_hard_light kind, double size_m,
                          parian_light light[PARIAN_HARD_LIGHTS_MAX]);

/* ---- hard_case_run.c ---- */
/* Bake, relight and compare one case; its model and medium are written into the folder. Only errors
 * that are no finding are returned: PARIAN_E_IO, PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED. */
parian_result parian_hard_case_run(const parian_env *env, const parian_hard_case *c,
                                   const char *folder, parian_hard_outcome *outcome);

#endif
