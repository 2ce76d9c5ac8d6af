/* egl_context.h - OpenGL and OpenGL ES contexts without a window, for tests.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_EGL_CONTEXT_H
#define PARIAN_TEST_EGL_CONTEXT_H

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct test_egl {
    EGLDisplay display;
    EGLContext context;
    bool es;
} test_egl;

/* Make a debug context current; false where this machine cannot. */
static inline bool test_egl_open(test_egl *egl, bool es)
{
    const EGLint config_wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                    es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
    const EGLint context_es[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 3,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 0,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 EGL_TRUE,
                                 EGL_NONE};
    const EGLint context_core[] = {EGL_CONTEXT_MAJOR_VERSION,
                                   3,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   3,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_CONTEXT_OPENGL_DEBUG,
                                   EGL_TRUE,
                                   EGL_NONE};
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    EGLConfig config;
    EGLint count = 0;
    egl->es = es;
    egl->context = EGL_NO_CONTEXT;
    egl->display = get_display
                       ? get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL)
                       : EGL_NO_DISPLAY;
    if (egl->display == EGL_NO_DISPLAY || !eglInitialize(egl->display, NULL, NULL) ||
        !eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API) ||
        !eglChooseConfig(egl->display, config_wanted, &config, 1, &count) || count < 1) {
        return false;
    }
    egl->context =
        eglCreateContext(egl->display, config, EGL_NO_CONTEXT, es ? context_es : context_core);
    return egl->context != EGL_NO_CONTEXT &&
           eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context);
}

/* Make it current again, after another one was. */
static inline bool test_egl_use(const test_egl *egl)
{
    return eglBindAPI(egl->es ? EGL_OPENGL_ES_API : EGL_OPENGL_API) &&
           eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context);
}

static inline void test_egl_close(test_egl *egl)
{
    if (egl->context != EGL_NO_CONTEXT) {
        eglBindAPI(egl->es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
        eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(egl->display, egl->context);
    }
}

static inline void *test_egl_address(const char *name)
{
    return (void *)eglGetProcAddress(name);
}

#endif
