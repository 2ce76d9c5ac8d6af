/* body_check.c - checks every value of a body against the schema, so that nothing after it needs
 * to.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "core/array_check.h"
#include "core/body_schema.h"
#include "core/memory.h"

/* Positions beyond this are not of an object in metres, and their squares would leave float. */
#define POSITION_MAX_M        1e9f
#define COEFFICIENT_MAX_PER_M 1e15

enum { ATLAS_SIZE_MAX = 16384, ATLAS_FREE = 1 << 20, ATLAS_PER_TEXEL = 1024 };

typedef struct check {
    const parian_env *env;
    const parian_body *body;
    const char *where;
} check;

static parian_result fail(const check *c, int rule, const char *what, size_t index)
{
    return parian_fail(c->env, PARIAN_E_FORMAT, "%s: rule %d: %s (element %zu)", c->where, rule,
                       what, index);
}

static parian_result fail_setting(const parian_env *env, const char *where, int rule,
                                  const char *what, double found)
{
    return parian_fail(env, PARIAN_E_FORMAT, "%s: rule %d: %s, found %g", where, rule, what, found);
}

/* ---- settings and medium ------------------------------------------------------------------------
 */

static parian_result check_medium(const parian_env *env, const parian_medium *medium,
                                  const char *where)
{
    double scattering = 0;
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        double sigma_s = medium->sigma_s_prime[c], sigma_a = medium->sigma_a[c], g = medium->g[c];
        if (!(sigma_s >= 0 && sigma_s <= COEFFICIENT_MAX_PER_M)) {
            return fail_setting(env, where, RULE_MEDIUM,
                                "medium.sigma_s_prime is 0 to 1e15 per metre", sigma_s);
        }
        if (!(sigma_a >= 0 && sigma_a <= COEFFICIENT_MAX_PER_M)) {
            return fail_setting(env, where, RULE_MEDIUM, "medium.sigma_a is 0 to 1e15 per metre",
                                sigma_a);
        }
        if (!(g > -1 && g < 1)) {
            return fail_setting(env, where, RULE_MEDIUM, "medium.g is above -1 and below 1", g);
        }
        scattering += sigma_s;
    }
    if (!(scattering > 0)) {
        return fail_setting(env, where, RULE_MEDIUM,
                            "medium.sigma_s_prime scatters in some channel", scattering);
    }
    if (!(medium->eta >= 1 && medium->eta <= 4)) {
        return fail_setting(env, where, RULE_MEDIUM, "medium.eta is 1 to 4", medium->eta);
    }
    return PARIAN_OK;
}

static parian_result check_atlas_size(const parian_env *env, const parian_body *body,
                                      const char *where)
{
    uint64_t area = (uint64_t)body->atlas_size * body->atlas_size;
    if (body->atlas_size < 1 || body->atlas_size > ATLAS_SIZE_MAX) {
        return fail_setting(env, where, RULE_ATLAS_SIZE, "an atlas has 1 to 16384 texels a side",
                            body->atlas_size);
    }
    if (area > ATLAS_FREE + (uint64_t)ATLAS_PER_TEXEL * body->texel_count) {
        return fail_setting(
            env, where, RULE_ATLAS_SIZE,
            "an atlas has at most 2^20 texels and 1024 for each one that owns surface",
            (double)area);
    }
    if ((uint64_t)body->texel_count + body->gutter_count > area ||
        body->border_count > body->texel_count) {
        return fail_setting(env, where, RULE_ATLAS_SIZE,
                            "texels and gutter fit into the atlas, border texels are texels",
                            body->texel_count);
    }
    return PARIAN_OK;
}

