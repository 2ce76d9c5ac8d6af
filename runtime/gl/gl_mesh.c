/* gl_mesh.c - meshes for shadows and shading, a vertex for each corner.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "gl/gl_body.h"
#include "shade/chart_color.h"

typedef struct mesh_corner {
    float position[3], normal[3], uv[2], chart[3];
} mesh_corner;

static void unroll_body(const parian_body *body, mesh_corner *corner)
{
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        for (int k = 0; k < 3; k++, corner++) {
            memcpy(corner->position, body->vertex_position[body->triangle[t][k]],
                   sizeof corner->position);
            memcpy(corner->normal, body->corner_normal[t][k], sizeof corner->normal);
            memcpy(corner->uv, body->corner_uv[t][k], sizeof corner->uv);
            parian_chart_color(body->triangle_chart[t], corner->chart);
        }
    }
}

static void unroll_surrounding(const parian_surrounding *piece, mesh_corner *corner)
{
    memset(corner, 0, (size_t)3 * piece->triangle_count * sizeof *corner);
    for (uint32_t t = 0; t < piece->triangle_count; t++) {
        for (int k = 0; k < 3; k++, corner++) {
            memcpy(corner->position, piece->vertex_position[piece->triangle[t][k]],
                   sizeof corner->position);
            memcpy(corner->normal, piece->corner_normal[t][k], sizeof corner->normal);
        }
    }
}

static void describe(gl_device *device)
{
    static const struct {
        GLint components;
        size_t offset;
    } attributes[4] = {{3, offsetof(mesh_corner, position)},
                       {3, offsetof(mesh_corner, normal)},
                       {2, offsetof(mesh_corner, uv)},
                       {3, offsetof(mesh_corner, chart)}};
    for (GLuint a = 0; a < 4; a++) {
        device->gl.EnableVertexAttribArray(a);
        device->gl.VertexAttribPointer(a, attributes[a].components, GL_FLOAT, GL_FALSE,
                                       sizeof(mesh_corner), (const void *)attributes[a].offset);
    }
}

parian_result gl_mesh_create(gl_device *device, const parian_body *body,
                             const parian_surrounding *surrounding, gl_mesh *mesh)
{
    uint32_t triangles = body ? body->triangle_count : surrounding->triangle_count;
    uint64_t size = (uint64_t)triangles * 3 * sizeof(mesh_corner);
    mesh_corner *corner;
    parian_result result = gl_memory_add(device, size);
    if (result != PARIAN_OK) {
        return result;
    }
    mesh->size = size;
    mesh->corner_count = 3 * triangles;
    if (!PARIAN_NEW(device->env, corner, mesh->corner_count)) {
        return parian_fail(device->env, PARIAN_E_NOMEM, "no memory for %u triangles", triangles);
    }
    if (body) {
        unroll_body(body, corner);
    } else {
        unroll_surrounding(surrounding, corner);
    }
    device->gl.GenVertexArrays(1, &mesh->vertex_array);
    device->gl.GenBuffers(1, &mesh->buffer);
    device->gl.BindVertexArray(mesh->vertex_array);
    device->gl.BindBuffer(GL_ARRAY_BUFFER, mesh->buffer);
    device->gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)size, corner, GL_STATIC_DRAW);
    describe(device);
    parian_free(device->env, corner);
    return PARIAN_OK;
}

void gl_mesh_destroy(gl_device *device, gl_mesh *mesh)
{
    if (mesh->vertex_array) {
        device->gl.DeleteVertexArrays(1, &mesh->vertex_array);
        device->gl.DeleteBuffers(1, &mesh->buffer);
    }
    device->memory -= mesh->size;
    memset(mesh, 0, sizeof *mesh);
}

void gl_mesh_draw(gl_device *device, const gl_mesh *mesh)
{
    device->gl.BindVertexArray(mesh->vertex_array);
    device->gl.DrawArrays(GL_TRIANGLES, 0, (GLsizei)mesh->corner_count);
}
