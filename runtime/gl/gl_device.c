/* gl_device.c - a GL context with our programs: requirements, kept state, passes.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_device.h"

#include <stdio.h>
#include <string.h>

#include "core/memory.h"

static bool has_extension(const parian_gl_api *gl, const char *name)
{
    GLint count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        const char *found = (const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i);
        if (found && strcmp(found, name) == 0) {
            return true;
        }
    }
    return false;
}

/* Where it is not part of OpenGL, an extension brings it, with a suffix. */
static void load_reset_status(gl_device *device, void *(*get_proc_address)(const char *name))
{
    static const struct {
        const char *extension, *function;
    } ways[] = {{"GL_KHR_robustness", "glGetGraphicsResetStatus"},
                {"GL_KHR_robustness", "glGetGraphicsResetStatusKHR"},
                {"GL_ARB_robustness", "glGetGraphicsResetStatusARB"},
                {"GL_EXT_robustness", "glGetGraphicsResetStatusEXT"}};
    void *address = NULL;
    if (device->version >= (device->es ? 32 : 45)) {
        address = get_proc_address(ways[0].function);
    }
    for (size_t i = 0; !address && i < sizeof ways / sizeof *ways; i++) {
        if (has_extension(&device->gl, ways[i].extension)) {
            address = get_proc_address(ways[i].function);
        }
    }
    memcpy(&device->gl.GetGraphicsResetStatus, &address, sizeof address);
}

static parian_result check_version(gl_device *device, void *(*get_proc_address)(const char *name),
                                   char *name, size_t name_size)
{
    const parian_gl_api *gl = &device->gl;
    const char *version = (const char *)gl->GetString(GL_VERSION);
    const char *renderer = (const char *)gl->GetString(GL_RENDERER);
    GLint major = 0, minor = 0;
    if (!version) {
        return parian_fail(device->env, PARIAN_E_DEVICE, "no OpenGL context is current");
    }
    device->es = strncmp(version, "OpenGL ES", 9) == 0;
    gl->GetIntegerv(GL_MAJOR_VERSION, &major);
    gl->GetIntegerv(GL_MINOR_VERSION, &minor);
    snprintf(name, name_size, "%s, OpenGL%s %d.%d", renderer ? renderer : "unknown",
             device->es ? " ES" : "", major, minor);
    device->version = 10 * major + minor;
    if (device->version < (device->es ? 30 : 33)) {
        return parian_fail(device->env, PARIAN_E_UNSUPPORTED,
                           "found %s, expected OpenGL 3.3 or OpenGL ES 3.0", version);
    }
    if (device->es && device->version < 32 && !has_extension(gl, "GL_EXT_color_buffer_float")) {
        return parian_fail(
            device->env, PARIAN_E_UNSUPPORTED,
            "this OpenGL ES cannot draw to floats: GL_EXT_color_buffer_float is missing");
    }
    load_reset_status(device, get_proc_address);
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &device->texture_max);
    gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &device->layers_max);
    return PARIAN_OK;
}

parian_result gl_device_init(const parian_env *env, void *(*get_proc_address)(const char *name),
                             uint64_t memory_budget, gl_device *device, char *name,
                             size_t name_size)
{
    device->env = env;
    device->memory_budget = memory_budget ? memory_budget : UINT64_MAX;
    parian_result result = parian_gl_api_load(env, get_proc_address, &device->gl);
    if (result == PARIAN_OK) {
        result = check_version(device, get_proc_address, name, name_size);
    }
    if (result == PARIAN_OK) {
        result = parian_gl_api_load_flavour(env, get_proc_address, device->es,
                                            gl_device_has_indexed(device), &device->gl);
    }
    if (result != PARIAN_OK) {
        memset(device, 0, sizeof *device); /* nothing to delete, and nothing to do it with */
        return result;
    }
    device->gl.GenFramebuffers(1, &device->framebuffer);
    device->gl.GenVertexArrays(1, &device->empty_vertex_array);
    return gl_programs_build(device);
}

void gl_device_destroy(gl_device *device)
{
    if (!device->gl.DeleteProgram) {
        return;
    }
    for (int id = 0; id < GL_PROGRAM_COUNT; id++) {
        if (device->program[id]) {
            device->gl.DeleteProgram(device->program[id]);
        }
    }
    device->gl.DeleteFramebuffers(1, &device->framebuffer);
    device->gl.DeleteVertexArrays(1, &device->empty_vertex_array);
}

/* ---- passes ---- */

void gl_pass_use(gl_device *device, gl_program_id program)
{
    device->current = program;
    device->unit = 0;
    device->gl.UseProgram(device->program[program]);
}

void gl_pass_begin(gl_device *device, gl_program_id program, const gl_texture *const *target,
                   int count)
{
    static const GLenum buffers[GL_TARGET_MAX] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                                  GL_COLOR_ATTACHMENT2, GL_COLOR_ATTACHMENT3};
    const parian_gl_api *gl = &device->gl;
    gl_pass_use(device, program);
    if (count == 0) {
        return;
    }
    gl->BindFramebuffer(GL_FRAMEBUFFER, device->framebuffer);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
    for (int i = 0; i < GL_TARGET_MAX; i++) {
        gl->FramebufferTexture2D(GL_FRAMEBUFFER, buffers[i], GL_TEXTURE_2D,
                                 i < count ? target[i]->name : 0, 0);
    }
    gl->DrawBuffers(count, buffers);
    gl->Viewport(0, 0, (GLsizei)target[0]->width, (GLsizei)target[0]->height);
}

static GLint find_uniform(gl_device *device, const char *name)
{
    return device->gl.GetUniformLocation(device->program[device->current], name);
}

void gl_pass_texture(gl_device *device, const char *name, const gl_texture *texture)
{
    GLint location = find_uniform(device, name);
    if (location < 0) {
        return; /* the compiler dropped it */
    }
    /* An absent texture takes a unit too: samplers of two kinds must not share one. */
    device->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)device->unit);
    device->gl.BindTexture(GL_TEXTURE_2D, 0);
    device->gl.BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    if (texture->name) {
        device->gl.BindTexture(texture->target, texture->name);
    }
    device->gl.Uniform1i(location, device->unit++);
}

void gl_pass_int(gl_device *device, const char *name, int value)
{
    device->gl.Uniform1i(find_uniform(device, name), value);
}

void gl_pass_float(gl_device *device, const char *name, float value)
{
    device->gl.Uniform1f(find_uniform(device, name), value);
}

void gl_pass_vec3(gl_device *device, const char *name, int count, const float *value)
{
    device->gl.Uniform3fv(find_uniform(device, name), count, value);
}

void gl_pass_vec4(gl_device *device, const char *name, int count, const float *value)
{
    device->gl.Uniform4fv(find_uniform(device, name), count, value);
}

void gl_pass_mat4(gl_device *device, const char *name, const float value[16])
{
    device->gl.UniformMatrix4fv(find_uniform(device, name), 1, GL_FALSE, value);
}

void gl_pass_quad(gl_device *device)
{
    device->gl.BindVertexArray(device->empty_vertex_array);
    device->gl.DrawArrays(GL_TRIANGLES, 0, 3);
}
