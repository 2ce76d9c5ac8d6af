/* flip.c - LDR-FLIP: contrast-sensitivity filters, Hunt-adjusted colour difference, edges and
 * points.
 *
 * Filters are separable. Opponent channels are kept without the factors 116, 500, 200 of YCxCz: the
 * filters sum to one, so the factors cancel.
 *
 * Source  [Andersson20]; colour matrices of IEC 61966-2-1 with the white of D65
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/flip.h"

#include <math.h>

#include "core/clones.h"
#include "core/memory.h"

enum {
    RADIUS_MAX = 64, /* of a filter at 400 pixels per degree */
    TAPS_MAX = 2 * RADIUS_MAX + 1,
    CHUNK = 256, /* pixels of a row that are worked on at once */
    PADDED = CHUNK + 2 * RADIUS_MAX
};

/* Planes after the filters along x, and what describes a pixel in the end. */
enum { ROW_Y, ROW_CX, ROW_CZ_WIDE, ROW_CZ_NARROW, ROW_SLOPE, ROW_BEND, ROW_GAUSS, ROW_PLANES };
enum { SEEN_L, SEEN_A, SEEN_B, SEEN_EDGE, SEEN_POINT, SEEN_PLANES };

static const double RGB_TO_XYZ[3][3] = {
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382},
};
static const double XYZ_TO_RGB[3][3] = {
    {3.241003275, -1.537398934, -0.498615861},
    {-0.969224334, 1.875930071, 0.041554224},
    {0.055639423, -0.204011202, 1.057148933},
};
static const double WHITE[3] = {0.950428545, 1.0, 1.088900371};

/* [Andersson20] section 4: exponents and knee of the colour error, width and exponent of features.
 */
static const double COLOR_EXPONENT = 0.7, KNEE_INPUT = 0.4, KNEE_OUTPUT = 0.95;
static const double FEATURE_WIDTH_DEG = 0.082, FEATURE_EXPONENT = 0.5;

/* Contrast sensitivity: sum of weight sqrt(pi / width) exp(-pi^2 r^2 / width), r in degrees. */
static const double Y_WIDTH = 0.0047, CX_WIDTH = 0.0053;
static const double CZ_WEIGHT[2] = {34.1, 13.5}, CZ_WIDTH[2] = {0.04, 0.025};

typedef struct filter {
    int radius;
    double tap[TAPS_MAX]; /* [2 radius + 1] */
} filter;

typedef struct filters {
    filter y, cx, cz[2];       /* contrast sensitivity, each of sum 1 */
    double cz_share[2];        /* of the two parts of Cz */
    filter gauss, slope, bend; /* of the feature detectors */
    int pad;                   /* largest radius */
} filters;

typedef struct flip_job {
    uint32_t width, height;
    const float (*picture)[4];
    const filters *filters;
    bool filmic;
    double factor; /* 2^exposure */
    double *row;   /* [ROW_PLANES][height][width] */
    double *seen;  /* [SEEN_PLANES][height][width] */
    const double *reference_seen;
    double largest; /* colour error of the extremes */
    float *map;
} flip_job;

/* ---- filters -----------------------------------------------------------------------------------
 */
/* exp(-falloff x^2) over pixels, of sum 1; the sum before that is returned. */
static double make_gauss(filter *f, int radius, double falloff)
{
    double sum = 0;
    f->radius = radius;
    for (int x = -radius; x <= radius; x++) {
        sum += exp(-falloff * x * x);
    }
    for (int x = -radius; x <= radius; x++) {
        f->tap[x + radius] = exp(-falloff * x * x) / sum;
    }
    return sum;
}

/* Derivative of a Gaussian (order 1: slope, 2: bend): what is positive sums to 1, what is negative
 * to -1. */
static void make_derivative(filter *f, int radius, double deviation, int order)
{
    double tap[TAPS_MAX], sum[2] = {0, 0};
    f->radius = radius;
    for (int x = -radius; x <= radius; x++) {
        double t = x / deviation, w = (order == 1 ? -t : t * t - 1) * exp(-0.5 * t * t);
        tap[x + radius] = w;
        sum[w > 0] += fabs(w);
    }
    for (int i = 0; i <= 2 * radius; i++) {
        f->tap[i] = tap[i] / sum[tap[i] > 0];
    }
}

