/* test_gl_handout.c - textures and arrays handed to a host that shades bodies with programs of its
 * own.
 *
 * Texels through a foreign program are those of read_texels, bit for bit: both come from the same
 * passes, and the sum of two floats is the same everywhere. The host's picture is compared with the
 * renderer's to 0.3 % of the mean: the same formula, but filtered by the hardware (8 bits of the
 * position between texels are usual).
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/egl_context.h"
#include "runtime/gl/gl_api.h"
#include "runtime/renderer_internal.h"
#include "runtime/shade/view.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"

enum { SIDE = 64 };

typedef struct gl_host {
    parian_gl_api gl;
    bool es, filters; /* floats */
    parian_scene *scene;
    parian_renderer *renderer;
    parian_draw_desc draw;
} gl_host;

static const char quad_vertex[] =
    "void main() { gl_Position = vec4(float(gl_VertexID & 1) * 4.0 - 1.0,\n"
    "                                 float(gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }\n";
static const char copy_fragment[] =
    "uniform sampler2D u_map;\n"
    "out vec4 o_color;\n"
    "void main() { o_color = texelFetch(u_map, ivec2(gl_FragCoord.xy), 0); }\n";
static const char mesh_vertex[] =
    "layout(location = 0) in vec3 a_position;\n"
    "layout(location = 1) in vec3 a_normal;\n"
    "layout(location = 2) in vec2 a_uv;\n"
    "uniform mat4 u_model, u_view_projection;\n"
    "out vec3 v_position, v_normal;\n"
    "out vec2 v_uv;\n"
    "void main() {\n"
    "    vec4 p = u_model * vec4(a_position, 1.0);\n"
    "    v_position = p.xyz; v_normal = mat3(u_model) * a_normal; v_uv = a_uv;\n"
    "    gl_Position = u_view_projection * p;\n"
    "}\n";
static const char mesh_fragment[] =
    "in vec3 v_position, v_normal;\n"
    "in vec2 v_uv;\n"
    "uniform sampler2D u_radiosity, u_albedo;\n"
    "uniform float u_eta, u_exit_norm;\n"
    "uniform vec3 u_tint;\n"
    "uniform vec3 u_eye;\n"
    "out vec4 o_color;\n"
    "float transmit(float c, float eta) {\n"
    "    float g = sqrt(eta * eta - 1.0 + c * c);\n"
    "    float a = (g - c) / (g + c), b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);\n"
    "    return 1.0 - 0.5 * a * a * (1.0 + b * b);\n"
    "}\n"
    "vec3 look_up(sampler2D map, vec2 uv) { vec4 v = texture(map, uv); return v.rgb / max(v.a, "
    "1e-6); }\n"
    "void main() {\n"
    "    vec3 n = normalize(v_normal), v = normalize(u_eye - v_position);\n"
    "    float c = max(dot(n, v), 1e-3);\n"
    "    vec3 radiance = transmit(c, u_eta) * look_up(u_radiosity, v_uv) * look_up(u_albedo, "
    "v_uv);\n"
    "    o_color = vec4(radiance * u_tint / (3.14159265 * u_exit_norm), 1.0);\n"
    "}\n";

