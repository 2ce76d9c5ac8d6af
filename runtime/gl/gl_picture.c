/* gl_picture.c - shading into samples, samples to pixels, exposure, tone curve.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_state.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "shade/view.h"

/* ---- targets ---- */

void gl_picture_destroy(gl_device *device, gl_picture *picture)
{
    gl_texture_destroy(device, &picture->samples);
    gl_texture_destroy(device, &picture->picture);
    gl_texture_destroy(device, &picture->srgb);
    for (int i = 0; i < GL_REDUCTION_MAX; i++) {
        gl_texture_destroy(device, &picture->reduction[i]);
    }
    gl_texture_destroy(device, &picture->mean);
    gl_texture_destroy(device, &picture->logs);
    if (picture->depth) {
        device->gl.DeleteRenderbuffers(1, &picture->depth);
        device->gl.DeleteFramebuffers(1, &picture->framebuffer);
        gl_memory_remove(device, PARIAN_MEMORY_PICTURE, picture->depth_size);
    }
    memset(picture, 0, sizeof *picture);
}

/* Side of what n pixels are summed to. */
static uint32_t reduced(uint32_t n)
{
    return (n + 7) / 8;
}

/* What targets of this size are, without making them. */
static gl_picture describe(uint32_t width, uint32_t height, uint32_t texture_max)
{
    uint32_t side = parian_view_supersampling(width, height, texture_max);
    gl_picture made = {.width = width, .height = height, .side = side};
    made.samples = gl_texture_describe(GL_FORMAT_RGBA32F, width * side, height * side);
    made.picture = gl_texture_describe(GL_FORMAT_RGBA32F, width, height);
    made.srgb = gl_texture_describe(GL_FORMAT_RGBA8, width, height);
    made.mean = made.logs = gl_texture_describe(GL_FORMAT_RGBA32F, 1, 1);
    made.depth_size = made.samples.size / 4; /* 24 bits, kept as 32 */
    do {
        width = reduced(width);
        height = reduced(height);
        made.reduction[made.reduction_count++] =
            gl_texture_describe(GL_FORMAT_RGBA32F, width, height);
    } while (width > 1 || height > 1);
    return made;
}

void gl_picture_count(uint32_t width, uint32_t height, parian_memory *memory)
{
    const gl_picture made = describe(width, height, 16384);
    uint64_t size = made.samples.size + made.depth_size + made.picture.size + made.srgb.size +
                    made.mean.size + made.logs.size;
    for (int i = 0; i < made.reduction_count; i++) {
        size += made.reduction[i].size;
    }
    memory->bytes[PARIAN_MEMORY_PICTURE] += size;
    memory->total += size;
}

static parian_result create_framebuffer(gl_device *device, gl_picture *made)
{
    const parian_gl_api *gl = &device->gl;
    parian_result result = gl_memory_add(device, made->depth_size);
    if (result != PARIAN_OK) {
        return result;
    }
    gl->GenFramebuffers(1, &made->framebuffer);
    gl->GenRenderbuffers(1, &made->depth);
    gl->BindRenderbuffer(GL_RENDERBUFFER, made->depth);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, (GLsizei)made->samples.width,
                            (GLsizei)made->samples.height);
    result = gl_error_check(device, "depth buffer", made->depth_size);
    if (result != PARIAN_OK) {
        return result;
    }
    gl->BindFramebuffer(GL_FRAMEBUFFER, made->framebuffer);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                             made->samples.name, 0);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, made->depth);
    if (gl->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        return parian_fail(device->env, PARIAN_E_DEVICE,
                           "this OpenGL cannot draw to %u x %u floats with depth",
                           made->samples.width, made->samples.height);
    }
    return PARIAN_OK;
}