static void make_filters(filters *f, double ppd)
{
    const double pi = 3.14159265358979323846, pixel = 1 / ppd;
    int radius = (int)ceil(3 * sqrt(CZ_WIDTH[0] / (2 * pi * pi)) * ppd);
    double part[2];
    make_gauss(&f->y, radius, pi * pi * pixel * pixel / Y_WIDTH);
    make_gauss(&f->cx, radius, pi * pi * pixel * pixel / CX_WIDTH);
    for (int i = 0; i < 2; i++) {
        double sum = make_gauss(&f->cz[i], radius, pi * pi * pixel * pixel / CZ_WIDTH[i]);
        part[i] = CZ_WEIGHT[i] * sqrt(pi / CZ_WIDTH[i]) * sum * sum;
    }
    for (int i = 0; i < 2; i++) {
        f->cz_share[i] = part[i] / (part[0] + part[1]);
    }
    double deviation = 0.5 * FEATURE_WIDTH_DEG * ppd;
    int feature_radius = (int)ceil(3 * deviation);
    make_gauss(&f->gauss, feature_radius, 0.5 / (deviation * deviation));
    make_derivative(&f->slope, feature_radius, deviation, 1);
    make_derivative(&f->bend, feature_radius, deviation, 2);
    f->pad = radius > feature_radius ? radius : feature_radius;
}

/* sum[i] += tap * in[i] */
PARIAN_CLONES static void accumulate(double *sum, const double *in, double tap, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        sum[i] += tap * in[i];
    }
}

/* ---- colours -----------------------------------------------------------------------------------
 */
/* Filmic curve, a fit of ACES without its exposure of 0.6 [Andersson21]. */
static double filmic(double x)
{
    double y = (0.9036 * x + 0.018) * x / ((0.8748 * x + 0.354) * x + 0.14);
    return isfinite(y) ? y : 1;
}

static double shown(const flip_job *job, float value)
{
    double v = isfinite(value) && value > 0 ? value : 0;
    if (job->filmic) {
        v = filmic(v * job->factor);
    }
    return v < 1 ? v : 1;
}

/* Linear RGB to X, Y, Z over those of white. */
static void to_relative_xyz(const double rgb[3], double xyz[3])
{
    for (int i = 0; i < 3; i++) {
        const double *m = RGB_TO_XYZ[i];
        xyz[i] = (m[0] * rgb[0] + m[1] * rgb[1] + m[2] * rgb[2]) / WHITE[i];
    }
}

static double lab_curve(double t)
{
    const double delta = 6.0 / 29;
    return t > delta * delta * delta ? cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
}

/* Linear RGB to CIELab with a and b times L / 100: Hunt, colours look paler in the dark. */
static void to_hunt_lab(const double rgb[3], double lab[3])
{
    double xyz[3];
    to_relative_xyz(rgb, xyz);
    double x = lab_curve(xyz[0]), y = lab_curve(xyz[1]), z = lab_curve(xyz[2]);
    lab[0] = 116 * y - 16;
    lab[1] = 0.01 * lab[0] * 500 * (x - y);
    lab[2] = 0.01 * lab[0] * 200 * (y - z);
}

/* HyAB distance to the power of the colour exponent. */
static double color_difference(double l, double a, double b)
{
    return pow(fabs(l) + sqrt(a * a + b * b), COLOR_EXPONENT);
}

/* The largest difference of colours of a display: green and blue. */
static double largest_difference(void)
{
    double green[3], blue[3];
    to_hunt_lab((const double[3]){0, 1, 0}, green);
    to_hunt_lab((const double[3]){0, 0, 1}, blue);
    return color_difference(green[0] - blue[0], green[1] - blue[1], green[2] - blue[2]);
}

/* ---- passes ------------------------------------------------------------------------------------
 */
/* Opponent channels y, x - y, y - z of pixels [start - pad, start + count + pad) of a row; borders
 * repeat. */
