/* view.c - a camera as the shading passes need it.
 *
 * SPDX-License-Identifier: MIT
 */
#include "shade/view.h"

#include "vec3.h"

/* Where the view matrix puts its origin: the solution of R eye + t = 0. */
static void find_eye(const float view[16], float eye[3])
{
    float a[3] = {view[0], view[1], view[2]}, b[3] = {view[4], view[5], view[6]};
    float c[3] = {view[8], view[9], view[10]}, t[3] = {-view[12], -view[13], -view[14]};
    float bc[3], ca[3], ab[3];
    vec3_cross(bc, b, c);
    vec3_cross(ca, c, a);
    vec3_cross(ab, a, b);
    float det = vec3_dot(a, bc);
    float scale = det != 0.0f ? 1.0f / det : 0.0f;
    eye[0] = vec3_dot(t, bc) * scale;
    eye[1] = vec3_dot(t, ca) * scale;
    eye[2] = vec3_dot(t, ab) * scale;
}

parian_view parian_view_make(const parian_camera *camera)
{
    parian_view made;
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 4; row++) {
            float sum = 0.0f;
            for (int k = 0; k < 4; k++) {
                sum += camera->projection[4 * k + row] * camera->view[4 * column + k];
            }
            made.clip[4 * column + row] = sum;
        }
    }
    if (camera->projection[11] != 0.0f) {
        find_eye(camera->view, made.eye);
        made.eye[3] = 1.0f;
    } else {
        for (int c = 0; c < 3; c++) {
            made.eye[c] = camera->view[4 * c + 2];
        }
        made.eye[3] = 0.0f;
    }
    return made;
}

uint32_t parian_view_supersampling(uint32_t width, uint32_t height, uint32_t side_max)
{
    const uint32_t side = width > height ? width : height;
    const bool many = (uint64_t)width * height * 4 > PARIAN_VIEW_SAMPLES_MAX;
    return 2 * side <= side_max && !many ? 2 : 1;
}
