/* gl_kept.c - the application's GL state: kept, set to what our passes expect, put back.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_device.h"

#include "core/memory.h"

/* A capability or a pixel storage mode: since which version of each API, 0 for never. */
typedef struct kept_name {
    GLenum name;
    int core, es;
} kept_name;

static const kept_name kept_enables[] = {
    {GL_DEPTH_TEST, 33, 30},
    {GL_CULL_FACE, 33, 30},
    {GL_SCISSOR_TEST, 33, 30},
    {GL_STENCIL_TEST, 33, 30},
    {GL_RASTERIZER_DISCARD, 33, 30},
    {GL_POLYGON_OFFSET_FILL, 33, 30},
    {GL_SAMPLE_ALPHA_TO_COVERAGE, 33, 30},
    {GL_SAMPLE_COVERAGE, 33, 30},
    {GL_DITHER, 33, 30},
    {GL_SAMPLE_MASK, 33, 31},
    {GL_FRAMEBUFFER_SRGB, 33, 0},
    {GL_DEPTH_CLAMP, 33, 0},
    {GL_COLOR_LOGIC_OP, 33, 0},
    {GL_POLYGON_SMOOTH, 33, 0},
    {GL_PRIMITIVE_RESTART, 33, 0},
    {GL_CLIP_DISTANCE0, 33, 0},
    {GL_CLIP_DISTANCE1, 33, 0},
    {GL_CLIP_DISTANCE2, 33, 0},
    {GL_CLIP_DISTANCE3, 33, 0},
    {GL_CLIP_DISTANCE4, 33, 0},
    {GL_CLIP_DISTANCE5, 33, 0},
    {GL_CLIP_DISTANCE6, 33, 0},
    {GL_CLIP_DISTANCE7, 33, 0},
};
enum { ENABLE_COUNT = sizeof kept_enables / sizeof *kept_enables };
_Static_assert((int)ENABLE_COUNT <= (int)GL_KEPT_ENABLE_MAX, "room for every capability");

/* All are set to 0 but the alignments, which are set to 1. */
static const kept_name kept_pixel_store[] = {
    {GL_PACK_ALIGNMENT, 33, 30},      {GL_PACK_ROW_LENGTH, 33, 30},
    {GL_PACK_SKIP_ROWS, 33, 30},      {GL_PACK_SKIP_PIXELS, 33, 30},
    {GL_UNPACK_ALIGNMENT, 33, 30},    {GL_UNPACK_ROW_LENGTH, 33, 30},
    {GL_UNPACK_SKIP_ROWS, 33, 30},    {GL_UNPACK_SKIP_PIXELS, 33, 30},
    {GL_UNPACK_IMAGE_HEIGHT, 33, 30}, {GL_UNPACK_SKIP_IMAGES, 33, 30},
    {GL_PACK_SWAP_BYTES, 33, 0},      {GL_UNPACK_SWAP_BYTES, 33, 0},
};
enum { PIXEL_STORE_COUNT = sizeof kept_pixel_store / sizeof *kept_pixel_store };
_Static_assert((int)PIXEL_STORE_COUNT <= (int)GL_KEPT_PIXEL_STORE_MAX, "room for every mode");

enum { PENDING_ERROR_MAX = 16 }; /* a lost context answers with errors for ever */

static bool has(const gl_device *device, const kept_name *kept)
{
    int since = device->es ? kept->es : kept->core;
    return since > 0 && device->version >= since;
}

static void switch_to(const parian_gl_api *gl, GLenum capability, GLboolean on)
{
    if (on) {
        gl->Enable(capability);
    } else {
        gl->Disable(capability);
    }
}

/* ---- keep ---- */

static void drop_errors(gl_device *device)
{
    for (int i = 0; i < PENDING_ERROR_MAX; i++) {
        GLenum error = device->gl.GetError();
        if (error == GL_NO_ERROR) {
            return;
        }
        if (error == GL_CONTEXT_LOST) {
            device->lost = true;
            return;
        }
        parian_log(device->env, PARIAN_LOG_WARNING,
                   "OpenGL error 0x%04X was pending before this call; it is dropped", error);
    }
}

/* A program that was deleted while it is current goes when another takes its place. */
static void keep_program(const parian_gl_api *gl, gl_kept_state *kept)
{
    GLint deleted = GL_FALSE;
    gl->GetIntegerv(GL_CURRENT_PROGRAM, &kept->program);
    if (kept->program) {
        gl->GetProgramiv((GLuint)kept->program, GL_DELETE_STATUS, &deleted);
    }
    if (deleted) {
        kept->program = 0;
    }
}

