/* gl_program.c - builds the shader programs: one body of GLSL for each pass, for OpenGL and OpenGL
 * ES alike.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "gl/gl_device.h"
#include "gl/shader_texts.h"

typedef struct program_parts {
    const char *vertex, *fragment;
    bool arrays, lights, occlusion; /* included before the fragment stage */
} program_parts;

static const program_parts parts_of[GL_PROGRAM_COUNT] = {
    [GL_PROGRAM_SHADOW] = {"caster", "shadow", false, false, false},
    [GL_PROGRAM_IRRADIANCE] = {"quad", "irradiance", true, true, true},
    [GL_PROGRAM_RESTRICT] = {"quad", "restrict", true, false, false},
    [GL_PROGRAM_SEGMENT] = {"quad", "segment", true, false, false},
    [GL_PROGRAM_ROWS] = {"quad", "rows", true, false, false},
    [GL_PROGRAM_FILTER] = {"quad", "filter", true, false, false},
    [GL_PROGRAM_GUTTER] = {"quad", "gutter", true, false, false},
    [GL_PROGRAM_BODY] = {"mesh", "body", true, true, false},
    [GL_PROGRAM_SURROUNDING] = {"mesh", "surrounding", true, true, false},
    [GL_PROGRAM_RESOLVE] = {"quad", "resolve", false, false, false},
    [GL_PROGRAM_LUMINANCE] = {"quad", "luminance", false, false, false},
    [GL_PROGRAM_TONE] = {"quad", "tone", false, false, false},
};

static const char prologue_core[] = "#version 330 core\n";
static const char prologue_es[] =
    "#version 300 es\n"
    "precision highp float;\nprecision highp int;\n"
    "precision highp sampler2D;\nprecision highp usampler2D;\n"
    "precision highp sampler2DArray;\nprecision highp usampler2DArray;\n";

static const char *find_text(const char *name)
{
    for (size_t i = 0; i < parian_shader_text_count; i++) {
        if (strcmp(parian_shader_texts[i].name, name) == 0) {
            return parian_shader_texts[i].text;
        }
    }
    return "#error the shader text is missing\n";
}

static GLuint compile(gl_device *device, GLenum stage, const program_parts *parts)
{
    const parian_gl_api *gl = &device->gl;
    bool vertex = stage == GL_VERTEX_SHADER;
    const char *texts[5] = {device->es ? prologue_es : prologue_core,
                            !vertex && parts->arrays ? find_text("arrays") : "",
                            !vertex && parts->lights ? find_text("lights") : "",
                            !vertex && parts->occlusion ? find_text("occlusion") : "",
                            find_text(vertex ? parts->vertex : parts->fragment)};
    char log[512] = "";
    GLint done = 0;
    GLuint shader = gl->CreateShader(stage);
    gl->ShaderSource(shader, 5, texts, NULL);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done) {
        gl->GetShaderInfoLog(shader, sizeof log, NULL, log);
        parian_log(device->env, PARIAN_LOG_ERROR, "shader %s does not compile: %s",
                   vertex ? parts->vertex : parts->fragment, log);
        gl->DeleteShader(shader);
        return 0;
    }
    return shader;
}

static bool build(gl_device *device, gl_program_id id)
{
    const parian_gl_api *gl = &device->gl;
    GLuint vertex = compile(device, GL_VERTEX_SHADER, &parts_of[id]);
    GLuint fragment = vertex ? compile(device, GL_FRAGMENT_SHADER, &parts_of[id]) : 0;
    GLint done = 0;
    if (vertex && fragment) {
        char log[512] = "";
        device->program[id] = gl->CreateProgram();
        gl->AttachShader(device->program[id], vertex);
        gl->AttachShader(device->program[id], fragment);
        gl->LinkProgram(device->program[id]);
        gl->GetProgramiv(device->program[id], GL_LINK_STATUS, &done);
        if (!done) {
            gl->GetProgramInfoLog(device->program[id], sizeof log, NULL, log);
            parian_log(device->env, PARIAN_LOG_ERROR, "program %s does not link: %s",
                       parts_of[id].fragment, log);
        }
    }
    if (vertex) {
        gl->DeleteShader(vertex);
    }
    if (fragment) {
        gl->DeleteShader(fragment);
    }
    return done != 0;
}

parian_result gl_programs_build(gl_device *device)
{
    for (int id = 0; id < GL_PROGRAM_COUNT; id++) {
        if (!build(device, (gl_program_id)id)) {
            return PARIAN_E_DEVICE;
        }
    }
    return PARIAN_OK;
}
