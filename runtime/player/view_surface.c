/* view_surface.c - a picture that stays on the GPU between frames.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_surface.h"

#include <GL/glcorearb.h>
#include <string.h>

#include "core/memory.h"

#define SURFACE_FUNCTIONS(X)                                                                       \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                                                   \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                                             \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                                   \
    X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)                                         \
    X(PFNGLGENTEXTURESPROC, GenTextures)                                                           \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)                                                     \
    X(PFNGLBINDTEXTUREPROC, BindTexture)                                                           \
    X(PFNGLTEXIMAGE2DPROC, TexImage2D)                                                             \
    X(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)                                                       \
    X(PFNGLTEXPARAMETERIPROC, TexParameteri)                                                       \
    X(PFNGLBLITFRAMEBUFFERPROC, BlitFramebuffer)                                                   \
    X(PFNGLREADPIXELSPROC, ReadPixels)                                                             \
    X(PFNGLVIEWPORTPROC, Viewport)                                                                 \
    X(PFNGLCLEARBUFFERFVPROC, ClearBufferfv)

struct parian_view_surface {
    const parian_env *env;
#define X(type, name) type name;
    SURFACE_FUNCTIONS(X)
#undef X
    GLuint framebuffer, texture;
    uint32_t width, height;
};

static parian_result load_functions(parian_view_surface *surface,
                                    void *(*get_proc_address)(const char *name))
{
    void *address;
#define X(type, name)                                                                              \
    address = get_proc_address("gl" #name);                                                        \
    if (!address) {                                                                                \
        return parian_fail(surface->env, PARIAN_E_UNSUPPORTED, "this OpenGL has no gl" #name);     \
    }                                                                                              \
    memcpy(&surface->name, &address, sizeof surface->name);
    SURFACE_FUNCTIONS(X)
#undef X
    return PARIAN_OK;
}

parian_result parian_view_surface_create(const parian_env *env,
                                         void *(*get_proc_address)(const char *name),
                                         parian_view_surface **out)
{
    parian_view_surface *surface;
    if (!PARIAN_NEW0(env, surface, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the window's picture");
    }
    surface->env = env;
    parian_result result = load_functions(surface, get_proc_address);
    if (result != PARIAN_OK) {
        parian_free(env, surface);
        return result;
    }
    surface->GenFramebuffers(1, &surface->framebuffer);
    surface->GenTextures(1, &surface->texture);
    *out = surface;
    return PARIAN_OK;
}

void parian_view_surface_destroy(parian_view_surface *surface)
{
    if (surface) {
        surface->DeleteFramebuffers(1, &surface->framebuffer);
        surface->DeleteTextures(1, &surface->texture);
        parian_free(surface->env, surface);
    }
}

void parian_view_surface_resize(parian_view_surface *surface, uint32_t width, uint32_t height)
{
    if (surface->width == width && surface->height == height) {
        return;
    }
    surface->width = width;
    surface->height = height;
    surface->BindTexture(GL_TEXTURE_2D, surface->texture);
    surface->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    surface->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    surface->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    surface->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)width, (GLsizei)height, 0, GL_RGBA,
                        GL_UNSIGNED_BYTE, NULL);
    surface->BindTexture(GL_TEXTURE_2D, 0);
    surface->BindFramebuffer(GL_FRAMEBUFFER, surface->framebuffer);
    surface->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                                  surface->texture, 0);
    surface->BindFramebuffer(GL_FRAMEBUFFER, 0);
}

uint32_t parian_view_surface_framebuffer(const parian_view_surface *surface)
{
    return surface->framebuffer;
}

/* Rows the other way round: GL starts below. */
static void flip(const uint8_t (*from)[4], uint32_t width, uint32_t height, uint8_t (*to)[4])
{
    for (uint32_t y = 0; y < height; y++) {
        memcpy(to[(size_t)y * width], from[(size_t)(height - 1 - y) * width], width * sizeof *to);
    }
}

parian_result parian_view_surface_upload(parian_view_surface *surface, const uint8_t (*srgb)[4])
{
    uint8_t(*rows)[4];
    if (!PARIAN_NEW(surface->env, rows, (size_t)surface->width * surface->height)) {
        return parian_fail(surface->env, PARIAN_E_NOMEM, "no memory for the window's picture");
    }
    flip(srgb, surface->width, surface->height, rows);
    surface->BindTexture(GL_TEXTURE_2D, surface->texture);
    surface->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)surface->width,
                           (GLsizei)surface->height, GL_RGBA, GL_UNSIGNED_BYTE, rows);
    surface->BindTexture(GL_TEXTURE_2D, 0);
    parian_free(surface->env, rows);
    return PARIAN_OK;
}

void parian_view_surface_show(const parian_view_surface *surface, uint32_t x, uint32_t width,
                              uint32_t height)
{
    static const GLfloat grey[4] = {0.06f, 0.06f, 0.06f, 1};
    const GLint left = (GLint)x, right = (GLint)width, top = (GLint)height;
    surface->BindFramebuffer(GL_FRAMEBUFFER, 0);
    surface->Viewport(0, 0, right, top);
    surface->ClearBufferfv(GL_COLOR, 0, grey);
    if (surface->width == 0) {
        return;
    }
    surface->BindFramebuffer(GL_READ_FRAMEBUFFER, surface->framebuffer);
    surface->BlitFramebuffer(0, 0, (GLint)surface->width, (GLint)surface->height, left, 0, right,
                             top, GL_COLOR_BUFFER_BIT,
                             surface->width + x == width ? GL_NEAREST : GL_LINEAR);
    surface->BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
}

parian_result parian_view_surface_read_window(const parian_view_surface *surface, uint32_t width,
                                              uint32_t height, uint8_t (*srgb)[4])
{
    uint8_t(*rows)[4];
    if (!PARIAN_NEW(surface->env, rows, (size_t)width * height)) {
        return parian_fail(surface->env, PARIAN_E_NOMEM, "no memory for a picture of %u x %u",
                           width, height);
    }
    surface->BindFramebuffer(GL_FRAMEBUFFER, 0);
    surface->ReadPixels(0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA, GL_UNSIGNED_BYTE, rows);
    flip((const uint8_t(*)[4])rows, width, height, srgb);
    parian_free(surface->env, rows);
    return PARIAN_OK;
}
