/* chart_labels.c - places labels beside points so that they cover neither each other nor what is
 * drawn.
 *
 * Greedy: each label takes the cheapest of 8 directions at some distances, given the labels before
 * it.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/chart_labels.h"

#include <math.h>

static const double DOT_RADIUS = 6, NEAREST = 9, FURTHER = 11, LINE_STEP = 5;
enum { RINGS = 6, DIRECTIONS = 8, SEGMENT_STEPS_MAX = 200 };

/* Costs: of a covered label or taken box, dot, piece of a line; of each ring outwards. */
static const double COST_COVERED = 1e6, COST_DOT = 200, COST_LINE = 25, COST_RING = 30;

static bool overlap(const parian_chart_box *a, const parian_chart_box *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

static bool holds(const parian_chart_box *box, double x, double y, double margin)
{
    return x > box->x0 - margin && x < box->x1 + margin && y > box->y0 - margin &&
           y < box->y1 + margin;
}

/* Number of places along the line from a to b that lie in the box. */
static int line_hits(const parian_chart_box *box, const parian_chart_dot *a,
                     const parian_chart_dot *b)
{
    double length = hypot(b->x - a->x, b->y - a->y);
    int steps = (int)fmin(ceil(length / LINE_STEP), SEGMENT_STEPS_MAX), hits = 0;
    parian_chart_box around = {fmin(a->x, b->x) - 2, fmin(a->y, b->y) - 2, fmax(a->x, b->x) + 2,
                               fmax(a->y, b->y) + 2};
    for (int i = 1; overlap(box, &around) && i < steps; i++) {
        double t = (double)i / steps;
        hits += holds(box, a->x + t * (b->x - a->x), a->y + t * (b->y - a->y), 1);
    }
    return hits;
}

static double drawing_cost(const parian_chart_box *box, const parian_chart_dot *dots,
                           size_t dot_count)
{
    double cost = 0;
    for (size_t i = 0; i < dot_count; i++) {
        cost += COST_DOT * holds(box, dots[i].x, dots[i].y, DOT_RADIUS);
        cost += i > 0 && dots[i].joined ? COST_LINE * line_hits(box, &dots[i - 1], &dots[i]) : 0;
    }
    return cost;
}

bool parian_chart_box_is_free(const parian_chart_box *box, const parian_chart_dot *dots,
                              size_t dot_count)
{
    return drawing_cost(box, dots, dot_count) == 0;
}

/* The box of a label in a direction (0: right, then the others in order of liking) and ring. */
static parian_chart_box candidate(const parian_chart_dot *dot, const parian_chart_label *label,
                                  int direction, int ring)
{
    static const int side[DIRECTIONS][2] = {{1, 0},  {1, 1},  {1, -1}, {0, 1},
                                            {0, -1}, {-1, 0}, {-1, 1}, {-1, -1}};
    double distance = NEAREST + FURTHER * ring, dx = side[direction][0], dy = side[direction][1];
    double reach = dx != 0 && dy != 0 ? 0.75 * distance : distance;
    double x = dot->x + dx * reach - (dx > 0 ? 0 : dx < 0 ? label->width : 0.5 * label->width);
    double y = dot->y + dy * (reach + 0.5 * label->height) - 0.5 * label->height;
    return (parian_chart_box){x, y, x + label->width, y + label->height};
}

static double covering_cost(const parian_chart_box *box, const parian_chart_box *frame,
                            const parian_chart_box *taken, size_t taken_count,
                            const parian_chart_label *labels, size_t label_count)
{
    bool inside = box->x0 >= frame->x0 && box->x1 <= frame->x1 && box->y0 >= frame->y0 &&
                  box->y1 <= frame->y1;
    double cost = inside ? 0 : COST_COVERED;
    for (size_t i = 0; i < taken_count; i++) {
        cost += COST_COVERED * overlap(box, &taken[i]);
    }
    for (size_t i = 0; i < label_count; i++) {
        const parian_chart_label *l = &labels[i];
        parian_chart_box other = {l->x - 3, l->y - 0.5 * l->height, l->x + l->width + 3,
                                  l->y + 0.5 * l->height};
        cost += COST_COVERED * (l->shown && overlap(box, &other));
    }
    return cost;
}

void parian_chart_labels_place(const parian_chart_box *frame, const parian_chart_dot *dots,
                               size_t dot_count, const parian_chart_box *taken, size_t taken_count,
                               parian_chart_label *labels, size_t label_count)
{
    for (size_t n = 0; n < label_count; n++) {
        parian_chart_label *label = &labels[n];
        double best = COST_COVERED;
        label->shown = false;
        for (int k = 0; k < RINGS * DIRECTIONS; k++) {
            parian_chart_box box =
                candidate(&dots[label->dot], label, k % DIRECTIONS, k / DIRECTIONS);
            double cost = COST_RING * (k / DIRECTIONS) + k % DIRECTIONS;
            cost += covering_cost(&box, frame, taken, taken_count, labels, n);
            cost += cost < best ? drawing_cost(&box, dots, dot_count) : 0;
            if (cost < best) {
                best = cost;
                label->x = box.x0;
                label->y = 0.5 * (box.y0 + box.y1);
                label->shown = true;
                label->led = k / DIRECTIONS >= 1;
            }
        }
    }
}