static GLuint build(const gl_host *host, const char *vertex, const char *fragment)
{
    const parian_gl_api *gl = &host->gl;
    const char *stages[2] = {vertex, fragment};
    const char *head = host->es
                           ? "#version 300 es\nprecision highp float;\nprecision highp sampler2D;\n"
                           : "#version 330 core\n";
    GLuint program = gl->CreateProgram();
    GLint linked = 0;
    for (int s = 0; s < 2; s++) {
        const char *texts[2] = {head, stages[s]};
        GLuint shader = gl->CreateShader(s ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        gl->ShaderSource(shader, 2, texts, NULL);
        gl->CompileShader(shader);
        gl->AttachShader(program, shader);
        gl->DeleteShader(shader);
    }
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    assert_int_equal(linked, GL_TRUE);
    gl->UseProgram(program);
    return program;
}

/* A float target of the host, bound. */
typedef struct host_target {
    GLuint framebuffer, color, depth;
} host_target;

static host_target make_target(const gl_host *host, GLsizei side)
{
    const parian_gl_api *gl = &host->gl;
    host_target made;
    gl->GenFramebuffers(1, &made.framebuffer);
    gl->GenTextures(1, &made.color);
    gl->GenRenderbuffers(1, &made.depth);
    gl->BindTexture(GL_TEXTURE_2D, made.color);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, side, side, 0, GL_RGBA, GL_FLOAT, NULL);
    gl->BindRenderbuffer(GL_RENDERBUFFER, made.depth);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, side, side);
    gl->BindFramebuffer(GL_FRAMEBUFFER, made.framebuffer);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, made.color, 0);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, made.depth);
    assert_int_equal(gl->CheckFramebufferStatus(GL_FRAMEBUFFER), GL_FRAMEBUFFER_COMPLETE);
    gl->Viewport(0, 0, side, side);
    return made;
}

static void drop_target(const gl_host *host, host_target *target)
{
    host->gl.DeleteFramebuffers(1, &target->framebuffer);
    host->gl.DeleteTextures(1, &target->color);
    host->gl.DeleteRenderbuffers(1, &target->depth);
}

/* ---- texels ---- */

/* A texture through the host's program: [size * size]. */
static float (*copy_texture(const gl_host *host, GLuint name, uint32_t size))[4]
{
    const parian_gl_api *gl = &host->gl;
    float(*pixels)[4] = parian_alloc(test_env(0), (size_t)size * size, sizeof *pixels);
    GLuint vertex_array, program = build(host, quad_vertex, copy_fragment);
    host_target target = make_target(host, (GLsizei)size);
    gl->GenVertexArrays(1, &vertex_array);
    gl->BindVertexArray(vertex_array);
    gl->BindTexture(GL_TEXTURE_2D, name);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->ReadPixels(0, 0, (GLsizei)size, (GLsizei)size, GL_RGBA, GL_FLOAT, pixels);
    drop_target(host, &target);
    gl->DeleteVertexArrays(1, &vertex_array);
    gl->DeleteProgram(program); /* while it is current: the renderer must not stumble over it */
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
    return pixels;
}

static void expect_texels(const gl_host *host, GLuint name, const parian_body *body,
                          const float (*want)[3], uint32_t gutter_min)
{
    float(*pixels)[4] = copy_texture(host, name, body->atlas_size);
    uint32_t covered = 0;
    for (uint32_t t = 0; t < body->texel_count; t++) {
        assert_memory_equal(pixels[body->texel_index[t]], want[t], sizeof want[t]);
        assert_true(pixels[body->texel_index[t]][3] == 1.0f);
    }
    for (uint32_t i = 0; i < body->atlas_size * body->atlas_size; i++) {
        covered += pixels[i][3] == 1.0f;
        assert_true(pixels[i][3] == 1.0f ||
                    pixels[i][0] + pixels[i][1] + pixels[i][2] + pixels[i][3] == 0.0f);
    }
    assert_int_equal(covered, body->texel_count + body->gutter_count);
    assert_true(body->gutter_count >= gutter_min);
    parian_free(test_env(0), pixels);
}

static void check_texels(const gl_host *host, uint32_t instance)
{
    const size_t count = (size_t)host->scene->info.texel_count;
    const parian_env *env = test_env(0);
    parian_texel_arrays arrays = {.instance = instance};
    arrays.irradiance = parian_zalloc(env, count, sizeof *arrays.irradiance);
    arrays.radiosity = parian_zalloc(env, count, sizeof *arrays.radiosity);
    assert_int_equal(parian_renderer_read_texels(host->renderer, &arrays), PARIAN_OK);
    size_t first = 0;
    for (uint32_t b = 0; b < host->scene->info.body_count; b++) {
        const parian_body *body = &host->scene->data.bodies[b];
        parian_gl_textures textures;
        assert_int_equal(parian_renderer_get_gl_textures(host->renderer, instance, b, &textures),
                         PARIAN_OK);
        assert_int_equal(textures.size, body->atlas_size);
        expect_texels(host, textures.irradiance, body, (const float(*)[3])arrays.irradiance + first,
                      1);
        expect_texels(host, textures.radiosity, body, (const float(*)[3])arrays.radiosity + first,
                      1);
        assert_int_equal(textures.albedo != 0, body->texel_albedo != NULL);
        if (body->texel_albedo) {
            expect_texels(host, textures.albedo, body, (const float(*)[3])body->texel_albedo, 1);
        }
        first += body->texel_count;
    }
    parian_free(env, arrays.irradiance);
    parian_free(env, arrays.radiosity);
}