static parian_result create_targets(gl_device *device, gl_picture *made)
{
    gl_texture *targets[5] = {&made->samples, &made->picture, &made->srgb, &made->mean,
                              &made->logs};
    parian_result result = PARIAN_OK;
    for (int i = 0; i < 5 && result == PARIAN_OK; i++) {
        result = gl_texture_allocate(device, targets[i]);
    }
    for (int i = 0; i < made->reduction_count && result == PARIAN_OK; i++) {
        result = gl_texture_allocate(device, &made->reduction[i]);
    }
    return result == PARIAN_OK ? create_framebuffer(device, made) : result;
}

/* Targets of another size go before the new ones come: what a smaller picture frees is free. */
parian_result gl_picture_prepare(parian_renderer *renderer, uint32_t width, uint32_t height)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    gl_picture *made = &state->picture;
    if (made->width == width && made->height == height) {
        return PARIAN_OK;
    }
    gl_picture_destroy(device, made);
    *made = describe(width, height, (uint32_t)device->texture_max);
    device->part = PARIAN_MEMORY_PICTURE;
    parian_result result = create_targets(device, made);
    if (result != PARIAN_OK) {
        gl_picture_destroy(device, made);
    }
    return result;
}

/* ---- shading ---- */

static void set_view(const parian_renderer *renderer, const parian_view *view,
                     const parian_placement *at)
{
    gl_device *device = &((gl_state *)renderer->state)->device;
    float clip[16];
    placement_fold_matrix(at, view->clip, clip);
    gl_pass_lights(renderer, at->scale);
    gl_pass_mat4(device, "u_clip", clip);
    gl_pass_mat4(device, "u_model", at->model);
    gl_pass_vec4(device, "u_eye", 1, view->eye);
    gl_pass_int(device, "u_view", (int)renderer->settings.view);
}

static void draw_body(const parian_renderer *renderer, uint32_t instance, uint32_t b)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    const gl_body *body = &state->body[b];
    const gl_lit *lit = &state->lit[instance * renderer->scene->data.body_count + b];
    const parian_settings *settings = &renderer->settings;
    const parian_body_optics *optics = &renderer->optics[b];
    bool whole = settings->view == PARIAN_VIEW_COMBINED || settings->view == PARIAN_VIEW_OPAQUE;
    float roughness = settings->roughness > 0.0f ? settings->roughness : 0.35f;
    gl_pass_texture(device, "u_irradiance",
                    settings->view == PARIAN_VIEW_VALUES ? &body->values : &lit->shown_irradiance);
    gl_pass_texture(device, "u_local", &lit->shown_local);
    gl_pass_texture(device, "u_global", &lit->shown_global);
    gl_pass_texture(device, "u_normal_map", &body->normal_map);
    gl_pass_texture(device, "u_albedo", &body->albedo);
    gl_pass_int(device, "u_has_normal_map", body->normal_map.name && !settings->no_normal_map);
    gl_pass_int(device, "u_has_albedo", body->albedo.name && !settings->no_albedo);
    gl_pass_int(device, "u_specular", whole && !settings->no_specular && optics->eta != 1.0f);
    gl_pass_float(device, "u_alpha", fmaxf(roughness * roughness, 1e-3f));
    gl_pass_float(device, "u_eta", optics->eta);
    gl_pass_float(device, "u_exit_norm", optics->exit_norm);
    gl_pass_vec3(device, "u_tint", 1, optics->tint);
    gl_pass_vec3(device, "u_total", 1, optics->albedo);
    gl_mesh_draw(device, &body->mesh);
}

static void clear_samples(const parian_renderer *renderer)
{
    const parian_gl_api *gl = &((gl_state *)renderer->state)->device.gl;
    const float *background = renderer->settings.background;
    const GLfloat color[4] = {background[0], background[1], background[2], 0.0f}, farthest = 1.0f;
    gl->ClearBufferfv(GL_COLOR, 0, color);
    gl->ClearBufferfv(GL_DEPTH, 0, &farthest);
}