static parian_result check_forms(const parian_env *env, const parian_body *body, const char *where)
{
    uint32_t width = body->kernel_width;
    if ((unsigned)body->bssrdf > PARIAN_BSSRDF_DIPOLE_FLUX) {
        return fail_setting(env, where, RULE_SETTING, "the BSSRDF is 0 or 1", body->bssrdf);
    }
    if ((unsigned)body->local_form > PARIAN_LOCAL_ONLY) {
        return fail_setting(env, where, RULE_SETTING, "the local form is 0 to 5", body->local_form);
    }
    if (body->operator_count > PARIAN_MAX_OPERATORS ||
        body->has_global != (body->operator_count > 0)) {
        return fail_setting(env, where, RULE_SETTING,
                            "a body has up to 16 operators, and a global part if any",
                            body->operator_count);
    }
    if (body->local_form == PARIAN_LOCAL_ONLY && body->has_global) {
        return fail_setting(env, where, RULE_SETTING, "the local form ONLY goes without operators",
                            body->operator_count);
    }
    bool absent = width == 0 && body->local_form == PARIAN_LOCAL_NONE && body->border_count == 0;
    if (!absent && (width < 3 || width > 15 || width % 2 == 0)) {
        return fail_setting(env, where, RULE_KERNEL_WIDTH, "a kernel's width is odd, 3 to 15",
                            width);
    }
    return PARIAN_OK;
}

parian_result parian_body_check_settings(const parian_env *env, const parian_body *body,
                                         const char *where)
{
    parian_result result = check_atlas_size(env, body, where);
    if (result == PARIAN_OK) {
        result = check_forms(env, body, where);
    }
    return result;
}

/* ---- transfer surface ---------------------------------------------------------------------------
 */

static size_t find_long_normal(const void *context, size_t begin, size_t end)
{
    const float(*normal)[3] = context;
    for (size_t i = begin; i < end; i++) {
        const float *n = normal[i];
        float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        if (!(square > 0.98f && square < 1.02f)) {
            return i;
        }
    }
    return PARIAN_ALL_GOOD;
}

static parian_result check_surface(const check *c)
{
    const parian_body *body = c->body;
    const parian_env *env = c->env;
    size_t corners = (size_t)body->triangle_count * 3;
    size_t bad = parian_find_outside(env, body->vertex_position, (size_t)body->vertex_count * 3,
                                     -POSITION_MAX_M, POSITION_MAX_M);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_FINITE, "vertex.position is finite and within 1e9 m", bad);
    }
    bad = parian_find_index(env, body->triangle, corners, body->vertex_count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_INDEX, "triangle.vertex is below the number of vertices", bad);
    }
    bad = parian_find_index(env, body->triangle_chart, body->triangle_count, body->chart_count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_INDEX, "triangle.chart is below the number of charts", bad);
    }
    bad = parian_find_bad(env, corners, find_long_normal, body->corner_normal);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_NORMAL, "corner.normal is of unit length", bad);
    }
    bad = parian_find_outside(env, body->corner_uv, corners * 2, 0, (float)body->atlas_size);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_UV, "corner.uv lies in the atlas", bad);
    }
    return PARIAN_OK;
}

/* ---- texels -------------------------------------------------------------------------------------
 */

static size_t find_barycentric(const void *context, size_t begin, size_t end)
{
    const float(*beta)[2] = context;
    for (size_t i = begin; i < end; i++) {
        if (!(beta[i][0] >= 0 && beta[i][1] >= 0 && beta[i][0] + beta[i][1] <= 1.00001f)) {
            return i;
        }
    }
    return PARIAN_ALL_GOOD;
}

static size_t find_area(const void *context, size_t begin, size_t end)
{
    const float *area = context;
    for (size_t i = begin; i < end; i++) {
        if (!(area[i] > 0 && area[i] <= POSITION_MAX_M)) {
            return i;
        }
    }
    return PARIAN_ALL_GOOD;
}

