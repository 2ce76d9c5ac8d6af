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
    for (int i = 0; result == PARIAN_OK && i < 6; i++) {
        result = gl_texture_create(device, GL_FORMAT_RGBA32F, body->atlas_size, body->atlas_size,
                                   NULL, atlases[i]);
    }
    for (uint32_t r = 0; result == PARIAN_OK && r < parian_body_register_count(body); r++) {
        result = gl_vector_create(device, parian_body_register_size(body, r), &made->registers[r]);
    }
    return result;
}

void gl_lit_destroy(gl_device *device, gl_lit *made)
{
    gl_texture *atlases[6] = {&made->irradiance,       &made->local,       &made->global,
                              &made->shown_irradiance, &made->shown_local, &made->shown_global};
    for (int i = 0; i < 6; i++) {
        gl_texture_destroy(device, atlases[i]);
    }
    for (uint32_t r = 0; r < GL_REGISTER_MAX; r++) {
        gl_texture_destroy(device, &made->registers[r]);
    }
}