static const parian_light first_light = {
    .type = PARIAN_LIGHT_POINT, .position = {0.01f, 0.03f, 0.06f}, .color = {.01f, .02f, .01f}};

static void test_texels(void **state)
{
    gl_host *host = *state;
    const parian_instance pair[2] = {
        {{0}}, {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.03f, 0.01f, -0.02f, 1}}};
    parian_light other = first_light;
    parian_gl_textures before, after;
    assert_int_equal(parian_renderer_set_lights(host->renderer, &first_light, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_set_instances(host->renderer, pair, 2), PARIAN_OK);
    check_texels(host, 0);
    check_texels(host, 1);
    parian_renderer_get_gl_textures(host->renderer, 1, 0, &before);
    /* Another light: the same textures follow. */
    other.position[0] = -0.02f;
    assert_int_equal(parian_renderer_set_lights(host->renderer, &other, 1), PARIAN_OK);
    check_texels(host, 0);
    check_texels(host, 1);
    parian_renderer_get_gl_textures(host->renderer, 1, 0, &after);
    assert_memory_equal(&before, &after, sizeof before);
    assert_true(before.model[12] == 0.03f && before.scale == 1.0f);
}

static void test_refusals(void **state)
{
    gl_host *host = *state;
    parian_gl_textures textures;
    parian_renderer *cpu = lit_cpu(test_env(0), host->scene, 64);
    assert_int_equal(parian_renderer_get_gl_textures(cpu, 0, 0, &textures), PARIAN_E_UNSUPPORTED);
    assert_int_equal(parian_renderer_get_gl_textures(host->renderer, 9, 0, &textures),
                     PARIAN_E_ARGUMENT);
    assert_int_equal(parian_renderer_get_gl_textures(host->renderer, 0, 9, &textures),
                     PARIAN_E_ARGUMENT);
    parian_renderer_destroy(cpu);
}

/* ---- a picture of the host's own ---- */

/* Corners one after the other, from the public arrays alone: position, normal, uv. */
static GLuint upload_corners(const gl_host *host, const parian_scene_body *body)
{
    const parian_gl_api *gl = &host->gl;
    float(*corner)[8] =
        parian_zalloc(test_env(0), 3 * (size_t)body->triangle_count, sizeof *corner);
    GLuint buffer;
    for (uint32_t i = 0; i < 3 * body->triangle_count; i++) {
        uint32_t t = i / 3, k = i % 3;
        memcpy(corner[i], body->vertex_position[body->triangle[t][k]], 3 * sizeof(float));
        memcpy(corner[i] + 3, body->corner_normal[t][k], 3 * sizeof(float));
        corner[i][6] = body->corner_uv[t][k][0] / (float)body->atlas_size;
        corner[i][7] = body->corner_uv[t][k][1] / (float)body->atlas_size;
    }
    gl->GenBuffers(1, &buffer);
    gl->BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(3 * body->triangle_count * sizeof *corner), corner,
                   GL_STATIC_DRAW);
    for (GLuint a = 0; a < 3; a++) {
        gl->EnableVertexAttribArray(a);
        gl->VertexAttribPointer(a, a == 2 ? 2 : 3, GL_FLOAT, GL_FALSE, sizeof *corner,
                                (const void *)(a * 3 * sizeof(float)));
    }
    parian_free(test_env(0), corner);
    return buffer;
}

