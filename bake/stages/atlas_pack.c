/* atlas_pack.c - places the rasterised shapes of charts in a square, largest first, bottom-left.
 *
 * Shapes, not boxes, are placed: a chart is the set of cells that it touches, and slips into any
 * gap that takes it, in any of four orientations. Every row of the grid knows the next blocked
 * and the next free cell, so that a scan for a place leaps over what is taken.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/atlas_pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Consecutive cells of a row of a shape: begin <= x < end. */
typedef struct run {
    uint16_t row, begin, end;
} run;

typedef struct shape {
    uint32_t width, height, run_count;
    run *runs;
} shape;

/* height: what the height of a shape counts against how low it lies, when its orientation is
 * chosen; at 1 its top counts. length: what long charts count more than their area, when the order
 * is chosen. */
static const struct {
    double height, length;
} TACTICS[PACK_TACTICS] = {{0.25, 0.25}, {0.0, 0.25}, {1.0, 0.25}, {0.25, 1.0}};

typedef struct packer {
    const parian_env *env;
    const chart_set *set;
    const pack_grid *grid;
    unsigned tactic;
    uint8_t *mask;                      /* [side * side] scratch: cells of the chart at hand */
    uint8_t *blocked;                   /* [side * side] cells that no further chart may touch */
    uint16_t *next_blocked, *next_free; /* [side * side] first such x at or after a cell, or side */
    run *scratch;                       /* [run_room] */
    size_t run_room;
} packer;

void chart_place_point(const chart_place *place, double scale, const double flat[2], double out[2])
{
    double u = flat[0] * scale + place->slack[0];
    double v = flat[1] * scale + place->slack[1];
    double w = place->width, h = place->height;
    const double turned[4][2] = {{u, v}, {h - v, u}, {w - u, h - v}, {v, w - u}};
    out[0] = place->x + turned[place->quarter][0];
    out[1] = place->y + turned[place->quarter][1];
}

/* Mark the cells that a triangle touches, row by row: the part of it within a row is convex, so the
 * cells between its extremes are all touched. */
static void mark_triangle(const double corner[3][2], uint32_t width, uint32_t height, uint8_t *mask)
{
    double low = fmin(corner[0][1], fmin(corner[1][1], corner[2][1]));
    double high = fmax(corner[0][1], fmax(corner[1][1], corner[2][1]));
    uint32_t last = (uint32_t)fmin(fmax(ceil(high) - 1.0, floor(low)), height - 1.0);
    for (uint32_t y = (uint32_t)fmax(low, 0.0); y <= last && y < height; y++) {
        double least = INFINITY, most = -INFINITY;
        for (int k = 0; k < 3; k++) {
            const double *p = corner[k], *q = corner[(k + 1) % 3];
            if (fmax(p[1], q[1]) < y || fmin(p[1], q[1]) > y + 1.0) {
                continue;
            }
            double slope = p[1] != q[1] ? (q[0] - p[0]) / (q[1] - p[1]) : 0.0;
            for (int end = 0; end < 2; end++) {
                const double *r = end ? q : p;
                double v = fmin(fmax(r[1], y), y + 1.0);
                double x = r[1] == v ? r[0] : p[0] + slope * (v - p[1]);
                least = fmin(least, x);
                most = fmax(most, x);
            }
        }
        if (least > most) {
            continue;
        }
        uint32_t begin = (uint32_t)fmin(fmax(least, 0.0), width - 1.0);
        uint32_t end = (uint32_t)fmin(fmax(ceil(most), begin + 1.0), width);
        memset(mask + (size_t)y * width + begin, 1, end - begin);
    }
}

/* Write the runs of a mask seen after quarter turns; their number. */
static uint32_t find_runs(const uint8_t *mask, uint32_t width, uint32_t height, uint32_t quarter,
                          run *out)
{
    uint32_t rows = quarter % 2 ? width : height, length = quarter % 2 ? height : width, count = 0;
    for (uint32_t y = 0; y < rows; y++) {
        /* Cells of the turned row lie at start + x * step. */
        ptrdiff_t w = width, h = height, v = y;
        const ptrdiff_t starts[4] = {v * w, (h - 1) * w + v, h * w - 1 - v * w, w - 1 - v};
        const ptrdiff_t steps[4] = {1, -w, -1, w};
        const uint8_t *cell = mask + starts[quarter];
        for (uint32_t x = 0, begin = 0; x <= length; x++) {
            if (x < length && cell[(ptrdiff_t)x * steps[quarter]]) {
                continue;
            }
            if (x > begin) {
                if (out) {
                    out[count] = (run){(uint16_t)y, (uint16_t)begin, (uint16_t)x};
                }
                count++;
            }
            begin = x + 1;
        }
    }
    return count;
}

