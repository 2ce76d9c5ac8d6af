/* test_gl_state.c - what the application had set in its context is set again after every call, and
 * does not change results.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/egl_context.h"
#include "runtime/gl/gl_api.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"

enum { SIDE = 48, UNITS = 16, STATE_MAX = 512 };

/* The application's objects. */
typedef struct host_objects {
    GLuint framebuffer[2], renderbuffer, buffer[3], vertex_array, texture[2 * UNITS],
        sampler[UNITS], program;
} host_objects;

typedef struct gl_host {
    parian_gl_api gl;
    bool es;
    host_objects made;
} gl_host;

/* ---- odd values for everything ---- */

static GLuint compile(const parian_gl_api *gl, GLenum stage, bool es, const char *body)
{
    const char *texts[2] = {
        es ? "#version 300 es\nprecision highp float;\n" : "#version 330 core\n", body};
    GLuint shader = gl->CreateShader(stage);
    gl->ShaderSource(shader, 2, texts, NULL);
    gl->CompileShader(shader);
    return shader;
}

static void make_program(gl_host *host)
{
    const parian_gl_api *gl = &host->gl;
    host->made.program = gl->CreateProgram();
    gl->AttachShader(host->made.program,
                     compile(gl, GL_VERTEX_SHADER, host->es, "void main(){gl_Position=vec4(0);}"));
    gl->AttachShader(host->made.program, compile(gl, GL_FRAGMENT_SHADER, host->es,
                                                 "out vec4 o;void main(){o=vec4(1);}"));
    gl->LinkProgram(host->made.program);
    gl->UseProgram(host->made.program);
}

static void *address_of(const char *name)
{
    void *address = test_egl_address(name);
    assert_non_null(address);
    return address;
}

static void bind_textures(gl_host *host)
{
    const parian_gl_api *gl = &host->gl;
    void (*gen_samplers)(GLsizei, GLuint *) = NULL;
    void *address = address_of("glGenSamplers");
    memcpy(&gen_samplers, &address, sizeof address);
    gl->GenTextures(2 * UNITS, host->made.texture);
    gen_samplers(UNITS, host->made.sampler);
    for (int u = 0; u < UNITS; u++) {
        gl->ActiveTexture(GL_TEXTURE0 + (GLenum)u);
        gl->BindTexture(GL_TEXTURE_2D, host->made.texture[2 * u]);
        gl->BindTexture(GL_TEXTURE_2D_ARRAY, host->made.texture[2 * u + 1]);
        gl->BindSampler((GLuint)u, host->made.sampler[u]);
    }
    gl->ActiveTexture(GL_TEXTURE0 + 11);
}

static void bind_objects(gl_host *host)
{
    const parian_gl_api *gl = &host->gl;
    host_objects *made = &host->made;
    gl->GenFramebuffers(2, made->framebuffer);
    gl->GenRenderbuffers(1, &made->renderbuffer);
    gl->GenBuffers(3, made->buffer);
    gl->GenVertexArrays(1, &made->vertex_array);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, made->framebuffer[0]);
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, made->framebuffer[1]);
    gl->BindRenderbuffer(GL_RENDERBUFFER, made->renderbuffer);
    gl->BindVertexArray(made->vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, made->buffer[0]);
    gl->BindBuffer(GL_PIXEL_PACK_BUFFER, made->buffer[1]);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, made->buffer[2]);
    bind_textures(host);
    make_program(host);
}

static const GLenum odd_enables[] = {GL_DEPTH_TEST,
                                     GL_CULL_FACE,
                                     GL_SCISSOR_TEST,
                                     GL_STENCIL_TEST,
                                     GL_RASTERIZER_DISCARD,
                                     GL_POLYGON_OFFSET_FILL,
                                     GL_SAMPLE_COVERAGE,
                                     GL_SAMPLE_ALPHA_TO_COVERAGE,
                                     GL_BLEND,
                                     GL_FRAMEBUFFER_SRGB,
                                     GL_DEPTH_CLAMP,
                                     GL_COLOR_LOGIC_OP,
                                     GL_POLYGON_SMOOTH,
                                     GL_SAMPLE_MASK,
                                     GL_PRIMITIVE_RESTART,
                                     GL_CLIP_DISTANCE0,
                                     GL_CLIP_DISTANCE0 + 7};
