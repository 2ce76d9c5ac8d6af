/* gl_api.c - the OpenGL functions that the renderer uses, as a table that the application's loader
 * fills.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_api.h"

#include <string.h>

#include "core/memory.h"

parian_result parian_gl_api_load(const parian_env *env, void *(*get_proc_address)(const char *name),
                                 parian_gl_api *api)
{
    void *address;
    if (!get_proc_address) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "the GL backend needs get_proc_address");
    }
#define X(type, name)                                                                              \
    address = get_proc_address("gl" #name);                                                        \
    if (!address) {                                                                                \
        return parian_fail(env, PARIAN_E_UNSUPPORTED, "this OpenGL has no gl" #name);              \
    }                                                                                              \
    memcpy(&api->name, &address, sizeof address);
    PARIAN_GL_FUNCTIONS(X)
#undef X
    return PARIAN_OK;
}
