/* gl_lit.c - results of the passes for a body of one instance.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_body.h"

parian_result gl_lit_create(gl_device *device, const parian_body *body, gl_lit *made)
{
    gl_texture *atlases[6] = {&made->irradiance,       &made->local,       &made->global,
                              &made->shown_irradiance, &made->shown_local, &made->shown_global};
    parian_result result = PARIAN_OK;
    device->part = PARIAN_MEMORY_INSTANCES;
    for (int i = 0; result == PARIAN_OK && i < 6; i++) {
        *atlases[i] = gl_texture_describe(GL_FORMAT_RGBA32F, body->atlas_size, body->atlas_size);
        result = gl_texture_allocate(device, atlases[i]);
    }
    for (uint32_t r = 0; result == PARIAN_OK && r < parian_body_register_count(body); r++) {
        made->registers[r] = gl_vector_describe(parian_body_register_size(body, r));
        result = gl_texture_allocate(device, &made->registers[r]);
    }
    return result;
}

void gl_lit_count(const parian_body *body, uint32_t instance_count, parian_memory *memory)
{
    uint64_t size =
        6 * gl_texture_describe(GL_FORMAT_RGBA32F, body->atlas_size, body->atlas_size).size;
    for (uint32_t r = 0; r < parian_body_register_count(body); r++) {
        size += gl_vector_describe(parian_body_register_size(body, r)).size;
    }
    memory->bytes[PARIAN_MEMORY_INSTANCES] += instance_count * size;
    memory->total += instance_count * size;
}

parian_result gl_lit_add_radiosity(gl_device *device, gl_lit *made)
{
    gl_texture wanted =
        gl_texture_describe(GL_FORMAT_RGBA32F, made->local.width, made->local.height);
    device->part = PARIAN_MEMORY_INSTANCES;
    parian_result result = gl_texture_allocate(device, &wanted);
    if (result == PARIAN_OK) {
        made->radiosity = wanted;
    }
    return result;
}

void gl_lit_destroy(gl_device *device, gl_lit *made)
{
    gl_texture_destroy(device, &made->radiosity);
    gl_texture *atlases[6] = {&made->irradiance,       &made->local,       &made->global,
                              &made->shown_irradiance, &made->shown_local, &made->shown_global};
    for (int i = 0; i < 6; i++) {
        gl_texture_destroy(device, atlases[i]);
    }
    for (uint32_t r = 0; r < GL_REGISTER_MAX; r++) {
        gl_texture_destroy(device, &made->registers[r]);
    }
}
