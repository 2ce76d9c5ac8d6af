/* gl_transfer.c - the passes from E to scattered radiosity, all gathers. C: cpu/cpu_transfer.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_state.h"

/* One body of one instance, on which a pass works. */
typedef struct pass_body {
    const parian_body *data;
    gl_body *body;
    gl_lit *lit;
} pass_body;

static pass_body find_body(parian_renderer *renderer, uint32_t instance, uint32_t b)
{
    gl_state *state = renderer->state;
    const parian_scene_data *data = &renderer->scene->data;
    return (pass_body){&data->bodies[b], &state->body[b],
                       &state->lit[instance * data->body_count + b]};
}

static void run_all(parian_renderer *renderer, void (*run)(parian_renderer *, const pass_body *))
{
    for (uint32_t i = 0; i < renderer->instance_count; i++) {
        for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
            const pass_body one = find_body(renderer, i, b);
            run(renderer, &one);
        }
    }
}

static void restrict_body(parian_renderer *renderer, const pass_body *one)
{
    gl_device *device = &((gl_state *)renderer->state)->device;
    const gl_body *body = one->body;
    const gl_texture *targets[2] = {&one->lit->registers[0], &one->lit->registers[1]};
    gl_pass_begin(device, GL_PROGRAM_RESTRICT, targets, 2);
    gl_pass_texture(device, "u_offset", &body->feed_offset);
    gl_pass_texture(device, "u_feed", &body->feed);
    gl_pass_texture(device, "u_weight", &body->feed_weight);
    gl_pass_texture(device, "u_irradiance", &one->lit->irradiance);
    gl_pass_int(device, "u_vertex_count", (int)one->data->vertex_count);
    gl_pass_int(device, "u_atlas_size", (int)one->data->atlas_size);
    gl_pass_int(device, "u_weighted", body->feed_weight.name ? 1 : 0);
    gl_pass_quad(device);
}

void gl_restrict_run(parian_renderer *renderer)
{
    run_all(renderer, restrict_body);
}

/* Registers that only operators write start at zero. */
static void clear_register(gl_device *device, const gl_texture *target)
{
    static const GLfloat zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    gl_pass_begin(device, GL_PROGRAM_ROWS, &target, 1);
    device->gl.ClearBufferfv(GL_COLOR, 0, zero);
}

static void apply_operator(gl_device *device, const parian_operator *op, const pass_body *one,
                           gl_operator *made)
{
    gl_texture *registers = one->lit->registers, *spare = &one->body->spare[op->target_register];
    const gl_texture *partial = &made->partial, *sum = spare;
    gl_pass_begin(device, GL_PROGRAM_SEGMENT, &partial, 1);
    gl_pass_texture(device, "u_segment", &made->segment);
    gl_pass_texture(device, "u_run", &made->run);
    gl_pass_texture(device, "u_factor", &made->factor);
    gl_pass_texture(device, "u_source", &registers[op->source_register]);
    gl_pass_int(device, "u_segment_count", (int)made->segment_count);
    gl_pass_quad(device);
    gl_pass_begin(device, GL_PROGRAM_ROWS, &sum, 1);
    gl_pass_texture(device, "u_row_segment", &made->row_segment);
    gl_pass_texture(device, "u_scale", &made->scale);
    gl_pass_texture(device, "u_partial", &made->partial);
    gl_pass_texture(device, "u_base", &registers[op->target_register]);
    gl_pass_int(device, "u_row_count", (int)op->row_count);
    gl_pass_quad(device);
    gl_texture swap = registers[op->target_register];
    registers[op->target_register] = *spare;
    *spare = swap;
}

static void multiply_body(parian_renderer *renderer, const pass_body *one)
{
    gl_device *device = &((gl_state *)renderer->state)->device;
    for (uint32_t r = 2; r < one->body->register_count; r++) {
        clear_register(device, &one->lit->registers[r]);
    }
    for (uint32_t o = 0; o < one->data->operator_count; o++) {
        apply_operator(device, &one->data->operators[o], one, &one->body->operators[o]);
    }
}

void gl_product_run(parian_renderer *renderer)
{
    run_all(renderer, multiply_body);
}

static void filter_body(parian_renderer *renderer, const pass_body *one)
{
    gl_device *device = &((gl_state *)renderer->state)->device;
    const gl_body *body = one->body;
    const gl_texture *targets[2] = {&one->lit->local, &one->lit->global};
    bool local = one->data->local_form != PARIAN_LOCAL_NONE;
    gl_pass_begin(device, GL_PROGRAM_FILTER, targets, 2);
    gl_pass_texture(device, "u_info", &body->info);
    gl_pass_texture(device, "u_barycentric", &body->barycentric);
    gl_pass_texture(device, "u_irradiance", &one->lit->irradiance);
    gl_pass_texture(device, "u_vertex", &one->lit->registers[1]);
    gl_pass_texture(device, "u_kernel", &body->kernel);
    gl_pass_texture(device, "u_border", &body->border);
    gl_pass_texture(device, "u_neighbour", &body->neighbour);
    gl_pass_texture(device, "u_border_kernel", &body->border_kernel);
    gl_pass_int(device, "u_width", local ? (int)one->data->kernel_width : 0);
    gl_pass_int(device, "u_interior_count", (int)body->interior_count);
    gl_pass_int(device, "u_atlas_size", (int)one->data->atlas_size);
    gl_pass_vec3(device, "u_channel_scale", 1, body->channel_scale);
    gl_pass_quad(device);
}

void gl_filter_run(parian_renderer *renderer)
{
    run_all(renderer, filter_body);
}

static void show_body(parian_renderer *renderer, const pass_body *one)
{
    gl_device *device = &((gl_state *)renderer->state)->device;
    gl_lit *lit = one->lit;
    const gl_texture *targets[4] = {&lit->shown_irradiance, &lit->shown_local, &lit->shown_global,
                                    &lit->radiosity};
    gl_pass_begin(device, GL_PROGRAM_GUTTER, targets, lit->radiosity.name ? 4 : 3);
    gl_pass_texture(device, "u_info", &one->body->info);
    gl_pass_texture(device, "u_source", &one->body->gutter_source);
    gl_pass_texture(device, "u_weight", &one->body->gutter_weight);
    gl_pass_texture(device, "u_irradiance", &lit->irradiance);
    gl_pass_texture(device, "u_local", &lit->local);
    gl_pass_texture(device, "u_global", &lit->global);
    gl_pass_int(device, "u_atlas_size", (int)one->data->atlas_size);
    gl_pass_quad(device);
}

void gl_gutter_run(parian_renderer *renderer)
{
    run_all(renderer, show_body);
}

void gl_gutter_run_one(parian_renderer *renderer, uint32_t instance, uint32_t body)
{
    const pass_body one = find_body(renderer, instance, body);
    show_body(renderer, &one);
}