enum { ODD_ENABLES = sizeof odd_enables / sizeof *odd_enables, ODD_ENABLES_ES = 9 };

static const GLenum odd_storage[][2] = {
    {GL_PACK_ALIGNMENT, 8},     {GL_PACK_ROW_LENGTH, 7},    {GL_PACK_SKIP_ROWS, 3},
    {GL_PACK_SKIP_PIXELS, 2},   {GL_UNPACK_ALIGNMENT, 2},   {GL_UNPACK_ROW_LENGTH, 5},
    {GL_UNPACK_SKIP_ROWS, 1},   {GL_UNPACK_SKIP_PIXELS, 4}, {GL_UNPACK_IMAGE_HEIGHT, 9},
    {GL_UNPACK_SKIP_IMAGES, 2}, {GL_PACK_SWAP_BYTES, 1},    {GL_UNPACK_SWAP_BYTES, 1}};
enum { ODD_STORAGE = sizeof odd_storage / sizeof *odd_storage, ODD_STORAGE_ES = 10 };

/* Would ruin every pass if it were left alone. */
static void set_odd(gl_host *host)
{
    const parian_gl_api *gl = &host->gl;
    bind_objects(host);
    for (int i = 0; i < (host->es ? ODD_ENABLES_ES : ODD_ENABLES); i++) {
        gl->Enable(odd_enables[i]);
    }
    gl->Disable(GL_DITHER);
    for (int i = 0; i < (host->es ? ODD_STORAGE_ES : ODD_STORAGE); i++) {
        gl->PixelStorei(odd_storage[i][0], (GLint)odd_storage[i][1]);
    }
    gl->Viewport(3, 4, 5, 6);
    gl->DepthFunc(GL_NEVER);
    gl->DepthMask(GL_FALSE);
    gl->ColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    if (host->es) {
        gl->DepthRangef(0.75f, 0.25f);
    } else {
        gl->DepthRange(0.75, 0.25);
        gl->PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
        gl->ClampColor(GL_CLAMP_READ_COLOR, GL_TRUE);
        gl->Disablei(GL_BLEND, 2);
        gl->ColorMaski(1, GL_TRUE, GL_FALSE, GL_TRUE, GL_TRUE);
    }
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
}

static void delete_objects(gl_host *host)
{
    const parian_gl_api *gl = &host->gl;
    host_objects *made = &host->made;
    void (*delete_samplers)(GLsizei, const GLuint *) = NULL;
    void *address = address_of("glDeleteSamplers");
    memcpy(&delete_samplers, &address, sizeof address);
    gl->DeleteFramebuffers(2, made->framebuffer);
    gl->DeleteRenderbuffers(1, &made->renderbuffer);
    gl->DeleteBuffers(3, made->buffer);
    gl->DeleteVertexArrays(1, &made->vertex_array);
    gl->DeleteTextures(2 * UNITS, made->texture);
    delete_samplers(UNITS, made->sampler);
    gl->UseProgram(0);
    gl->DeleteProgram(made->program);
}

/* ---- everything that can be asked ---- */