static parian_result check_texel_places(const check *c)
{
    const parian_body *body = c->body;
    uint32_t area = body->atlas_size * body->atlas_size;
    size_t bad = parian_find_descent(c->env, body->texel_index, body->texel_count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_ASCENDING, "texel.index ascends", bad);
    }
    bad = parian_find_index(c->env, body->texel_index, body->texel_count, area);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_INDEX, "texel.index lies in the atlas", bad);
    }
    bad = parian_find_index(c->env, body->texel_triangle, body->texel_count, body->triangle_count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_INDEX, "texel.triangle is below the number of triangles", bad);
    }
    return PARIAN_OK;
}

static parian_result check_texel_values(const check *c)
{
    const parian_body *body = c->body;
    size_t count = body->texel_count;
    size_t bad = parian_find_bad(c->env, count, find_barycentric, body->texel_barycentric);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_BARYCENTRIC,
                    "texel.barycentric is a pair of numbers from 0 with a sum up to 1", bad);
    }
    bad = parian_find_bad(c->env, count, find_area, body->texel_area);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_AREA, "texel.area is above zero", bad);
    }
    if (body->texel_normal_map) {
        bad = parian_find_bad(c->env, count, find_long_normal, body->texel_normal_map);
        if (bad != PARIAN_ALL_GOOD) {
            return fail(c, RULE_NORMAL, "texel.normal_map is of unit length", bad);
        }
    }
    if (body->texel_albedo) {
        bad = parian_find_outside(c->env, body->texel_albedo, count * 3, 0, 1);
        if (bad != PARIAN_ALL_GOOD) {
            return fail(c, RULE_ALBEDO, "texel.albedo is 0 to 1", bad);
        }
    }
    return PARIAN_OK;
}

/* ---- gutter -------------------------------------------------------------------------------------
 */

static size_t find_gutter_weight(const void *context, size_t begin, size_t end)
{
    const float(*weight)[PARIAN_GUTTER_SOURCES] = context;
    for (size_t i = begin; i < end; i++) {
        float sum = 0;
        bool good = true;
        for (int k = 0; k < PARIAN_GUTTER_SOURCES; k++) {
            good = good && weight[i][k] >= 0;
            sum += weight[i][k];
        }
        if (!good || !(fabsf(sum - 1) < 1e-3f)) {
            return i;
        }
    }
    return PARIAN_ALL_GOOD;
}

static parian_result check_gutter(const check *c, const parian_bits *owned)
{
    const parian_body *body = c->body;
    size_t count = body->gutter_count;
    size_t bad = parian_find_descent(c->env, body->gutter_index, count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_ASCENDING, "gutter.index ascends", bad);
    }
    bad = parian_find_index(c->env, body->gutter_index, count, body->atlas_size * body->atlas_size);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_INDEX, "gutter.index lies in the atlas", bad);
    }
    for (size_t i = 0; i < count; i++) {
        if (parian_bits_get(owned, body->gutter_index[i])) {
            return fail(c, RULE_GUTTER_OWNED, "gutter.index is not a texel that owns surface", i);
        }
    }
    bad = parian_find_index(c->env, body->gutter_source, count * PARIAN_GUTTER_SOURCES,
                            body->texel_count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_INDEX, "gutter.source is below the number of texels", bad);
    }
    bad = parian_find_bad(c->env, count, find_gutter_weight, body->gutter_weight);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_GUTTER_WEIGHT, "gutter.weight is not negative and its four sum to 1",
                    bad);
    }
    return PARIAN_OK;
}

/* ---- border lists and windows -------------------------------------------------------------------
 */

static size_t find_border_list(const void *context, size_t begin, size_t end)
{
    const parian_body *body = context;
    for (size_t i = begin; i < end; i++) {
        const uint32_t *list = body->border_neighbour + body->border_offset[i];
        size_t count = body->border_offset[i + 1] - body->border_offset[i];
        bool self = false;
        for (size_t k = 0; k < count; k++) {
            if (list[k] >= body->texel_count || (k > 0 && list[k] <= list[k - 1])) {
                return i;
            }
            self |= list[k] == body->border_texel[i];
        }
        if (!self) {
            return i;
        }
    }
    return PARIAN_ALL_GOOD;
}

