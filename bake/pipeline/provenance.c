/* provenance.c - what an asset says about its making: tool, settings, input hash; no paths, no
 * times.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "bake/pipeline/bake.h"
#include "core/memory.h"
#include "tool/files.h"

static const char *const LOCAL_FORM_NAMES[] = {"none", "rebuilt", "f16", "u8", "split", "only"};

static const char *const HIERARCHY_NAMES[] = {"auto", "on", "off"};

static void add_settings(cJSON *object, const parian_bake_desc *desc)
{
    cJSON *materials = cJSON_AddArrayToObject(object, "material");
    for (size_t i = 0; i < desc->material_count; i++) {
        const char *slash = strrchr(desc->material[i], '/');
        cJSON_AddItemToArray(materials, cJSON_CreateString(slash ? slash + 1 : desc->material[i]));
    }
    cJSON_AddNumberToObject(object, "scale_m", desc->scale_m);
    cJSON_AddNumberToObject(object, "unit_m", desc->unit_m);
    cJSON_AddBoolToObject(object, "keep_origin", desc->keep_origin);
    cJSON_AddStringToObject(object, "bssrdf",
                            desc->bssrdf == PARIAN_BSSRDF_DIPOLE ? "dipole" : "dipole-flux");
    cJSON_AddStringToObject(object, "fdr", desc->fit_fdr ? "fit" : "exact");
    cJSON_AddStringToObject(object, "form", desc->form == PARIAN_FORM_PAPER ? "paper" : "parian");
    cJSON_AddNumberToObject(object, "atlas", desc->atlas_size);
    cJSON_AddNumberToObject(object, "kernel", desc->kernel_width);
    cJSON_AddStringToObject(object, "local", LOCAL_FORM_NAMES[desc->local_form]);
    cJSON_AddNumberToObject(object, "transfer_vertices", desc->transfer_vertices);
    cJSON_AddNumberToObject(object, "threshold", desc->threshold > 0 ? desc->threshold : 0);
    cJSON_AddNumberToObject(object, "threshold_absolute", desc->threshold_absolute);
    cJSON_AddStringToObject(object, "hierarchy", HIERARCHY_NAMES[desc->hierarchy]);
    cJSON_AddBoolToObject(object, "force_local", desc->force_local);
    cJSON_AddBoolToObject(object, "force_global", desc->force_global);
    cJSON_AddBoolToObject(object, "no_local", desc->no_local);
    cJSON_AddBoolToObject(object, "no_global", desc->no_global);
}

char *parian_settings_json(const parian_bake_desc *desc)
{
    cJSON *root = cJSON_CreateObject();
    if (root) {
        add_settings(root, desc);
    }
    char *text = root ? cJSON_Print(root) : NULL;
    cJSON_Delete(root);
    return text;
}

static char *print_provenance(const parian_bake_desc *desc, uint64_t hash)
{
    char hex[17];
    cJSON *root = cJSON_CreateObject();
    if (!root) {
        return NULL;
    }
    snprintf(hex, sizeof hex, "%016" PRIx64, hash);
    cJSON_AddStringToObject(root, "tool", "parian-bake " PARIAN_VERSION);
    cJSON_AddStringToObject(root, "input_xxh3_64", hex);
    cJSON *settings = cJSON_AddObjectToObject(root, "settings");
    if (settings) {
        add_settings(settings, desc);
    }
    char *text = cJSON_PrintUnformatted(root);
    cJSON_Delete(root);
    return text;
}

parian_result parian_make_provenance(const parian_env *env, const parian_bake_desc *desc,
                                     char **json)
{
    uint64_t hash = 0;
    parian_result r = parian_file_hash(env, desc->input, &hash);
    if (r != PARIAN_OK) {
        return r;
    }
    char *text = print_provenance(desc, hash);
    size_t size = text ? strlen(text) + 1 : 0;
    char *copy = text ? parian_alloc(env, size, 1) : NULL;
    if (copy) {
        memcpy(copy, text, size);
        *json = copy;
    }
    cJSON_free(text);
    return copy ? PARIAN_OK : parian_fail(env, PARIAN_E_NOMEM, "no memory for the provenance");
}