/* name, number of values, 1 where OpenGL ES 3.0 has it too */
static const struct {
    GLenum name;
    int count;
    bool es;
} asked[] = {
    {GL_DRAW_FRAMEBUFFER_BINDING, 1, true},
    {GL_READ_FRAMEBUFFER_BINDING, 1, true},
    {GL_RENDERBUFFER_BINDING, 1, true},
    {GL_VIEWPORT, 4, true},
    {GL_SCISSOR_BOX, 4, true},
    {GL_CURRENT_PROGRAM, 1, true},
    {GL_VERTEX_ARRAY_BINDING, 1, true},
    {GL_ARRAY_BUFFER_BINDING, 1, true},
    {GL_ELEMENT_ARRAY_BUFFER_BINDING, 1, true},
    {GL_PIXEL_PACK_BUFFER_BINDING, 1, true},
    {GL_PIXEL_UNPACK_BUFFER_BINDING, 1, true},
    {GL_UNIFORM_BUFFER_BINDING, 1, true},
    {GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, 1, true},
    {GL_ACTIVE_TEXTURE, 1, true},
    {GL_DEPTH_FUNC, 1, true},
    {GL_DEPTH_WRITEMASK, 1, true},
    {GL_COLOR_WRITEMASK, 4, true},
    {GL_STENCIL_FUNC, 1, true},
    {GL_STENCIL_REF, 1, true},
    {GL_STENCIL_WRITEMASK, 1, true},
    {GL_STENCIL_CLEAR_VALUE, 1, true},
    {GL_BLEND_SRC_RGB, 1, true},
    {GL_BLEND_DST_ALPHA, 1, true},
    {GL_BLEND_EQUATION_RGB, 1, true},
    {GL_CULL_FACE_MODE, 1, true},
    {GL_FRONT_FACE, 1, true},
    {GL_PACK_ALIGNMENT, 1, true},
    {GL_PACK_ROW_LENGTH, 1, true},
    {GL_PACK_SKIP_ROWS, 1, true},
    {GL_PACK_SKIP_PIXELS, 1, true},
    {GL_UNPACK_ALIGNMENT, 1, true},
    {GL_UNPACK_ROW_LENGTH, 1, true},
    {GL_UNPACK_SKIP_ROWS, 1, true},
    {GL_UNPACK_SKIP_PIXELS, 1, true},
    {GL_UNPACK_IMAGE_HEIGHT, 1, true},
    {GL_UNPACK_SKIP_IMAGES, 1, true},
    {GL_PACK_SWAP_BYTES, 1, false},
    {GL_UNPACK_SWAP_BYTES, 1, false},
    {GL_POLYGON_MODE, 1, false},
    {GL_CLAMP_READ_COLOR, 1, false},
    {GL_LOGIC_OP_MODE, 1, false},
    {GL_PROVOKING_VERTEX, 1, false},
};

typedef struct gl_snapshot {
    int count;
    GLint value[STATE_MAX];
} gl_snapshot;

static void note(gl_snapshot *snapshot, GLint value)
{
    assert_true(snapshot->count < STATE_MAX);
    snapshot->value[snapshot->count++] = value;
}

static void note_units(const gl_host *host, gl_snapshot *snapshot)
{
    static const GLenum bindings[] = {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_2D_ARRAY,
                                      GL_TEXTURE_BINDING_3D, GL_TEXTURE_BINDING_CUBE_MAP,
                                      GL_SAMPLER_BINDING};
    GLint active = 0, found = 0;
    host->gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (int u = 0; u < UNITS; u++) {
        host->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)u);
        for (size_t b = 0; b < sizeof bindings / sizeof *bindings; b++) {
            host->gl.GetIntegerv(bindings[b], &found);
            note(snapshot, found);
        }
    }
    host->gl.ActiveTexture((GLenum)active);
}

static gl_snapshot take_snapshot(const gl_host *host)
{
    const parian_gl_api *gl = &host->gl;
    gl_snapshot made = {0};
    GLfloat range[2];
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        GLint found[8] = {0};
        if (!host->es || asked[i].es) {
            gl->GetIntegerv(asked[i].name, found);
        }
        for (int k = 0; k < asked[i].count; k++) {
            note(&made, found[k]);
        }
    }
    for (int i = 0; i < (host->es ? ODD_ENABLES_ES : ODD_ENABLES); i++) {
        note(&made, gl->IsEnabled(odd_enables[i]));
    }
    note(&made, gl->IsEnabled(GL_DITHER));
    gl->GetFloatv(GL_DEPTH_RANGE, range);
    note(&made, (GLint)(1000.0f * range[0]));
    note(&made, (GLint)(1000.0f * range[1]));
    for (GLuint b = 0; !host->es && b < 4; b++) {
        GLboolean mask[4];
        gl->GetBooleani_v(GL_COLOR_WRITEMASK, b, mask);
        for (int c = 0; c < 4; c++) {
            note(&made, mask[c]);
        }
        note(&made, gl->IsEnabledi(GL_BLEND, b));
    }
    note_units(host, &made);
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
    return made;
}

static void expect_kept(const gl_host *host, const gl_snapshot *before)
{
    gl_snapshot after = take_snapshot(host);
    assert_int_equal(after.count, before->count);
    for (int i = 0; i < after.count; i++) {
        if (after.value[i] != before->value[i]) {
            fail_msg("value %d of the state: found %d, expected %d", i, after.value[i],
                     before->value[i]);
        }
    }
}

/* ---- the tests ---- */

static gl_host open_host(bool es)
{
    gl_host host = {.es = es};
    assert_int_equal(parian_gl_api_load(NULL, test_egl_address, &host.gl), PARIAN_OK);
    assert_int_equal(parian_gl_api_load_flavour(NULL, test_egl_address, es, !es, &host.gl),
                     PARIAN_OK);
    return host;
}