static parian_result check_border(const check *c)
{
    const parian_body *body = c->body;
    size_t bad = parian_find_descent(c->env, body->border_texel, body->border_count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_ASCENDING, "border.texel ascends", bad);
    }
    bad = parian_find_index(c->env, body->border_texel, body->border_count, body->texel_count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_INDEX, "border.texel is below the number of texels", bad);
    }
    bad = parian_find_bad(c->env, body->border_count, find_border_list, body);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_BORDER_SELF,
                    "a list of border.neighbour ascends, names texels, and among them its own",
                    bad);
    }
    return PARIAN_OK;
}

typedef struct window_check {
    const parian_body *body;
    const parian_bits *owned;  /* [atlas_size^2] */
    const parian_bits *border; /* [texel_count] */
} window_check;

static size_t find_window(const void *context, size_t begin, size_t end)
{
    const window_check *w = context;
    uint32_t side = w->body->atlas_size, width = w->body->kernel_width, half = width / 2;
    for (size_t i = begin; i < end; i++) {
        uint32_t u = w->body->texel_index[i] % side, v = w->body->texel_index[i] / side;
        if (parian_bits_get(w->border, i)) {
            continue;
        }
        if (u < half || v < half || u + half >= side || v + half >= side) {
            return i;
        }
        for (uint32_t row = v - half; row <= v + half; row++) {
            if (!parian_bits_all(w->owned, (size_t)row * side + u - half, width)) {
                return i;
            }
        }
    }
    return PARIAN_ALL_GOOD;
}

static parian_result check_windows(const check *c, const parian_bits *owned)
{
    const parian_body *body = c->body;
    parian_bits border;
    if (body->local_form == PARIAN_LOCAL_NONE) {
        return PARIAN_OK;
    }
    parian_result result = parian_bits_create(c->env, body->texel_count, &border);
    if (result != PARIAN_OK) {
        return result;
    }
    for (uint32_t i = 0; i < body->border_count; i++) {
        parian_bits_set(&border, body->border_texel[i]);
    }
    window_check work = {body, owned, &border};
    size_t bad = parian_find_bad(c->env, body->texel_count, find_window, &work);
    parian_bits_free(c->env, &border);
    return bad == PARIAN_ALL_GOOD
               ? PARIAN_OK
               : fail(c, RULE_WINDOW,
                      "the window of a texel that is no border texel lies on owned texels", bad);
}

static parian_result check_neighbourhoods(const check *c)
{
    const parian_body *body = c->body;
    parian_bits owned;
    parian_result result =
        parian_bits_create(c->env, (size_t)body->atlas_size * body->atlas_size, &owned);
    if (result != PARIAN_OK) {
        return result;
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        parian_bits_set(&owned, body->texel_index[i]);
    }
    result = check_gutter(c, &owned);
    if (result == PARIAN_OK) {
        result = check_border(c);
    }
    if (result == PARIAN_OK) {
        result = check_windows(c, &owned);
    }
    parian_bits_free(c->env, &owned);
    return result;
}

/* ---- local part ---------------------------------------------------------------------------------
 */

