/* relight_window.c - opens a window, loads an asset, and moves a light around it with the mouse.
 *
 * Drag: the light follows. Wheel: nearer, farther. Space: the light goes round by itself, or stops.
 * --frames N ends after N frames, for tests.
 *
 * SPDX-License-Identifier: MIT
 */
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <parian/runtime.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846, FIELD_OF_VIEW = 0.6, TURN_PER_SECOND = 0.8;

typedef struct app {
    parian_renderer *renderer;
    float centre[3], radius; /* of the bodies, metres */
    double yaw, pitch;       /* of the light, radians */
    double distance;         /* of the camera, in radii */
    double mouse_x, mouse_y;
    bool turning;
} app;

static void print_log(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level <= PARIAN_LOG_WARNING) {
        fprintf(stderr, "relight: %s\n", text);
    }
}

static void *get_proc_address(const char *name)
{
    return (void *)glfwGetProcAddress(name);
}

/* ---- mouse and keys ---- */
static void on_cursor(GLFWwindow *window, double x, double y)
{
    app *a = glfwGetWindowUserPointer(window);
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
        a->turning = false;
        a->yaw += 0.01 * (x - a->mouse_x);
        a->pitch = fmin(1.5, fmax(-1.5, a->pitch - 0.01 * (y - a->mouse_y)));
    }
    a->mouse_x = x;
    a->mouse_y = y;
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    app *a = glfwGetWindowUserPointer(window);
    (void)x;
    a->distance = fmin(20, fmax(2, a->distance * pow(0.9, y)));
}

static void on_key(GLFWwindow *window, int key, int scancode, int action, int mods)
{
    app *a = glfwGetWindowUserPointer(window);
    (void)scancode;
    (void)mods;
    a->turning ^= key == GLFW_KEY_SPACE && action == GLFW_PRESS;
    glfwSetWindowShouldClose(window, key == GLFW_KEY_ESCAPE);
}

/* ---- a frame ---- */
/* A point light on a circle around the bodies: as bright as two watts per square metre at their
 * centre. */
static parian_result move_light(app *a)
{
    const float distance = 3 * a->radius, intensity = 2 * distance * distance;
    const double direction[3] = {sin(a->yaw) * cos(a->pitch), sin(a->pitch),
                                 cos(a->yaw) * cos(a->pitch)};
    parian_light light = {.type = PARIAN_LIGHT_POINT, .color = {intensity, intensity, intensity}};
    for (int i = 0; i < 3; i++) {
        light.position[i] = a->centre[i] + distance * (float)direction[i];
    }
    return parian_renderer_set_lights(a->renderer, &light, 1);
}

/* Column-major, as OpenGL has them: the camera looks along -z from +z. */
static parian_camera look(const app *a, double aspect)
{
    const float far_away = (float)a->distance * a->radius, f = (float)(1 / tan(FIELD_OF_VIEW / 2));
    const float near_plane = 0.05f * a->radius, far_plane = far_away + 4 * a->radius;
    const float depth = near_plane - far_plane;
    parian_camera camera = {.view = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -a->centre[0],
                                     -a->centre[1], -a->centre[2] - far_away, 1},
                            .projection = {f / (float)aspect, 0, 0, 0, 0, f, 0, 0, 0, 0,
                                           (near_plane + far_plane) / depth, -1, 0, 0,
                                           2 * near_plane * far_plane / depth, 0}};
    return camera;
}

static parian_result draw(app *a, GLFWwindow *window)
{
    int width, height;
    glfwGetFramebufferSize(window, &width, &height);
    if (width < 1 || height < 1) {
        return PARIAN_OK; /* minimised */
    }
    const parian_draw_desc desc = {.camera = look(a, (double)width / height),
                                   .width = (uint32_t)width,
                                   .height = (uint32_t)height,
                                   .exposure_auto = true};
    return parian_renderer_draw(a->renderer, &desc); /* relights, because the light has moved */
}

static parian_result run(app *a, GLFWwindow *window, long frames)
{
    double then = glfwGetTime();
    parian_result result = PARIAN_OK;
    for (long frame = 0; result == PARIAN_OK && !glfwWindowShouldClose(window) && frame != frames;
         frame++) {
        const double now = glfwGetTime();
        a->yaw += a->turning ? TURN_PER_SECOND * (frames < 0 ? now - then : 1 / 60.0) : 0;
        then = now;
        result = move_light(a);
        if (result == PARIAN_OK) {
            result = draw(a, window);
        }
        glfwSwapBuffers(window);
        glfwPollEvents();
    }
    return result;
}

/* ---- start and end ---- */
static GLFWwindow *open_window(app *a)
{
    static const int apis[2][3] = {{GLFW_OPENGL_API, 3, 3}, {GLFW_OPENGL_ES_API, 3, 0}};
    GLFWwindow *window = NULL;
    for (int i = 0; i < 2 && !window; i++) {
        glfwDefaultWindowHints();
        glfwWindowHint(GLFW_CLIENT_API, apis[i][0]);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, apis[i][1]);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, apis[i][2]);
        glfwWindowHint(GLFW_OPENGL_PROFILE,
                       i == 0 ? GLFW_OPENGL_CORE_PROFILE : GLFW_OPENGL_ANY_PROFILE);
        window = glfwCreateWindow(800, 600, "relight", NULL, NULL);
    }
    if (window) {
        glfwMakeContextCurrent(window);
        glfwSwapInterval(1);
        glfwSetWindowUserPointer(window, a);
        glfwSetCursorPosCallback(window, on_cursor);
        glfwSetScrollCallback(window, on_scroll);
        glfwSetKeyCallback(window, on_key);
    }
    return window;
}

static void frame_bodies(app *a, const parian_scene_info *info)
{
    float diagonal = 0;
    for (int i = 0; i < 3; i++) {
        const float side = info->body_upper[i] - info->body_lower[i];
        a->centre[i] = 0.5f * (info->body_lower[i] + info->body_upper[i]);
        diagonal += side * side;
    }
    a->radius = 0.5f * sqrtf(diagonal);
}

int main(int argc, char **argv)
{
    const parian_env env = {.log = print_log};
    parian_scene *scene = NULL;
    app a = {.yaw = PI / 4, .pitch = 0.4, .distance = 3.4, .turning = true};
    if (argc != 2 && !(argc == 4 && strcmp(argv[2], "--frames") == 0)) {
        fprintf(stderr, "usage: relight ASSET.parian [--frames N]\n");
        return 1;
    }
    parian_result result = parian_scene_open(&env, argv[1], &scene);
    GLFWwindow *window = result == PARIAN_OK && glfwInit() ? open_window(&a) : NULL;
    if (window) {
        const parian_scene_info info = parian_scene_get_info(scene);
        const parian_renderer_desc desc = {.get_proc_address = get_proc_address};
        frame_bodies(&a, &info);
        result = parian_renderer_create(&env, scene, &desc, &a.renderer);
        if (result == PARIAN_OK) {
            result = run(&a, window, argc == 4 ? strtol(argv[3], NULL, 10) : -1);
        }
    } else if (result == PARIAN_OK) {
        fprintf(stderr, "relight: no window with OpenGL 3.3 or OpenGL ES 3.0\n");
        result = PARIAN_E_DEVICE;
    }
    parian_renderer_destroy(a.renderer); /* while its context is current */
    parian_scene_close(scene);
    glfwTerminate();
    return parian_result_exit_status(result);
}