static parian_scene *tiny_scene(const parian_env *env)
{
    parian_scene_data data = {0};
    parian_scene *scene = NULL;
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_F16, 24, &data), PARIAN_OK);
    assert_int_equal(parian_scene_adopt(env, &data, &scene), PARIAN_OK);
    return scene;
}

typedef struct outcome {
    float radiance[SIDE * SIDE][4];
    uint8_t srgb[SIDE * SIDE][4];
    float radiosity[8192][3];
} outcome;

/* Every call once; with a host, its state is checked after each. */
static void run_everything(const parian_env *env, const parian_scene *scene, const gl_host *host,
                           outcome *out)
{
    const parian_light lights[2] = {
        {.type = PARIAN_LIGHT_POINT,
         .position = {0.01f, 0.03f, 0.06f},
         .color = {.01f, .02f, .01f}},
        {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {0.3f, 0.4f, 0.5f}}};
    const parian_instance pair[2] = {
        {{0}}, {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.01f, 0.01f, -0.02f, 1}}};
    const float eye[3] = {0.05f, 0.06f, 0.12f};
    const parian_draw_desc draw = {.camera = lit_camera(eye, SIDE, SIDE),
                                   .width = SIDE,
                                   .height = SIDE,
                                   .exposure_auto = true,
                                   .framebuffer = UINT32_MAX};
    const parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 256};
    const gl_snapshot none = {0}, before = host ? take_snapshot(host) : none;
    parian_texel_arrays arrays = {.instance = 1, .radiosity = out->radiosity};
    parian_renderer *renderer = NULL;
#define STEP(call)                                                                                 \
    assert_int_equal(call, PARIAN_OK);                                                             \
    if (host) {                                                                                    \
        expect_kept(host, &before);                                                                \
    }
    assert_true(scene->info.texel_count <= 8192);
    STEP(parian_renderer_create(env, scene, &desc, &renderer))
    STEP(parian_renderer_set_lights(renderer, lights, 2))
    STEP(parian_renderer_set_instances(renderer, pair, 2))
    STEP(parian_renderer_relight(renderer))
    STEP(parian_renderer_draw(renderer, &draw))
    STEP(parian_renderer_read_picture(renderer, out->radiance, out->srgb))
    STEP(parian_renderer_read_texels(renderer, &arrays))
    STEP(parian_renderer_set_instances(renderer, pair, 1))
#undef STEP
    parian_renderer_destroy(renderer);
    if (host) {
        expect_kept(host, &before);
    }
}

static void test_kept(void **state)
{
    static outcome plain, odd;
    const parian_env *env = test_env(0);
    gl_host host = open_host(*(const bool *)*state);
    parian_scene *scene = tiny_scene(env);
    run_everything(env, scene, NULL, &plain);
    set_odd(&host);
    run_everything(env, scene, &host, &odd);
    assert_memory_equal(&plain, &odd, sizeof plain);
    assert_true(plain.radiance[SIDE * SIDE / 2 + SIDE / 2][3] > 0.0f);
    delete_objects(&host);
    parian_scene_close(scene);
}

/* An error of the application is not taken for ours. */
static void test_pending_error(void **state)
{
    const parian_env *env = test_env(0);
    gl_host host = open_host(*(const bool *)*state);
    parian_scene *scene = tiny_scene(env);
    const parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 256};
    parian_renderer *renderer = NULL;
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_OK);
    host.gl.Enable(0xFFFF);
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    assert_int_equal(host.gl.GetError(), GL_NO_ERROR);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
}

static int run_flavour(bool es)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(test_pending_error, &es),
                                       cmocka_unit_test_prestate(test_kept, &es)};
    test_egl egl;
    if (!test_egl_open(&egl, es)) {
        return -1;
    }
    int failed =
        cmocka_run_group_tests_name(es ? "OpenGL ES 3.0" : "OpenGL 3.3", tests, NULL, NULL);
    test_egl_close(&egl);
    return failed;
}

int main(void)
{
    int core = run_flavour(false), es = run_flavour(true);
    if (core < 0 && es < 0) {
        return 77; /* no EGL without a surface here */
    }
    return (core > 0 ? core : 0) + (es > 0 ? es : 0);
}