static void keep_bindings(const parian_gl_api *gl, gl_kept_state *kept)
{
    keep_program(gl, kept);
    gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &kept->draw_framebuffer);
    gl->GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &kept->read_framebuffer);
    gl->GetIntegerv(GL_RENDERBUFFER_BINDING, &kept->renderbuffer);
    gl->GetIntegerv(GL_VERTEX_ARRAY_BINDING, &kept->vertex_array);
    gl->GetIntegerv(GL_ARRAY_BUFFER_BINDING, &kept->array_buffer);
    gl->GetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &kept->pack_buffer);
    gl->GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &kept->unpack_buffer);
    gl->GetIntegerv(GL_ACTIVE_TEXTURE, &kept->active_texture);
    for (int u = 0; u < GL_UNIT_MAX; u++) {
        gl->ActiveTexture(GL_TEXTURE0 + (GLenum)u);
        gl->GetIntegerv(GL_TEXTURE_BINDING_2D, &kept->texture[u]);
        gl->GetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &kept->texture_array[u]);
        gl->GetIntegerv(GL_SAMPLER_BINDING, &kept->sampler[u]);
        gl->BindSampler((GLuint)u, 0);
    }
    gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

static void keep_buffers(const gl_device *device, gl_kept_state *kept)
{
    const parian_gl_api *gl = &device->gl;
    kept->buffer_count = 1;
    if (gl_device_has_indexed(device)) {
        gl->GetIntegerv(GL_MAX_DRAW_BUFFERS, &kept->buffer_count);
    }
    if (kept->buffer_count > GL_KEPT_BUFFER_MAX) {
        kept->buffer_count = GL_KEPT_BUFFER_MAX;
    }
    gl->GetBooleanv(GL_COLOR_WRITEMASK, kept->color_mask[0]);
    kept->blend[0] = gl->IsEnabled(GL_BLEND);
    for (int i = 1; i < kept->buffer_count; i++) {
        gl->GetBooleani_v(GL_COLOR_WRITEMASK, (GLuint)i, kept->color_mask[i]);
        kept->blend[i] = gl->IsEnabledi(GL_BLEND, (GLuint)i);
    }
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->Disable(GL_BLEND);
}

static void keep_raster(const gl_device *device, gl_kept_state *kept)
{
    const parian_gl_api *gl = &device->gl;
    gl->GetIntegerv(GL_VIEWPORT, kept->viewport);
    gl->GetIntegerv(GL_DEPTH_FUNC, &kept->depth_func);
    gl->GetBooleanv(GL_DEPTH_WRITEMASK, &kept->depth_mask);
    gl->GetFloatv(GL_DEPTH_RANGE, kept->depth_range);
    gl->DepthFunc(GL_LESS);
    gl->DepthMask(GL_TRUE);
    if (device->es) {
        gl->DepthRangef(0.0f, 1.0f);
        return;
    }
    gl->DepthRange(0.0, 1.0);
    gl->GetIntegerv(GL_POLYGON_MODE, kept->polygon_mode);
    gl->GetIntegerv(GL_CLAMP_READ_COLOR, &kept->clamp_read);
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    gl->ClampColor(GL_CLAMP_READ_COLOR, GL_FIXED_ONLY);
}

void gl_device_enter(gl_device *device)
{
    const parian_gl_api *gl = &device->gl;
    gl_kept_state *kept = &device->kept;
    drop_errors(device);
    keep_bindings(gl, kept);
    keep_buffers(device, kept);
    keep_raster(device, kept);
    for (int i = 0; i < ENABLE_COUNT; i++) {
        if (has(device, &kept_enables[i])) {
            kept->enabled[i] = gl->IsEnabled(kept_enables[i].name);
            gl->Disable(kept_enables[i].name);
        }
    }
    for (int i = 0; i < PIXEL_STORE_COUNT; i++) {
        GLenum name = kept_pixel_store[i].name;
        if (has(device, &kept_pixel_store[i])) {
            gl->GetIntegerv(name, &kept->pixel_store[i]);
            gl->PixelStorei(name, name == GL_PACK_ALIGNMENT || name == GL_UNPACK_ALIGNMENT);
        }
    }
}

