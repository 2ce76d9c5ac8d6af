/* gl_transfer.c - the passes from lights to scattered radiosity, all gathers. C: cpu/cpu_lights.c,
 * cpu_transfer.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_state.h"

static const parian_body *data_of(const parian_renderer *renderer, uint32_t b)
{
    return &renderer->scene->data.bodies[b];
}

void gl_irradiance_run(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        gl_body *body = &state->body[b];
        const gl_texture *target = &body->irradiance;
        gl_pass_begin(device, GL_PROGRAM_IRRADIANCE, &target, 1);
        gl_pass_lights(renderer);
        gl_pass_texture(device, "u_position", &body->position);
        gl_pass_texture(device, "u_normal", &body->normal);
        gl_pass_float(device, "u_eta", renderer->optics[b].eta);
        gl_pass_vec3(device, "u_zonal", 1, renderer->optics[b].zonal_transmit);
        gl_pass_quad(device);
    }
}

void gl_restrict_run(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        gl_body *body = &state->body[b];
        const gl_texture *targets[2] = {&body->registers[0], &body->registers[1]};
        gl_pass_begin(device, GL_PROGRAM_RESTRICT, targets, 2);
        gl_pass_texture(device, "u_offset", &body->feed_offset);
        gl_pass_texture(device, "u_feed", &body->feed);
        gl_pass_texture(device, "u_weight", &body->feed_weight);
        gl_pass_texture(device, "u_irradiance", &body->irradiance);
        gl_pass_int(device, "u_vertex_count", (int)data_of(renderer, b)->vertex_count);
        gl_pass_int(device, "u_atlas_size", (int)data_of(renderer, b)->atlas_size);
        gl_pass_int(device, "u_weighted", body->feed_weight.name ? 1 : 0);
        gl_pass_quad(device);
    }
}

/* Registers that only operators write start at zero. */
static void clear_register(gl_device *device, const gl_texture *target)
{
    static const GLfloat zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    gl_pass_begin(device, GL_PROGRAM_ROWS, &target, 1);
    device->gl.ClearBufferfv(GL_COLOR, 0, zero);
}

static void apply_operator(gl_device *device, const parian_operator *op, gl_body *body,
                           gl_operator *made)
{
    const gl_texture *partial = &made->partial, *sum = &body->spare[op->target_register];
    gl_pass_begin(device, GL_PROGRAM_SEGMENT, &partial, 1);
    gl_pass_texture(device, "u_segment", &made->segment);
    gl_pass_texture(device, "u_run", &made->run);
    gl_pass_texture(device, "u_factor", &made->factor);
    gl_pass_texture(device, "u_source", &body->registers[op->source_register]);
    gl_pass_int(device, "u_segment_count", (int)made->segment_count);
    gl_pass_quad(device);
    gl_pass_begin(device, GL_PROGRAM_ROWS, &sum, 1);
    gl_pass_texture(device, "u_row_segment", &made->row_segment);
    gl_pass_texture(device, "u_scale", &made->scale);
    gl_pass_texture(device, "u_partial", &made->partial);
    gl_pass_texture(device, "u_base", &body->registers[op->target_register]);
    gl_pass_int(device, "u_row_count", (int)op->row_count);
    gl_pass_quad(device);
    gl_texture swap = body->registers[op->target_register];
    body->registers[op->target_register] = body->spare[op->target_register];
    body->spare[op->target_register] = swap;
}

void gl_product_run(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        const parian_body *data = data_of(renderer, b);
        for (uint32_t r = 2; r < state->body[b].register_count; r++) {
            clear_register(&state->device, &state->body[b].registers[r]);
        }
        for (uint32_t o = 0; o < data->operator_count; o++) {
            apply_operator(&state->device, &data->operators[o], &state->body[b],
                           &state->body[b].operators[o]);
        }
    }
}

void gl_filter_run(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        gl_body *body = &state->body[b];
        const parian_body *data = data_of(renderer, b);
        const gl_texture *targets[2] = {&body->local, &body->global};
        bool local = data->local_form != PARIAN_LOCAL_NONE;
        gl_pass_begin(device, GL_PROGRAM_FILTER, targets, 2);
        gl_pass_texture(device, "u_info", &body->info);
        gl_pass_texture(device, "u_barycentric", &body->barycentric);
        gl_pass_texture(device, "u_irradiance", &body->irradiance);
        gl_pass_texture(device, "u_vertex", &body->registers[1]);
        gl_pass_texture(device, "u_kernel", &body->kernel);
        gl_pass_texture(device, "u_border", &body->border);
        gl_pass_texture(device, "u_neighbour", &body->neighbour);
        gl_pass_texture(device, "u_border_kernel", &body->border_kernel);
        gl_pass_int(device, "u_width", local ? (int)data->kernel_width : 0);
        gl_pass_int(device, "u_interior_count", (int)body->interior_count);
        gl_pass_int(device, "u_atlas_size", (int)data->atlas_size);
        gl_pass_vec3(device, "u_channel_scale", 1, body->channel_scale);
        gl_pass_quad(device);
    }
}

void gl_gutter_run(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        gl_body *body = &state->body[b];
        const gl_texture *targets[3] = {&body->shown_irradiance, &body->shown_local,
                                        &body->shown_global};
        gl_pass_begin(device, GL_PROGRAM_GUTTER, targets, 3);
        gl_pass_texture(device, "u_info", &body->info);
        gl_pass_texture(device, "u_source", &body->gutter_source);
        gl_pass_texture(device, "u_weight", &body->gutter_weight);
        gl_pass_texture(device, "u_irradiance", &body->irradiance);
        gl_pass_texture(device, "u_local", &body->local);
        gl_pass_texture(device, "u_global", &body->global);
        gl_pass_int(device, "u_atlas_size", (int)data_of(renderer, b)->atlas_size);
        gl_pass_quad(device);
    }
}