/* Size of a chart's box; false when it cannot lie in the grid. */
static bool measure_box(const packer *p, uint32_t chart, chart_place *place)
{
    double limit = p->grid->side - 2.0;
    for (int d = 0; d < 2; d++) {
        double size = p->set->extent[chart][d] * p->grid->scale;
        double cells = fmax(1.0, ceil(size - 1e-9));
        if (!(cells <= limit)) {
            return false;
        }
        *(d ? &place->height : &place->width) = (uint32_t)cells;
        place->slack[d] = 0.5 * (cells - size);
    }
    return true;
}

/* Rasterise a chart into the mask and list the runs of its four orientations. */
static bool make_shapes(packer *p, uint32_t chart, const chart_place *place, shape out[4])
{
    const chart_set *set = p->set;
    chart_place still = *place;
    still.x = still.y = still.quarter = 0;
    memset(p->mask, 0, (size_t)place->width * place->height);
    for (uint32_t i = set->chart_begin[chart]; i < set->chart_begin[chart + 1]; i++) {
        double corner[3][2];
        for (int k = 0; k < 3; k++) {
            chart_place_point(&still, p->grid->scale, set->flat[set->chart_member[i]][k],
                              corner[k]);
        }
        mark_triangle((const double(*)[2])corner, place->width, place->height, p->mask);
    }
    size_t total = 0;
    for (uint32_t quarter = 0; quarter < 4; quarter++) {
        total += find_runs(p->mask, place->width, place->height, quarter, NULL);
    }
    if (total > p->run_room) {
        parian_free(p->env, p->scratch);
        p->run_room = 2 * total;
        if (!PARIAN_NEW(p->env, p->scratch, p->run_room)) {
            p->run_room = 0;
            return false;
        }
    }
    run *next = p->scratch;
    for (uint32_t quarter = 0; quarter < 4; quarter++) {
        shape *s = &out[quarter];
        s->width = quarter % 2 ? place->height : place->width;
        s->height = quarter % 2 ? place->width : place->height;
        s->runs = next;
        s->run_count = find_runs(p->mask, place->width, place->height, quarter, next);
        next += s->run_count;
    }
    return true;
}

/* The first x at or after `from` where a shape whose low row is y touches nothing; side where none.
 * The run that stood in the way last is asked first. */
static uint32_t find_in_row(const packer *p, const shape *s, uint32_t y, uint32_t from)
{
    uint32_t side = p->grid->side, last = side - 1 - s->width, x = from;
    uint32_t clear = 0, i = 0;
    while (x <= last) {
        const run *r = &s->runs[i];
        size_t row = (size_t)(y + r->row) * side;
        uint32_t hit = p->next_blocked[row + x + r->begin];
        if (hit < x + r->end) {
            x = p->next_free[row + hit] - r->begin;
            clear = 0;
            continue;
        }
        if (++clear == s->run_count) {
            return x;
        }
        i = i + 1 == s->run_count ? 0 : i + 1;
    }
    return side;
}

/* The lowest, then leftmost place of a shape. */
static bool find_place(const packer *p, const shape *s, uint32_t *x, uint32_t *y)
{
    uint32_t side = p->grid->side;
    if (s->width + 2 > side || s->height + 2 > side) {
        return false;
    }
    for (uint32_t v = 1; v + s->height < side; v++) {
        uint32_t u = find_in_row(p, s, v, 1);
        if (u < side) {
            *x = u;
            *y = v;
            return true;
        }
    }
    return false;
}

/* Renew the leaps of a row after cells of it were blocked. */
static void renew_row(packer *p, uint32_t y)
{
    uint32_t side = p->grid->side;
    size_t row = (size_t)y * side;
    uint16_t blocked = (uint16_t)side, open = (uint16_t)side;
    for (uint32_t x = side; x-- > 0;) {
        if (p->blocked[row + x]) {
            blocked = (uint16_t)x;
        } else {
            open = (uint16_t)x;
        }
        p->next_blocked[row + x] = blocked;
        p->next_free[row + x] = open;
    }
}