static parian_result check_local(const check *c)
{
    const parian_body *body = c->body;
    size_t entries = body->border_offset[body->border_count];
    size_t taps =
        (size_t)(body->texel_count - body->border_count) * body->kernel_width * body->kernel_width;
    size_t bad = PARIAN_ALL_GOOD;
    if (body->local_form == PARIAN_LOCAL_SPLIT &&
        !(body->split_radius_m > 0 && body->split_radius_m <= POSITION_MAX_M)) {
        return fail_setting(c->env, c->where, RULE_SPLIT_RADIUS, "local.split_radius is above zero",
                            body->split_radius_m);
    }
    if (body->blend_weight) {
        bad = parian_find_infinite_half(c->env, body->blend_weight, (size_t)body->texel_count * 9);
        if (bad != PARIAN_ALL_GOOD) {
            return fail(c, RULE_FINITE, "blend.weight is finite", bad);
        }
    }
    if (body->local_form == PARIAN_LOCAL_F16) {
        bad = parian_find_outside(c->env, body->kernel_channel_scale, 3, 0, 1e30f);
        if (bad != PARIAN_ALL_GOOD) {
            return fail(c, RULE_KERNEL_SCALE, "local.channel_scale is 0 to 1e30", bad);
        }
        bad = parian_find_infinite_half(c->env, body->kernel_f16, taps * 3);
        if (bad == PARIAN_ALL_GOOD) {
            bad = parian_find_infinite_half(c->env, body->border_f16, entries * 3);
        }
    }
    if (bad != PARIAN_ALL_GOOD) {
        return fail(c, RULE_FINITE, "local.kernel_f16 and local.border_f16 are finite", bad);
    }
    if (body->local_form == PARIAN_LOCAL_U8) {
        bad = parian_find_outside(c->env, body->kernel_scale, (size_t)body->texel_count * 3, 0,
                                  1e30f);
    }
    return bad == PARIAN_ALL_GOOD
               ? PARIAN_OK
               : fail(c, RULE_KERNEL_SCALE, "local.kernel_scale is 0 to 1e30", bad);
}

/* ---- all of it ----------------------------------------------------------------------------------
 */

static parian_result check_offsets(const check *c)
{
    const parian_body *body = c->body;
    for (uint32_t i = 0; i <= body->border_count; i++) {
        if (body->border_offset[i] < (i ? body->border_offset[i - 1] : 0) ||
            (i == 0 && body->border_offset[0] != 0)) {
            return fail(c, RULE_OFFSETS, "border.offset begins at 0 and never descends", i);
        }
    }
    return PARIAN_OK;
}

parian_result parian_body_check(const parian_env *env, const parian_body *body, const char *where)
{
    check c = {env, body, where};
    parian_result (*const steps[])(const check *) = {check_offsets,        check_surface,
                                                     check_texel_places,   check_texel_values,
                                                     check_neighbourhoods, check_local};
    parian_result result = parian_body_check_settings(env, body, where);
    if (result == PARIAN_OK) {
        result = check_medium(env, &body->medium, where);
    }
    for (size_t i = 0; i < sizeof steps / sizeof *steps && result == PARIAN_OK; i++) {
        result = steps[i](&c);
    }
    if (result == PARIAN_OK) {
        result = parian_operators_check(env, body, where);
    }
    return result;
}

parian_result parian_surrounding_check(const parian_env *env, const parian_surrounding *surrounding,
                                       const char *where)
{
    check c = {env, NULL, where};
    size_t corners = (size_t)surrounding->triangle_count * 3;
    size_t bad =
        parian_find_outside(env, surrounding->vertex_position,
                            (size_t)surrounding->vertex_count * 3, -POSITION_MAX_M, POSITION_MAX_M);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(&c, RULE_FINITE, "surrounding.position is finite and within 1e9 m", bad);
    }
    bad = parian_find_index(env, surrounding->triangle, corners, surrounding->vertex_count);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(&c, RULE_INDEX, "surrounding.triangle is below the number of vertices", bad);
    }
    bad = parian_find_outside(env, surrounding->corner_normal, corners * 3, -1.01f, 1.01f);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(&c, RULE_NORMAL, "surrounding.corner_normal is finite and of unit length", bad);
    }
    bad = parian_find_outside(env, surrounding->reflectance, 3, 0, 1);
    return bad == PARIAN_ALL_GOOD ? PARIAN_OK
                                  : fail(&c, RULE_ALBEDO, "surrounding.reflectance is 0 to 1", bad);
}