static void set_uniforms(const gl_host *host, GLuint program, const parian_gl_textures *textures)
{
    const parian_gl_api *gl = &host->gl;
    const parian_view view = parian_view_make(&host->draw.camera);
    gl->UniformMatrix4fv(gl->GetUniformLocation(program, "u_model"), 1, GL_FALSE, textures->model);
    gl->UniformMatrix4fv(gl->GetUniformLocation(program, "u_view_projection"), 1, GL_FALSE,
                         view.clip);
    gl->Uniform3fv(gl->GetUniformLocation(program, "u_eye"), 1, view.eye);
    gl->Uniform1f(gl->GetUniformLocation(program, "u_eta"), textures->eta);
    gl->Uniform1f(gl->GetUniformLocation(program, "u_exit_norm"), textures->exit_norm);
    gl->Uniform3fv(gl->GetUniformLocation(program, "u_tint"), 1, textures->tint);
    gl->Uniform1i(gl->GetUniformLocation(program, "u_radiosity"), 0);
    gl->Uniform1i(gl->GetUniformLocation(program, "u_albedo"), 1);
}

static GLuint bind_filtered(const gl_host *host, const parian_gl_textures *textures)
{
    const parian_gl_api *gl = &host->gl;
    GLuint sampler;
    void (*gen)(GLsizei, GLuint *) = NULL;
    void (*set)(GLuint, GLenum, GLint) = NULL;
    void *address[2] = {test_egl_address("glGenSamplers"), test_egl_address("glSamplerParameteri")};
    memcpy(&gen, &address[0], sizeof gen);
    memcpy(&set, &address[1], sizeof set);
    gen(1, &sampler);
    set(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    set(sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_2D, textures->radiosity);
    gl->BindSampler(0, sampler);
    gl->ActiveTexture(GL_TEXTURE1);
    gl->BindTexture(GL_TEXTURE_2D, textures->albedo);
    gl->BindSampler(1, sampler);
    gl->ActiveTexture(GL_TEXTURE0);
    return sampler;
}

static void draw_instance(const gl_host *host, GLuint program, uint32_t instance, uint32_t b)
{
    const parian_gl_api *gl = &host->gl;
    const parian_scene_body body = parian_scene_get_body(host->scene, b);
    parian_gl_textures textures;
    GLuint vertex_array;
    assert_int_equal(parian_renderer_get_gl_textures(host->renderer, instance, b, &textures),
                     PARIAN_OK);
    gl->GenVertexArrays(1, &vertex_array);
    gl->BindVertexArray(vertex_array);
    GLuint buffer = upload_corners(host, &body), sampler = bind_filtered(host, &textures);
    set_uniforms(host, program, &textures);
    gl->DrawArrays(GL_TRIANGLES, 0, (GLsizei)(3 * body.triangle_count));
    gl->BindSampler(0, 0);
    gl->BindSampler(1, 0);
    gl->DeleteVertexArrays(1, &vertex_array);
    gl->DeleteBuffers(1, &buffer);
    (void)sampler; /* goes with the context */
}

/* The host's picture with 2 x 2 samples a pixel: sums of radiance. */
static void draw_host(const gl_host *host, float (*samples)[4])
{
    const parian_gl_api *gl = &host->gl;
    const GLfloat none[4] = {0}, farthest = 1.0f;
    host_target target = make_target(host, 2 * SIDE);
    GLuint program = build(host, mesh_vertex, mesh_fragment);
    gl->Enable(GL_DEPTH_TEST);
    gl->ClearBufferfv(GL_COLOR, 0, none);
    gl->ClearBufferfv(GL_DEPTH, 0, &farthest);
    for (uint32_t i = 0; i < 2; i++) {
        for (uint32_t b = 0; b < host->scene->info.body_count; b++) {
            draw_instance(host, program, i, b);
        }
    }
    gl->ReadPixels(0, 0, 2 * SIDE, 2 * SIDE, GL_RGBA, GL_FLOAT, samples);
    gl->Disable(GL_DEPTH_TEST);
    drop_target(host, &target);
    gl->UseProgram(0);
    gl->DeleteProgram(program);
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
}

static void test_host_picture(void **state)
{
    static float samples[4 * SIDE * SIDE][4], ours[SIDE * SIDE][4];
    gl_host *host = *state;
    const parian_settings settings = {.no_specular = true, .no_normal_map = true};
    const parian_instance pair[2] = {
        {{0}}, {{0, 0.5f, 0, 0, -0.5f, 0, 0, 0, 0, 0, 0.5f, 0, 0.0f, -0.02f, 0.0f, 1}}};
    double off = 0.0, sum = 0.0;
    if (!host->filters) {
        skip();
    }
    assert_int_equal(parian_renderer_set_settings(host->renderer, &settings), PARIAN_OK);
    const parian_medium_edit edit = {.tint = {0.5f, 1.0f, 2.0f}};
    assert_int_equal(parian_renderer_set_medium(host->renderer, 0, &edit, NULL), PARIAN_OK);
    assert_int_equal(parian_renderer_set_lights(host->renderer, &first_light, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_set_instances(host->renderer, pair, 2), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(host->renderer, &host->draw), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(host->renderer, ours, NULL), PARIAN_OK);
    draw_host(host, samples);
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            for (int c = 0; c < 3; c++) {
                double mean = 0.0, want = (double)ours[(SIDE - 1 - y) * SIDE + x][c];
                for (int k = 0; k < 4; k++) {
                    mean += 0.25 * (double)samples[(2 * y + k / 2) * 2 * SIDE + 2 * x + k % 2][c];
                }
                off += fabs(mean - want);
                sum += want;
            }
        }
    }
    print_message("the host's picture differs by %.5f\n", off / sum);
    assert_true(sum > 0.0 && off / sum < 0.003);
}