static void draw_meshes(const parian_renderer *renderer, const parian_view *view)
{
    static const parian_placement stay = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, 1};
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    const parian_scene_data *data = &renderer->scene->data;
    for (uint32_t i = 0; i < renderer->instance_count; i++) {
        for (uint32_t b = 0; b < data->body_count; b++) {
            gl_pass_use(device, GL_PROGRAM_BODY);
            set_view(renderer, view, &renderer->instances[i]);
            draw_body(renderer, i, b);
        }
    }
    gl_pass_use(device, GL_PROGRAM_SURROUNDING);
    set_view(renderer, view, &stay);
    for (uint32_t s = 0; s < data->surrounding_count; s++) {
        gl_pass_vec3(device, "u_reflectance", 1, data->surroundings[s].reflectance);
        gl_mesh_draw(device, &state->surrounding[s]);
    }
}

void gl_shade_run(parian_renderer *renderer, const parian_draw_desc *desc)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    const parian_gl_api *gl = &device->gl;
    parian_view view = parian_view_make(&desc->camera);
    const GLenum buffer = GL_COLOR_ATTACHMENT0;
    gl->BindFramebuffer(GL_FRAMEBUFFER, state->picture.framebuffer);
    gl->DrawBuffers(1, &buffer);
    gl->Viewport(0, 0, (GLsizei)state->picture.samples.width,
                 (GLsizei)state->picture.samples.height);
    clear_samples(renderer);
    gl->Enable(GL_DEPTH_TEST);
    draw_meshes(renderer, &view);
    gl->Disable(GL_DEPTH_TEST);
    const gl_texture *target = &state->picture.picture;
    gl_pass_begin(device, GL_PROGRAM_RESOLVE, &target, 1);
    gl_pass_texture(device, "u_samples", &state->picture.samples);
    gl_pass_int(device, "u_side", (int)state->picture.side);
    gl_pass_quad(device);
}

/* ---- tone ---- */

/* Sum a term of the picture (mode 0 luminance, 1 its logarithm) down to one texel. */
static void reduce(gl_device *device, gl_picture *picture, int mode, const gl_texture *result)
{
    const gl_texture *from = &picture->picture;
    for (int i = 0; i < picture->reduction_count; i++) {
        const gl_texture *target =
            i + 1 < picture->reduction_count ? &picture->reduction[i] : result;
        gl_pass_begin(device, GL_PROGRAM_LUMINANCE, &target, 1);
        gl_pass_texture(device, "u_from", from);
        gl_pass_texture(device, "u_mean", mode == 1 ? &picture->mean : from);
        gl_pass_int(device, "u_mode", i == 0 ? mode : 2);
        gl_pass_quad(device);
        from = target;
    }
}

static void set_tone(const parian_renderer *renderer, const parian_draw_desc *desc)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    gl_pass_texture(device, "u_picture", &state->picture.picture);
    gl_pass_texture(device, "u_mean", &state->picture.mean);
    gl_pass_texture(device, "u_logs", &state->picture.logs);
    gl_pass_int(device, "u_auto", desc->exposure_auto ? 1 : 0);
    gl_pass_int(device, "u_plain", parian_view_is_plain(renderer->settings.view));
    gl_pass_int(device, "u_tone", (int)desc->tone);
    gl_pass_float(device, "u_exposure", exp2f(desc->exposure_ev));
    gl_pass_quad(device);
}

void gl_tone_run(parian_renderer *renderer, const parian_draw_desc *desc)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    if (desc->exposure_auto) {
        reduce(device, &state->picture, 0, &state->picture.mean);
        reduce(device, &state->picture, 1, &state->picture.logs);
    }
    const gl_texture *target = &state->picture.srgb;
    gl_pass_begin(device, GL_PROGRAM_TONE, &target, 1);
    set_tone(renderer, desc);
    if (desc->framebuffer != UINT32_MAX) {
        gl_pass_use(device, GL_PROGRAM_TONE);
        device->gl.BindFramebuffer(GL_FRAMEBUFFER, desc->framebuffer);
        device->gl.Viewport(0, 0, (GLsizei)desc->width, (GLsizei)desc->height);
        set_tone(renderer, desc);
    }
}