/* Block the cells of a placed shape and those within the gap around them. */
static void block_shape(packer *p, const shape *s, uint32_t x, uint32_t y)
{
    uint32_t side = p->grid->side, gap = p->grid->gap;
    uint32_t first = y > gap ? y - gap : 0;
    uint32_t last = y + s->height + gap < side ? y + s->height + gap : side;
    for (uint32_t i = 0; i < s->run_count; i++) {
        const run *r = &s->runs[i];
        uint32_t begin = x + r->begin > gap ? x + r->begin - gap : 0;
        uint32_t end = x + r->end + gap < side ? x + r->end + gap : side;
        for (uint32_t v = y + r->row; v <= y + r->row + 2 * gap; v++) {
            if (v >= gap && v - gap < side) {
                memset(p->blocked + (size_t)(v - gap) * side + begin, 1, end - begin);
            }
        }
    }
    for (uint32_t v = first; v < last; v++) {
        renew_row(p, v);
    }
}

/* Place one chart; false where there is no room. */
static parian_result place_chart(packer *p, uint32_t chart, chart_place *place, bool *fits)
{
    shape shapes[4];
    double best = INFINITY;
    uint32_t x = 0, y = 0;
    *fits = measure_box(p, chart, place);
    if (!*fits) {
        return PARIAN_OK;
    }
    if (!make_shapes(p, chart, place, shapes)) {
        return PARIAN_E_NOMEM;
    }
    for (uint32_t quarter = 0; quarter < 4; quarter++) {
        if (!find_place(p, &shapes[quarter], &x, &y)) {
            continue;
        }
        double cost = y + TACTICS[p->tactic].height * shapes[quarter].height;
        if (cost < best) {
            best = cost;
            place->quarter = quarter;
            place->x = x;
            place->y = y;
        }
    }
    *fits = best < INFINITY;
    if (*fits) {
        block_shape(p, &shapes[place->quarter], place->x, place->y);
    }
    return PARIAN_OK;
}

typedef struct size_entry {
    double size;
    uint32_t chart;
} size_entry;

static int larger_first(const void *left, const void *right)
{
    const size_entry *a = left, *b = right;
    if (a->size != b->size) {
        return a->size > b->size ? -1 : 1;
    }
    return a->chart < b->chart ? -1 : a->chart > b->chart;
}

/* Charts by the area of their boxes, weighted towards long ones, which are hard to place late. */
static size_entry *sort_charts(const parian_env *env, const chart_set *set, double length)
{
    size_entry *order;
    if (!PARIAN_NEW(env, order, set->chart_count)) {
        return NULL;
    }
    for (uint32_t c = 0; c < set->chart_count; c++) {
        double a = set->extent[c][0], b = set->extent[c][1];
        order[c] = (size_entry){a * b + length * fmax(a, b) * fmax(a, b), c};
    }
    qsort(order, set->chart_count, sizeof *order, larger_first);
    return order;
}

parian_result chart_set_pack(const parian_env *env, const chart_set *set, const pack_grid *grid,
                             unsigned tactic, chart_place *place, bool *fits)
{
    packer p = {.env = env, .set = set, .grid = grid, .tactic = tactic % PACK_TACTICS};
    size_t cells = (size_t)grid->side * grid->side;
    parian_result result = PARIAN_OK;
    size_entry *order = sort_charts(env, set, TACTICS[p.tactic].length);
    *fits = true;
    if (!order || !PARIAN_NEW(env, p.mask, cells) || !PARIAN_NEW0(env, p.blocked, cells) ||
        !PARIAN_NEW(env, p.next_blocked, cells) || !PARIAN_NEW(env, p.next_free, cells)) {
        result = PARIAN_E_NOMEM;
    }
    for (uint32_t y = 0; y < grid->side && result == PARIAN_OK; y++) {
        renew_row(&p, y);
    }
    for (uint32_t i = 0; i < set->chart_count && result == PARIAN_OK && *fits; i++) {
        uint32_t chart = order[i].chart;
        if (set->extent[chart][0] > 0.0 && set->extent[chart][1] > 0.0) {
            result = place_chart(&p, chart, &place[chart], fits);
        }
    }
    if (result != PARIAN_OK) {
        parian_fail(env, result, "no memory for packing into %u x %u cells", grid->side,
                    grid->side);
    }
    parian_free(env, p.scratch);
    parian_free(env, p.next_free);
    parian_free(env, p.next_blocked);
    parian_free(env, p.blocked);
    parian_free(env, p.mask);
    parian_free(env, order);
    return result;
}
