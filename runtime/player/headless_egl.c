/* headless_egl.c - an OpenGL context without a window, through EGL.
 *
 * SPDX-License-Identifier: MIT
 */
#include "headless_egl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <string.h>

#include "core/memory.h"

enum { DEVICES_MAX = 16 };

struct parian_headless {
    EGLDisplay display;
    EGLSurface surface; /* a pixel buffer where contexts need one, else EGL_NO_SURFACE */
    EGLContext context;
    const char *api;
};

static bool has_extension(const char *list, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = list; at && (at = strstr(at, name)) != NULL; at += length) {
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0')) {
            return true;
        }
    }
    return false;
}

static EGLContext create_context(EGLDisplay display, EGLConfig config, bool core)
{
    static const EGLint core_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                             3,
                                             EGL_CONTEXT_MINOR_VERSION,
                                             3,
                                             EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                             EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                             EGL_NONE};
    static const EGLint es_attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION,
                                           0, EGL_NONE};
    return eglCreateContext(display, config, EGL_NO_CONTEXT,
                            core ? core_attributes : es_attributes);
}

/* A context of one API on an initialised display; false leaves nothing behind. */
static bool try_api(parian_headless *headless, bool core, bool surfaceless)
{
    const EGLint wanted[] = {EGL_SURFACE_TYPE, surfaceless ? 0 : EGL_PBUFFER_BIT,
                             EGL_RENDERABLE_TYPE, core ? EGL_OPENGL_BIT : EGL_OPENGL_ES3_BIT,
                             EGL_NONE};
    static const EGLint buffer[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    EGLConfig config;
    EGLint count = 0;
    EGLDisplay display = headless->display;
    headless->context = EGL_NO_CONTEXT;
    headless->surface = EGL_NO_SURFACE;
    if (!eglBindAPI(core ? EGL_OPENGL_API : EGL_OPENGL_ES_API) ||
        !eglChooseConfig(display, wanted, &config, 1, &count) || count < 1) {
        return false;
    }
    headless->context = create_context(display, config, core);
    if (headless->context == EGL_NO_CONTEXT) {
        return false;
    }
    if (!surfaceless) {
        headless->surface = eglCreatePbufferSurface(display, config, buffer);
    }
    if (eglMakeCurrent(display, headless->surface, headless->surface, headless->context)) {
        headless->api = core ? "core" : "es";
        return true;
    }
    if (headless->surface != EGL_NO_SURFACE) {
        eglDestroySurface(display, headless->surface);
    }
    eglDestroyContext(display, headless->context);
    return false;
}

static bool try_display(parian_headless *headless, EGLDisplay display, parian_view_gl api)
{
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL)) {
        return false;
    }
    headless->display = display;
    const bool surfaceless =
        has_extension(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context");
    if ((api != PARIAN_VIEW_GL_ES && try_api(headless, true, surfaceless)) ||
        (api != PARIAN_VIEW_GL_CORE && try_api(headless, false, surfaceless))) {
        return true;
    }
    eglTerminate(display);
    return false;
}

/* Graphics processors first, as EGL lists them. */
static bool try_devices(parian_headless *headless, const char *extensions, parian_view_gl api)
{
    EGLDeviceEXT devices[DEVICES_MAX];
    EGLint count = 0;
    PFNEGLQUERYDEVICESEXTPROC query =
        (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    PFNEGLGETPLATFORMDISPLAYEXTPROC get =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    if (!has_extension(extensions, "EGL_EXT_platform_device") || !query || !get ||
        !query(DEVICES_MAX, devices, &count)) {
        return false;
    }
    for (EGLint i = 0; i < count; i++) {
        if (try_display(headless, get(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL), api)) {
            return true;
        }
    }
    return false;
}

static bool try_surfaceless(parian_headless *headless, const char *extensions, parian_view_gl api)
{
    PFNEGLGETPLATFORMDISPLAYEXTPROC get =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    return has_extension(extensions, "EGL_MESA_platform_surfaceless") && get &&
           try_display(headless, get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL),
                       api);
}

parian_result parian_headless_create(const parian_env *env, parian_view_gl api,
                                     parian_headless **out)
{
    parian_headless *headless = parian_zalloc(env, 1, sizeof *headless);
    if (!headless) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for an OpenGL context");
    }
    const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (try_devices(headless, extensions, api) || try_surfaceless(headless, extensions, api) ||
        try_display(headless, eglGetDisplay(EGL_DEFAULT_DISPLAY), api)) {
        *out = headless;
        return PARIAN_OK;
    }
    parian_free(env, headless);
    return parian_fail(
        env, PARIAN_E_DEVICE,
        "EGL gives no %s context on any device, surfaceless, or on the default display; "
        "--cpu evaluates in C",
        api == PARIAN_VIEW_GL_CORE ? "OpenGL 3.3 core"
        : api == PARIAN_VIEW_GL_ES ? "OpenGL ES 3.0"
                                   : "OpenGL 3.3 core or OpenGL ES 3.0");
}

void parian_headless_destroy(const parian_env *env, parian_headless *headless)
{
    if (!headless) {
        return;
    }
    eglMakeCurrent(headless->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (headless->surface != EGL_NO_SURFACE) {
        eglDestroySurface(headless->display, headless->surface);
    }
    eglDestroyContext(headless->display, headless->context);
    eglTerminate(headless->display);
    eglReleaseThread();
    parian_free(env, headless);
}

const char *parian_headless_api(const parian_headless *headless)
{
    return headless->api;
}

void *parian_headless_proc_address(const char *name)
{
    return (void *)eglGetProcAddress(name);
}
