/* gl_api.c - the OpenGL functions that the renderer uses, as a table that the application's loader
 * fills.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_api.h"

#include <string.h>

#include "core/memory.h"

/* Ask for one function; leaves the calling function where there is none. */
#define LOAD(type, name)                                                                           \
    address = get_proc_address("gl" #name);                                                        \
    if (!address) {                                                                                \
        return parian_fail(env, PARIAN_E_UNSUPPORTED, "this OpenGL has no gl" #name);              \
    }                                                                                              \
    memcpy(&api->name, &address, sizeof address);

parian_result parian_gl_api_load(const parian_env *env, void *(*get_proc_address)(const char *name),
                                 parian_gl_api *api)
{
    void *address;
    if (!get_proc_address) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "the GL backend needs get_proc_address");
    }
    PARIAN_GL_FUNCTIONS(LOAD)
    return PARIAN_OK;
}

parian_result parian_gl_api_load_flavour(const parian_env *env,
                                         void *(*get_proc_address)(const char *name), bool es,
                                         bool indexed, parian_gl_api *api)
{
    void *address;
    if (es) {
        PARIAN_GL_FUNCTIONS_ES(LOAD)
    } else {
        PARIAN_GL_FUNCTIONS_CORE(LOAD)
    }
    if (indexed) {
        PARIAN_GL_FUNCTIONS_INDEXED(LOAD)
    }
    return PARIAN_OK;
}
