/* select_bodies.c - which parts of a scene are bodies, and which medium each is made of.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>
#include <strings.h>

#include "bake/pipeline/bake.h"
#include "bake/stages/media.h"
#include "core/memory.h"
#include "tool/media_file.h"

/* One --material argument: mesh is empty where it holds for every body. */
typedef struct material_choice {
    char mesh[PARIAN_NAME_MAX];
    parian_medium medium;
    bool used;
} material_choice;

static bool is_file_name(const char *text)
{
    size_t n = strlen(text);
    return strchr(text, '/') || (n > 5 && strcasecmp(text + n - 5, ".json") == 0);
}

parian_result parian_find_medium(const parian_env *env, const char *text, parian_medium *medium)
{
    if (is_file_name(text)) {
        return parian_media_read_file(env, text, medium);
    }
    const parian_medium *preset = parian_media_find(text);
    if (!preset) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "no material named '%s'; parian-bake --list-materials shows the presets, a file "
            "ends in .json",
            text);
    }
    *medium = *preset;
    return parian_medium_check(env, medium);
}

static parian_result parse_choice(const parian_env *env, const char *text, material_choice *choice)
{
    const char *equals = strchr(text, '=');
    if (equals) {
        size_t n = (size_t)(equals - text);
        if (n == 0 || n >= sizeof choice->mesh) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "--material %s: expected MESHNAME=NAME",
                               text);
        }
        memcpy(choice->mesh, text, n);
        choice->mesh[n] = 0;
        text = equals + 1;
    }
    return parian_find_medium(env, text, &choice->medium);
}

static const parian_source_material *material_of(const parian_source_scene *scene, uint32_t part)
{
    uint32_t m = scene->parts[part].material;
    return m < scene->material_count ? &scene->materials[m] : NULL;
}

static bool choice_names_part(const material_choice *choice, const parian_source_scene *scene,
                              uint32_t part)
{
    const parian_source_part *p = &scene->parts[part];
    const parian_source_material *material = material_of(scene, part);
    return choice->mesh[0] &&
           (strcmp(choice->mesh, p->mesh_name) == 0 || strcmp(choice->mesh, p->name) == 0 ||
            (material && strcmp(choice->mesh, material->name) == 0));
}

static material_choice *choice_for_part(material_choice *choices, size_t count,
                                        const parian_source_scene *scene, uint32_t part)
{
    for (size_t i = 0; i < count; i++) {
        if (choice_names_part(&choices[i], scene, part)) {
            choices[i].used = true;
            return &choices[i];
        }
    }
    return NULL;
}

static material_choice *choice_for_all(material_choice *choices, size_t count)
{
    for (size_t i = count; i-- > 0;) {
        if (!choices[i].mesh[0]) {
            return &choices[i];
        }
    }
    return NULL;
}

/* Bodies are the parts named by --material and those whose material scatters; where there are none,
 * those with a volume; where there are none either, all. */
static void mark_bodies(const parian_source_scene *scene, material_choice *choices, size_t count,
                        bool *is_body)
{
    bool any = false;
    for (uint32_t p = 0; p < scene->part_count; p++) {
        const parian_source_material *material = material_of(scene, p);
        is_body[p] =
            choice_for_part(choices, count, scene, p) || (material && material->has_scatter);
        any = any || is_body[p];
    }
    for (uint32_t p = 0; !any && p < scene->part_count; p++) {
        const parian_source_material *material = material_of(scene, p);
        is_body[p] = material && material->has_volume;
    }
    for (uint32_t p = 0; p < scene->part_count; p++) {
        any = any || is_body[p];
    }
    for (uint32_t p = 0; !any && p < scene->part_count; p++) {
        is_body[p] = true;
    }
}

static parian_result medium_of_part(const parian_env *env, const parian_source_scene *scene,
                                    uint32_t part, material_choice *choices, size_t count,
                                    parian_medium *medium)
{
    material_choice *choice = choice_for_part(choices, count, scene, part);
    const parian_source_material *material = material_of(scene, part);
    if (!choice) {
        choice = choice_for_all(choices, count);
    }
    if (choice) {
        *medium = choice->medium;
        return PARIAN_OK;
    }
    if (material && material->has_scatter) {
        return parian_media_from_material(env, material, medium);
    }
    parian_log(env, PARIAN_LOG_WARNING,
               "'%s' has no scattering medium of its own and no --material: taken as marble",
               scene->parts[part].name);
    return parian_find_medium(env, "marble", medium);
}

static parian_result check_choices_used(const parian_env *env, const material_choice *choices,
                                        size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (choices[i].mesh[0] && !choices[i].used) {
            return parian_fail(
                env, PARIAN_E_ARGUMENT,
                "--material %s=...: the input has no mesh, node or material of that name",
                choices[i].mesh);
        }
    }
    return PARIAN_OK;
}

void parian_selection_free(const parian_env *env, parian_selection *selection)
{
    parian_free(env, selection->is_body);
    parian_free(env, selection->medium);
    *selection = (parian_selection){0};
}

static parian_result fill_selection(const parian_env *env, const parian_source_scene *scene,
                                    material_choice *choices, size_t count,
                                    parian_selection *selection)
{
    mark_bodies(scene, choices, count, selection->is_body);
    parian_result r = check_choices_used(env, choices, count);
    for (uint32_t p = 0; r == PARIAN_OK && p < scene->part_count; p++) {
        if (selection->is_body[p]) {
            selection->body_count++;
            r = medium_of_part(env, scene, p, choices, count, &selection->medium[p]);
        }
    }
    return r;
}

parian_result parian_select_bodies(const parian_env *env, const parian_bake_desc *desc,
                                   const parian_source_scene *scene, parian_selection *selection)
{
    material_choice *choices = NULL;
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW0(env, choices, desc->material_count) ||
        !PARIAN_NEW0(env, selection->is_body, scene->part_count) ||
        !PARIAN_NEW0(env, selection->medium, scene->part_count)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %u parts", scene->part_count);
    }
    for (size_t i = 0; r == PARIAN_OK && i < desc->material_count; i++) {
        r = parse_choice(env, desc->material[i], &choices[i]);
    }
    if (r == PARIAN_OK) {
        r = fill_selection(env, scene, choices, desc->material_count, selection);
    }
    parian_free(env, choices);
    return r;
}