static void load_opponent(const flip_job *job, size_t y, long start, long count,
                          double channel[3][PADDED])
{
    int pad = job->filters->pad;
    const float(*line)[4] = job->picture + y * job->width;
    for (long i = 0; i < count + 2 * pad; i++) {
        long x = start + i - pad, last = (long)job->width - 1;
        const float *p = line[x < 0 ? 0 : x > last ? last : x];
        double rgb[3] = {shown(job, p[0]), shown(job, p[1]), shown(job, p[2])}, xyz[3];
        to_relative_xyz(rgb, xyz);
        channel[0][i] = xyz[1];
        channel[1][i] = xyz[0] - xyz[1];
        channel[2][i] = xyz[1] - xyz[2];
    }
}

static void filter_row(void *context, size_t y)
{
    const flip_job *job = context;
    const filters *f = job->filters;
    const filter *const use[ROW_PLANES] = {&f->y,     &f->cx,   &f->cz[0], &f->cz[1],
                                           &f->slope, &f->bend, &f->gauss};
    static const int source[ROW_PLANES] = {0, 1, 2, 2, 0, 0, 0};
    size_t plane_size = (size_t)job->width * job->height;
    for (long start = 0; start < (long)job->width; start += CHUNK) {
        long left = (long)job->width - start, count = left < CHUNK ? left : CHUNK;
        double channel[3][PADDED];
        load_opponent(job, y, start, count, channel);
        for (int p = 0; p < ROW_PLANES; p++) {
            double sum[CHUNK] = {0},
                   *out = job->row + (size_t)p * plane_size + y * job->width + start;
            for (int k = -use[p]->radius; k <= use[p]->radius; k++) {
                accumulate(sum, channel[source[p]] + f->pad + k, use[p]->tap[k + use[p]->radius],
                           (size_t)count);
            }
            for (long i = 0; i < count; i++) {
                out[i] = sum[i];
            }
        }
    }
}

/* One plane through a filter along y, for a chunk of row y. */
static void filter_column(const flip_job *job, int plane, const filter *f, size_t y, size_t start,
                          size_t count, double sum[CHUNK])
{
    const double *in = job->row + (size_t)plane * job->width * job->height + start;
    for (size_t i = 0; i < count; i++) {
        sum[i] = 0;
    }
    for (int k = -f->radius; k <= f->radius; k++) {
        long from = (long)y + k, last = (long)job->height - 1;
        from = from < 0 ? 0 : from > last ? last : from;
        accumulate(sum, in + (size_t)from * job->width, f->tap[k + f->radius], count);
    }
}

static void see_colors(const flip_job *job, size_t y, size_t start, size_t count)
{
    const filters *f = job->filters;
    double part[4][CHUNK];
    size_t plane_size = (size_t)job->width * job->height;
    filter_column(job, ROW_Y, &f->y, y, start, count, part[0]);
    filter_column(job, ROW_CX, &f->cx, y, start, count, part[1]);
    filter_column(job, ROW_CZ_WIDE, &f->cz[0], y, start, count, part[2]);
    filter_column(job, ROW_CZ_NARROW, &f->cz[1], y, start, count, part[3]);
    for (size_t i = 0; i < count; i++) {
        double luminance = part[0][i];
        double cz = f->cz_share[0] * part[2][i] + f->cz_share[1] * part[3][i];
        double xyz[3] = {(luminance + part[1][i]) * WHITE[0], luminance * WHITE[1],
                         (luminance - cz) * WHITE[2]};
        double rgb[3], lab[3];
        for (int c = 0; c < 3; c++) {
            const double *m = XYZ_TO_RGB[c];
            rgb[c] = fmin(fmax(m[0] * xyz[0] + m[1] * xyz[1] + m[2] * xyz[2], 0), 1);
        }
        to_hunt_lab(rgb, lab);
        for (int c = 0; c < 3; c++) {
            job->seen[(size_t)(SEEN_L + c) * plane_size + y * job->width + start + i] = lab[c];
        }
    }
}