/* ---- set-up ---- */

static bool has_extension(const parian_gl_api *gl, const char *name)
{
    GLint count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        if (strcmp((const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i), name) == 0) {
            return true;
        }
    }
    return false;
}

/* Bodies alone: surroundings would hide them from the host's picture. */
static void open_host(gl_host *host, bool es)
{
    const parian_env *env = test_env(0);
    const float eye[3] = {0.02f, 0.03f, 0.09f};
    const parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 256};
    parian_scene_data data = {0};
    *host = (gl_host){.es = es};
    assert_int_equal(parian_gl_api_load(NULL, test_egl_address, &host->gl), PARIAN_OK);
    host->filters = !es || has_extension(&host->gl, "GL_OES_texture_float_linear");
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_F16, 24, &data), PARIAN_OK);
    for (uint32_t s = 0; s < data.surrounding_count; s++) {
        parian_free(env, data.surroundings[s].vertex_position);
        parian_free(env, data.surroundings[s].triangle);
        parian_free(env, data.surroundings[s].corner_normal);
    }
    data.surrounding_count = 0;
    assert_int_equal(parian_scene_adopt(env, &data, &host->scene), PARIAN_OK);
    assert_int_equal(parian_renderer_create(env, host->scene, &desc, &host->renderer), PARIAN_OK);
    host->draw = (parian_draw_desc){.camera = lit_camera(eye, SIDE, SIDE),
                                    .width = SIDE,
                                    .height = SIDE,
                                    .framebuffer = UINT32_MAX};
}

static int run_flavour(bool es)
{
    gl_host host;
    const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(test_texels, &host),
                                       cmocka_unit_test_prestate(test_refusals, &host),
                                       cmocka_unit_test_prestate(test_host_picture, &host)};
    test_egl egl;
    if (!test_egl_open(&egl, es)) {
        return -1;
    }
    open_host(&host, es);
    int failed =
        cmocka_run_group_tests_name(es ? "OpenGL ES 3.0" : "OpenGL 3.3", tests, NULL, NULL);
    parian_renderer_destroy(host.renderer);
    parian_scene_close(host.scene);
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
