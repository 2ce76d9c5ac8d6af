/* medium.c - refuses media that cannot be.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/medium.h"

#include <math.h>

#include "core/memory.h"

static const char channel_name[PARIAN_CHANNELS] = {'r', 'g', 'b'};
static const double g_cap = 0.995;

static parian_result check_channel(const parian_env *env, parian_medium *medium, int c)
{
    double s = medium->sigma_s_prime[c], a = medium->sigma_a[c], g = medium->g[c];
    if (!(s >= 0) || !isfinite(s) || !(a >= 0) || !isfinite(a)) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "medium '%s': sigma_%s %c is %g per m, expected a finite number >= 0",
                           medium->name, s >= 0 && isfinite(s) ? "a" : "s_prime", channel_name[c],
                           s >= 0 && isfinite(s) ? a : s);
    }
    if (!(fabs(g) < 1)) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "medium '%s': g %c is %g, expected -1 to 1, both excluded", medium->name,
                           channel_name[c], g);
    }
    if (s + a == 0) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "medium '%s': channel %c neither scatters nor absorbs, expected one of them",
            medium->name, channel_name[c]);
    }
    if (fabs(g) > g_cap) {
        parian_log(env, PARIAN_LOG_WARNING, "medium '%s': g %c of %g is capped at %g", medium->name,
                   channel_name[c], g, copysign(g_cap, g));
        medium->g[c] = copysign(g_cap, g);
    }
    return PARIAN_OK;
}

parian_result parian_medium_check(const parian_env *env, parian_medium *medium)
{
    double scattering = 0;
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        parian_result result = check_channel(env, medium, c);
        if (result != PARIAN_OK) {
            return result;
        }
        scattering += medium->sigma_s_prime[c];
    }
    if (scattering == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "medium '%s' scatters in no channel: it is no translucent medium",
                           medium->name);
    }
    if (!(medium->eta >= 1 && medium->eta <= 4)) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "medium '%s': eta is %g, expected 1 to 4",
                           medium->name, medium->eta);
    }
    return PARIAN_OK;
}