static void see_features(const flip_job *job, size_t y, size_t start, size_t count)
{
    const filters *f = job->filters;
    double along_x[CHUNK], along_y[CHUNK];
    size_t plane_size = (size_t)job->width * job->height;
    static const struct {
        int plane, seen;
    } kind[2] = {{ROW_SLOPE, SEEN_EDGE}, {ROW_BEND, SEEN_POINT}};
    for (int n = 0; n < 2; n++) {
        double *out = job->seen + (size_t)kind[n].seen * plane_size + y * job->width + start;
        filter_column(job, kind[n].plane, &f->gauss, y, start, count, along_x);
        filter_column(job, ROW_GAUSS, n == 0 ? &f->slope : &f->bend, y, start, count, along_y);
        for (size_t i = 0; i < count; i++) {
            out[i] = sqrt(along_x[i] * along_x[i] + along_y[i] * along_y[i]);
        }
    }
}

static void see_row(void *context, size_t y)
{
    const flip_job *job = context;
    for (size_t start = 0; start < job->width; start += CHUNK) {
        size_t left = job->width - start, count = left < CHUNK ? left : CHUNK;
        see_colors(job, y, start, count);
        see_features(job, y, start, count);
    }
}

/* ---- difference --------------------------------------------------------------------------------
 */
static double color_error(const flip_job *job, const double d[SEEN_PLANES])
{
    double error = color_difference(d[SEEN_L], d[SEEN_A], d[SEEN_B]),
           knee = KNEE_INPUT * job->largest;
    return error < knee ? error * KNEE_OUTPUT / knee
                        : KNEE_OUTPUT + (error - knee) / (job->largest - knee) * (1 - KNEE_OUTPUT);
}

static void compare_row(void *context, size_t y)
{
    const flip_job *job = context;
    size_t plane_size = (size_t)job->width * job->height;
    for (size_t i = y * job->width; i < (y + 1) * job->width; i++) {
        double d[SEEN_PLANES];
        for (size_t p = 0; p < SEEN_PLANES; p++) {
            d[p] = job->seen[p * plane_size + i] - job->reference_seen[p * plane_size + i];
        }
        double feature = fmax(fabs(d[SEEN_EDGE]), fabs(d[SEEN_POINT])) / sqrt(2.0);
        job->map[i] = (float)pow(color_error(job, d), 1 - pow(feature, FEATURE_EXPONENT));
    }
}

static void see(const parian_env *env, flip_job *job, const float (*picture)[4], double *seen)
{
    job->picture = picture;
    job->seen = seen;
    parian_par(env, job->height, filter_row, job);
    parian_par(env, job->height, see_row, job);
}

parian_result parian_flip_ldr(const parian_env *env, uint32_t width, uint32_t height,
                              const float (*image)[4], const float (*reference)[4],
                              const parian_flip_desc *desc, float *map)
{
    double ppd = desc && desc->pixels_per_degree != 0 ? desc->pixels_per_degree
                                                      : PARIAN_FLIP_PIXELS_PER_DEGREE;
    filters f;
    double *planes;
    size_t count = (size_t)width * height;
    if (count == 0 || !(ppd >= 1 && ppd <= 400)) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "FLIP of %u x %u pixels at %g pixels per degree; expected pixels and 1 to 400 a degree",
            width, height, ppd);
    }
    if (count > SIZE_MAX / 64 || !PARIAN_NEW(env, planes, count * (ROW_PLANES + 2 * SEEN_PLANES))) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for FLIP of %u x %u pixels", width,
                           height);
    }
    make_filters(&f, ppd);
    double *reference_seen = planes + count * ROW_PLANES;
    flip_job job = {.width = width, .height = height, .filters = &f, .row = planes, .map = map};
    job.filmic = desc && desc->filmic;
    job.factor = job.filmic ? exp2(desc->exposure) : 1;
    job.largest = largest_difference();
    job.reference_seen = reference_seen;
    see(env, &job, reference, reference_seen);
    see(env, &job, image, reference_seen + count * SEEN_PLANES);
    parian_par(env, height, compare_row, &job);
    parian_free(env, planes);
    return PARIAN_OK;
}
