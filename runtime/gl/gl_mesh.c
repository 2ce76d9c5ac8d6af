/* gl_mesh.c - meshes for shadows and shading, a vertex for each corner.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "gl/gl_body.h"
#include "shade/chart_color.h"

typedef struct mesh_corner {
    float position[3], normal[3], uv[2], chart[3];
} mesh_corner;

static void copy_body(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    mesh_corner *corner = to;
    for (uint64_t i = first; i < first + count; i++, corner++) {
        uint64_t t = i / 3, k = i % 3;
        memcpy(corner->position, body->vertex_position[body->triangle[t][k]],
               sizeof corner->position);
        memcpy(corner->normal, body->corner_normal[t][k], sizeof corner->normal);
        memcpy(corner->uv, body->corner_uv[t][k], sizeof corner->uv);
        parian_chart_color(body->triangle_chart[t], corner->chart);
    }
}

static void copy_surrounding(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_surrounding *piece = context;
    mesh_corner *corner = to;
    memset(corner, 0, count * sizeof *corner);
    for (uint64_t i = first; i < first + count; i++, corner++) {
        uint64_t t = i / 3, k = i % 3;
        memcpy(corner->position, piece->vertex_position[piece->triangle[t][k]],
               sizeof corner->position);
        memcpy(corner->normal, piece->corner_normal[t][k], sizeof corner->normal);
    }
}

static void plan(gl_upload_list *list, uint32_t triangles, gl_array_source source,
                 const void *context, gl_mesh *mesh)
{
    mesh->corner_count = 3 * triangles;
    mesh->size = (uint64_t)triangles * 3 * sizeof(mesh_corner);
    gl_upload_mesh(list, mesh, source, context);
}

void gl_mesh_plan_body(gl_upload_list *list, const parian_body *body, gl_mesh *mesh)
{
    plan(list, body->triangle_count, copy_body, body, mesh);
}

void gl_mesh_plan_surrounding(gl_upload_list *list, const parian_surrounding *surrounding,
                              gl_mesh *mesh)
{
    plan(list, surrounding->triangle_count, copy_surrounding, surrounding, mesh);
}

uint32_t gl_mesh_corner_size(void)
{
    return sizeof(mesh_corner);
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

parian_result gl_mesh_allocate(gl_device *device, gl_mesh *mesh)
{
    parian_result result = gl_memory_add(device, mesh->size);
    if (result != PARIAN_OK) {
        return result;
    }
    device->gl.GenVertexArrays(1, &mesh->vertex_array);
    device->gl.GenBuffers(1, &mesh->buffer);
    device->gl.BindVertexArray(mesh->vertex_array);
    device->gl.BindBuffer(GL_ARRAY_BUFFER, mesh->buffer);
    device->gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)mesh->size, NULL, GL_STATIC_DRAW);
    describe(device);
    result = gl_error_check(device, "mesh", mesh->size);
    if (result != PARIAN_OK) {
        gl_mesh described = {.corner_count = mesh->corner_count, .size = mesh->size};
        gl_mesh_destroy(device, mesh);
        *mesh = described;
    }
    return result;
}

void gl_mesh_write(gl_device *device, const gl_mesh *mesh, uint64_t first, uint64_t count,
                   const void *corners)
{
    device->gl.BindBuffer(GL_ARRAY_BUFFER, mesh->buffer);
    device->gl.BufferSubData(GL_ARRAY_BUFFER, (GLintptr)(first * sizeof(mesh_corner)),
                             (GLsizeiptr)(count * sizeof(mesh_corner)), corners);
}

void gl_mesh_destroy(gl_device *device, gl_mesh *mesh)
{
    if (mesh->vertex_array) {
        device->gl.DeleteVertexArrays(1, &mesh->vertex_array);
        device->gl.DeleteBuffers(1, &mesh->buffer);
        gl_memory_remove(device, PARIAN_MEMORY_MESHES, mesh->size);
    }
    memset(mesh, 0, sizeof *mesh);
}

void gl_mesh_draw(gl_device *device, const gl_mesh *mesh)
{
    device->gl.BindVertexArray(mesh->vertex_array);
    device->gl.DrawArrays(GL_TRIANGLES, 0, (GLsizei)mesh->corner_count);
}
