/* transfer_mesh_split.c - takes a mesh apart into its connected components, and together again.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>

#include "bake/stages/transfer_mesh_parts.h"
#include "core/disjoint_sets.h"
#include "core/memory.h"

static void join_vertices(const parian_mesh *mesh, uint32_t *parent)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        parent[v] = v;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 1; k < 3; k++) {
            parian_set_join(parent, mesh->triangle[t][0], mesh->triangle[t][k]);
        }
    }
}

/* Number the components by their first triangle; component[v] for every vertex (unreferenced ones
 * keep 0xFFFFFFFF). Returns how many there are. */
static uint32_t number_components(const parian_mesh *mesh, uint32_t *parent, uint32_t *component)
{
    uint32_t count = 0;
    memset(component, 0xFF, mesh->vertex_count * sizeof *component);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t root = parian_set_root(parent, mesh->triangle[t][0]);
        if (component[root] == 0xFFFFFFFFu) {
            component[root] = count++;
        }
        for (int k = 0; k < 3; k++) {
            component[mesh->triangle[t][k]] = component[root];
        }
    }
    return count;
}

static bool allocate_parts(const parian_env *env, const parian_mesh *mesh,
                           const uint32_t *component, transfer_part *parts, uint32_t count)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (component[v] != 0xFFFFFFFFu) {
            parts[component[v]].source.vertex_count++;
        }
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        parts[component[mesh->triangle[t][0]]].source.triangle_count++;
    }
    for (uint32_t p = 0; p < count; p++) {
        parian_mesh *source = &parts[p].source;
        if (!PARIAN_NEW(env, source->position, source->vertex_count) ||
            !PARIAN_NEW(env, source->triangle, source->triangle_count)) {
            return false;
        }
        source->vertex_count = 0;
        source->triangle_count = 0;
    }
    return true;
}

/* local[v]: index of a vertex within its part. */
static void fill_parts(const parian_mesh *mesh, const uint32_t *component, uint32_t *local,
                       transfer_part *parts)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (component[v] == 0xFFFFFFFFu) {
            continue;
        }
        parian_mesh *part = &parts[component[v]].source;
        local[v] = part->vertex_count++;
        memcpy(part->position[local[v]], mesh->position[v], sizeof part->position[0]);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corner = mesh->triangle[t];
        parian_mesh *part = &parts[component[corner[0]]].source;
        uint32_t *out = part->triangle[part->triangle_count++];
        for (int k = 0; k < 3; k++) {
            out[k] = local[corner[k]];
        }
    }
}

parian_result parian_transfer_split(const parian_env *env, const parian_mesh *source,
                                    transfer_part **parts, uint32_t *count)
{
    parian_result result = PARIAN_E_NOMEM;
    uint32_t *parent = NULL, *component = NULL;
    transfer_part *made = NULL;
    uint32_t made_count = 0;
    if (!PARIAN_NEW(env, parent, source->vertex_count) ||
        !PARIAN_NEW(env, component, source->vertex_count)) {
        goto done;
    }
    join_vertices(source, parent);
    made_count = number_components(source, parent, component);
    if (!PARIAN_NEW0(env, made, made_count) ||
        !allocate_parts(env, source, component, made, made_count)) {
        goto done;
    }
    fill_parts(source, component, parent, made); /* the forest is not needed any more */
    for (uint32_t p = 0; p < made_count; p++) {
        made[p].area = parian_mesh_area(&made[p].source);
    }
    *parts = made;
    *count = made_count;
    made = NULL;
    result = PARIAN_OK;
done:
    parian_transfer_parts_free(env, made, made_count);
    parian_free(env, component);
    parian_free(env, parent);
    return result == PARIAN_OK
               ? result
               : parian_fail(env, result, "transfer mesh: out of memory for the components");
}

void parian_transfer_parts_free(const parian_env *env, transfer_part *parts, uint32_t count)
{
    for (uint32_t p = 0; parts && p < count; p++) {
        parian_mesh_free(env, &parts[p].source);
        parian_mesh_free(env, &parts[p].result);
    }
    parian_free(env, parts);
}

parian_result parian_transfer_join(const parian_env *env, const transfer_part *parts,
                                   uint32_t count, parian_mesh *mesh)
{
    parian_mesh made = {0};
    for (uint32_t p = 0; p < count; p++) {
        made.vertex_count += parts[p].result.vertex_count;
        made.triangle_count += parts[p].result.triangle_count;
    }
    if (!PARIAN_NEW(env, made.position, made.vertex_count) ||
        !PARIAN_NEW(env, made.triangle, made.triangle_count)) {
        parian_mesh_free(env, &made);
        return parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for %u vertices",
                           made.vertex_count);
    }
    uint32_t vertex = 0, triangle = 0;
    for (uint32_t p = 0; p < count; p++) {
        const parian_mesh *part = &parts[p].result;
        memcpy(made.position + vertex, part->position, part->vertex_count * sizeof *made.position);
        for (uint32_t t = 0; t < part->triangle_count; t++, triangle++) {
            for (int k = 0; k < 3; k++) {
                made.triangle[triangle][k] = part->triangle[t][k] + vertex;
            }
        }
        vertex += part->vertex_count;
    }
    *mesh = made;
    return PARIAN_OK;
}
