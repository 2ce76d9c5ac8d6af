/* fault_gl.h - a loader of OpenGL functions that counts what is made and fails on demand.
 *
 * The functions call the real ones of the current context. One state per test program.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_FAULT_GL_H
#define PARIAN_TEST_FAULT_GL_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "gl/egl_context.h"
#include "runtime/gl/gl_api.h"

typedef struct fault_gl {
    /* Wanted faults. */
    uint64_t storage_fails_at; /* this call for storage (from 1) runs out of memory; 0: none */
    bool incomplete;           /* no framebuffer is complete */
    const char *version;       /* GL_VERSION says so, "3.2" or "OpenGL ES 3.0" */
    bool no_extensions;
    const char *missing; /* this function is not there */
    bool no_compile, no_link;
    bool lost; /* the context is */
    /* Counts. */
    uint64_t storage; /* calls for storage: textures, buffers, renderbuffers */
    uint64_t made;    /* objects ever made */
    int64_t live;     /* objects there are */
    GLenum error;
} fault_gl;

static fault_gl fault;
static parian_gl_api real;

static inline void fault_reset(void)
{
    fault = (fault_gl){.live = fault.live};
}

/* True when this call for storage fails. */
static inline bool fault_storage(void)
{
    bool fails = ++fault.storage == fault.storage_fails_at;
    if (fails) {
        fault.error = GL_OUT_OF_MEMORY;
    }
    return fails;
}

static inline void fault_count(GLsizei n, const GLuint *names, int sign)
{
    for (GLsizei i = 0; i < n; i++) {
        fault.live += names[i] ? sign : 0;
        fault.made += names[i] && sign > 0;
    }
}

#define FAULT_OBJECT(kind)                                                                         \
    static void APIENTRY fault_Gen##kind(GLsizei n, GLuint *names)                                 \
    {                                                                                              \
        real.Gen##kind(n, names);                                                                  \
        fault_count(n, names, 1);                                                                  \
    }                                                                                              \
    static void APIENTRY fault_Delete##kind(GLsizei n, const GLuint *names)                        \
    {                                                                                              \
        fault_count(n, names, -1);                                                                 \
        real.Delete##kind(n, names);                                                               \
    }
FAULT_OBJECT(Textures)
FAULT_OBJECT(Buffers)
FAULT_OBJECT(Framebuffers)
FAULT_OBJECT(Renderbuffers)
FAULT_OBJECT(VertexArrays)
#undef FAULT_OBJECT

static GLuint APIENTRY fault_CreateProgram(void)
{
    GLuint name = real.CreateProgram();
    fault_count(1, &name, 1);
    return name;
}

static void APIENTRY fault_DeleteProgram(GLuint name)
{
    fault_count(1, &name, -1);
    real.DeleteProgram(name);
}

static void APIENTRY fault_TexImage2D(GLenum target, GLint level, GLint internal, GLsizei width,
                                      GLsizei height, GLint border, GLenum format, GLenum type,
                                      const void *pixels)
{
    if (!fault_storage()) {
        real.TexImage2D(target, level, internal, width, height, border, format, type, pixels);
    }
}

static void APIENTRY fault_TexImage3D(GLenum target, GLint level, GLint internal, GLsizei width,
                                      GLsizei height, GLsizei depth, GLint border, GLenum format,
                                      GLenum type, const void *pixels)
{
    if (!fault_storage()) {
        real.TexImage3D(target, level, internal, width, height, depth, border, format, type,
                        pixels);
    }
}

static void APIENTRY fault_BufferData(GLenum target, GLsizeiptr size, const void *data,
                                      GLenum usage)
{
    if (!fault_storage()) {
        real.BufferData(target, size, data, usage);
    }
}

static void APIENTRY fault_RenderbufferStorage(GLenum target, GLenum internal, GLsizei width,
                                               GLsizei height)
{
    if (!fault_storage()) {
        real.RenderbufferStorage(target, internal, width, height);
    }
}

