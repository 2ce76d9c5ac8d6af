/* path_pilot.h - for each light a short run of walks and of photons, to keep the cheaper kind.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PATH_PILOT_H
#define PARIAN_BAKE_PATH_PILOT_H

#include "bake/reference/path_parts.h"

/* Set the meeting of each light to PATH_BY_FORWARD where photons reach a variance for less work
 * than walks do, by `walks` walks per receiver and channel from at most 128 receivers and by as
 * many photons as a round has. Work is counted in events, so that the choice does not depend on the
 * clock. Needs path->patches. Errors: PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED. */
parian_result parian_path_choose_meetings(path_scene *path, uint32_t walks);

#endif
