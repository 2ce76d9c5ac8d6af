/* gl_api.h - the OpenGL functions that the renderer uses, as a table that the application's loader
 * fills.
 *
 * Those that every pass uses are in OpenGL 3.3 core and in OpenGL ES 3.0 alike; the others serve to
 * keep state that only one of them has.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_GL_API_H
#define PARIAN_GL_API_H

#include <GL/glcorearb.h>
#include <stdbool.h>

#include "parian/env.h"
#include "parian/result.h"

#define PARIAN_GL_FUNCTIONS(X)                                                                     \
    X(PFNGLACTIVETEXTUREPROC, ActiveTexture)                                                       \
    X(PFNGLATTACHSHADERPROC, AttachShader)                                                         \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                                                             \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                                   \
    X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)                                                 \
    X(PFNGLBINDSAMPLERPROC, BindSampler)                                                           \
    X(PFNGLBINDTEXTUREPROC, BindTexture)                                                           \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                                                   \
    X(PFNGLBUFFERDATAPROC, BufferData)                                                             \
    X(PFNGLBUFFERSUBDATAPROC, BufferSubData)                                                       \
    X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)                                     \
    X(PFNGLCLEARBUFFERFVPROC, ClearBufferfv)                                                       \
    X(PFNGLCOLORMASKPROC, ColorMask)                                                               \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                                                       \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                                       \
    X(PFNGLCREATESHADERPROC, CreateShader)                                                         \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                                                       \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                                             \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                                       \
    X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)                                           \
    X(PFNGLDELETESHADERPROC, DeleteShader)                                                         \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)                                                     \
    X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                                             \
    X(PFNGLDEPTHFUNCPROC, DepthFunc)                                                               \
    X(PFNGLDEPTHMASKPROC, DepthMask)                                                               \
    X(PFNGLDISABLEPROC, Disable)                                                                   \
    X(PFNGLDRAWARRAYSPROC, DrawArrays)                                                             \
    X(PFNGLDRAWBUFFERSPROC, DrawBuffers)                                                           \
    X(PFNGLENABLEPROC, Enable)                                                                     \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray)                                   \
    X(PFNGLFINISHPROC, Finish)                                                                     \
    X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer)                                   \
    X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)                                         \
    X(PFNGLFRAMEBUFFERTEXTURELAYERPROC, FramebufferTextureLayer)                                   \
    X(PFNGLGENBUFFERSPROC, GenBuffers)                                                             \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                                                   \
    X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)                                                 \
    X(PFNGLGENTEXTURESPROC, GenTextures)                                                           \
    X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                                                   \
    X(PFNGLGETBOOLEANVPROC, GetBooleanv)                                                           \
    X(PFNGLGETERRORPROC, GetError)                                                                 \
    X(PFNGLGETFLOATVPROC, GetFloatv)                                                               \
    X(PFNGLGETINTEGERVPROC, GetIntegerv)                                                           \
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                                               \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                                         \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                                                 \
    X(PFNGLGETSHADERIVPROC, GetShaderiv)                                                           \
    X(PFNGLGETSTRINGPROC, GetString)                                                               \
    X(PFNGLGETSTRINGIPROC, GetStringi)                                                             \
    X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)                                             \
    X(PFNGLISENABLEDPROC, IsEnabled)                                                               \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                           \
    X(PFNGLPIXELSTOREIPROC, PixelStorei)                                                           \
    X(PFNGLREADBUFFERPROC, ReadBuffer)                                                             \
    X(PFNGLREADPIXELSPROC, ReadPixels)                                                             \
    X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage)                                           \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                                                         \
    X(PFNGLTEXIMAGE2DPROC, TexImage2D)                                                             \
    X(PFNGLTEXIMAGE3DPROC, TexImage3D)                                                             \
    X(PFNGLTEXPARAMETERIPROC, TexParameteri)                                                       \
    X(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)                                                       \
    X(PFNGLTEXSUBIMAGE3DPROC, TexSubImage3D)                                                       \
    X(PFNGLUNIFORM1FPROC, Uniform1f)                                                               \
    X(PFNGLUNIFORM1IPROC, Uniform1i)                                                               \
    X(PFNGLUNIFORM3FVPROC, Uniform3fv)                                                             \
    X(PFNGLUNIFORM4FVPROC, Uniform4fv)                                                             \
    X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)                                                 \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                                             \
    X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)                                           \
    X(PFNGLVIEWPORTPROC, Viewport)

/* OpenGL 3.3 core alone; OpenGL ES alone; OpenGL 3.3 core and OpenGL ES 3.2. */
#define PARIAN_GL_FUNCTIONS_CORE(X)                                                                \
    X(PFNGLCLAMPCOLORPROC, ClampColor)                                                             \
    X(PFNGLDEPTHRANGEPROC, DepthRange)                                                             \
    X(PFNGLPOLYGONMODEPROC, PolygonMode)
#define PARIAN_GL_FUNCTIONS_ES(X) X(PFNGLDEPTHRANGEFPROC, DepthRangef)
#define PARIAN_GL_FUNCTIONS_INDEXED(X)                                                             \
    X(PFNGLCOLORMASKIPROC, ColorMaski)                                                             \
    X(PFNGLDISABLEIPROC, Disablei)                                                                 \
    X(PFNGLENABLEIPROC, Enablei)                                                                   \
    X(PFNGLGETBOOLEANI_VPROC, GetBooleani_v)                                                       \
    X(PFNGLISENABLEDIPROC, IsEnabledi)

typedef struct parian_gl_api {
#define X(type, name) type name;
    PARIAN_GL_FUNCTIONS(X)
    PARIAN_GL_FUNCTIONS_CORE(X)
    PARIAN_GL_FUNCTIONS_ES(X)
    PARIAN_GL_FUNCTIONS_INDEXED(X)
#undef X
    PFNGLGETGRAPHICSRESETSTATUSPROC GetGraphicsResetStatus; /* NULL where contexts do not tell */
} parian_gl_api;

/* Errors: PARIAN_E_UNSUPPORTED names the first function that the loader does not know. */
parian_result parian_gl_api_load(const parian_env *env, void *(*get_proc_address)(const char *name),
                                 parian_gl_api *api);
/* The functions of one of the two APIs, and those for each draw buffer. Errors: as above. */
parian_result parian_gl_api_load_flavour(const parian_env *env,
                                         void *(*get_proc_address)(const char *name), bool es,
                                         bool indexed, parian_gl_api *api);

#endif