/* ---- put back ---- */

static void put_back_bindings(const parian_gl_api *gl, const gl_kept_state *kept)
{
    for (int u = 0; u < GL_UNIT_MAX; u++) {
        gl->ActiveTexture(GL_TEXTURE0 + (GLenum)u);
        gl->BindTexture(GL_TEXTURE_2D, (GLuint)kept->texture[u]);
        gl->BindTexture(GL_TEXTURE_2D_ARRAY, (GLuint)kept->texture_array[u]);
        gl->BindSampler((GLuint)u, (GLuint)kept->sampler[u]);
    }
    gl->ActiveTexture((GLenum)kept->active_texture);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)kept->draw_framebuffer);
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)kept->read_framebuffer);
    gl->BindRenderbuffer(GL_RENDERBUFFER, (GLuint)kept->renderbuffer);
    gl->UseProgram((GLuint)kept->program);
    gl->BindVertexArray((GLuint)kept->vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, (GLuint)kept->array_buffer);
    gl->BindBuffer(GL_PIXEL_PACK_BUFFER, (GLuint)kept->pack_buffer);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, (GLuint)kept->unpack_buffer);
}

static void put_back_buffers(const gl_device *device, const gl_kept_state *kept)
{
    const parian_gl_api *gl = &device->gl;
    const GLboolean *mask = kept->color_mask[0];
    gl->ColorMask(mask[0], mask[1], mask[2], mask[3]);
    switch_to(gl, GL_BLEND, kept->blend[0]);
    for (int i = 1; i < kept->buffer_count; i++) {
        mask = kept->color_mask[i];
        gl->ColorMaski((GLuint)i, mask[0], mask[1], mask[2], mask[3]);
        if (kept->blend[i]) {
            gl->Enablei(GL_BLEND, (GLuint)i);
        } else {
            gl->Disablei(GL_BLEND, (GLuint)i);
        }
    }
}

static void put_back_raster(const gl_device *device, const gl_kept_state *kept)
{
    const parian_gl_api *gl = &device->gl;
    gl->Viewport(kept->viewport[0], kept->viewport[1], kept->viewport[2], kept->viewport[3]);
    gl->DepthFunc((GLenum)kept->depth_func);
    gl->DepthMask(kept->depth_mask);
    if (device->es) {
        gl->DepthRangef(kept->depth_range[0], kept->depth_range[1]);
        return;
    }
    gl->DepthRange((GLdouble)kept->depth_range[0], (GLdouble)kept->depth_range[1]);
    gl->PolygonMode(GL_FRONT_AND_BACK, (GLenum)kept->polygon_mode[0]);
    gl->ClampColor(GL_CLAMP_READ_COLOR, (GLenum)kept->clamp_read);
}

static bool is_lost(gl_device *device, GLenum error)
{
    const parian_gl_api *gl = &device->gl;
    if (error == GL_CONTEXT_LOST ||
        (gl->GetGraphicsResetStatus && gl->GetGraphicsResetStatus() != GL_NO_ERROR)) {
        device->lost = true;
    }
    return device->lost;
}

parian_result gl_device_leave(gl_device *device, parian_result result, const char *what)
{
    const parian_gl_api *gl = &device->gl;
    const gl_kept_state *kept = &device->kept;
    GLenum error = gl->GetError();
    put_back_bindings(gl, kept);
    put_back_buffers(device, kept);
    put_back_raster(device, kept);
    for (int i = 0; i < ENABLE_COUNT; i++) {
        if (has(device, &kept_enables[i])) {
            switch_to(gl, kept_enables[i].name, kept->enabled[i]);
        }
    }
    for (int i = 0; i < PIXEL_STORE_COUNT; i++) {
        if (has(device, &kept_pixel_store[i])) {
            gl->PixelStorei(kept_pixel_store[i].name, kept->pixel_store[i]);
        }
    }
    if (is_lost(device, error)) {
        return parian_fail(
            device->env, PARIAN_E_DEVICE,
            "the OpenGL context was lost while it %s: destroy this renderer, and make "
            "another in a new context",
            what);
    }
    if (result == PARIAN_OK && error != GL_NO_ERROR) {
        parian_result kind = error == GL_OUT_OF_MEMORY ? PARIAN_E_NOMEM : PARIAN_E_DEVICE;
        return parian_fail(device->env, kind, "OpenGL error 0x%04X while it %s", error, what);
    }
    return result;
}