static GLenum APIENTRY fault_GetError(void)
{
    GLenum error = fault.error ? fault.error : real.GetError();
    fault.error = GL_NO_ERROR;
    return error;
}

static GLenum APIENTRY fault_CheckFramebufferStatus(GLenum target)
{
    return fault.incomplete ? GL_FRAMEBUFFER_UNSUPPORTED : real.CheckFramebufferStatus(target);
}

static const GLubyte *APIENTRY fault_GetString(GLenum name)
{
    return fault.version && name == GL_VERSION ? (const GLubyte *)fault.version
                                               : real.GetString(name);
}

static const GLubyte *APIENTRY fault_GetStringi(GLenum name, GLuint index)
{
    return fault.no_extensions ? (const GLubyte *)"GL_none" : real.GetStringi(name, index);
}

static void APIENTRY fault_GetIntegerv(GLenum name, GLint *value)
{
    real.GetIntegerv(name, value);
    if (fault.version && (name == GL_MAJOR_VERSION || name == GL_MINOR_VERSION)) {
        const char *digits = strpbrk(fault.version, "0123456789");
        *value = digits[name == GL_MAJOR_VERSION ? 0 : 2] - '0';
    }
}

static void APIENTRY fault_GetShaderiv(GLuint shader, GLenum name, GLint *value)
{
    real.GetShaderiv(shader, name, value);
    if (fault.no_compile && name == GL_COMPILE_STATUS) {
        *value = 0;
    }
}

static void APIENTRY fault_GetProgramiv(GLuint program, GLenum name, GLint *value)
{
    real.GetProgramiv(program, name, value);
    if (fault.no_link && name == GL_LINK_STATUS) {
        *value = 0;
    }
}

static GLenum APIENTRY fault_GetGraphicsResetStatus(void)
{
    return fault.lost ? GL_GUILTY_CONTEXT_RESET : GL_NO_ERROR;
}

/* The loader. */
static void *fault_address(const char *name)
{
    static const struct {
        const char *name;
        void (*function)(void);
        size_t place;
    } wrapped[] = {
#define FAULT_ENTRY(function)                                                                      \
    {"gl" #function, (void (*)(void))fault_##function, offsetof(parian_gl_api, function)}
        FAULT_ENTRY(GenTextures),      FAULT_ENTRY(DeleteTextures),
        FAULT_ENTRY(GenBuffers),       FAULT_ENTRY(DeleteBuffers),
        FAULT_ENTRY(GenFramebuffers),  FAULT_ENTRY(DeleteFramebuffers),
        FAULT_ENTRY(GenRenderbuffers), FAULT_ENTRY(DeleteRenderbuffers),
        FAULT_ENTRY(GenVertexArrays),  FAULT_ENTRY(DeleteVertexArrays),
        FAULT_ENTRY(CreateProgram),    FAULT_ENTRY(DeleteProgram),
        FAULT_ENTRY(TexImage2D),       FAULT_ENTRY(TexImage3D),
        FAULT_ENTRY(BufferData),       FAULT_ENTRY(RenderbufferStorage),
        FAULT_ENTRY(GetError),         FAULT_ENTRY(CheckFramebufferStatus),
        FAULT_ENTRY(GetString),        FAULT_ENTRY(GetStringi),
        FAULT_ENTRY(GetIntegerv),      FAULT_ENTRY(GetShaderiv),
        FAULT_ENTRY(GetProgramiv),     FAULT_ENTRY(GetGraphicsResetStatus),
#undef FAULT_ENTRY
    };
    void *address = test_egl_address(name);
    if (fault.missing && strcmp(name, fault.missing) == 0) {
        return NULL;
    }
    for (size_t i = 0; i < sizeof wrapped / sizeof *wrapped; i++) {
        if (strcmp(name, wrapped[i].name) == 0 && address) {
            memcpy((char *)&real + wrapped[i].place, &address, sizeof address);
            memcpy(&address, &wrapped[i].function, sizeof address);
        }
    }
    return address;
}

#endif
