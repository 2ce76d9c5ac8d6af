/* vec3.h - small vectors of floats, as plain arrays.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VEC3_H
#define PARIAN_VEC3_H

#include <math.h>

static inline float vec3_dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vec3_copy(float to[3], const float from[3])
{
    to[0] = from[0], to[1] = from[1], to[2] = from[2];
}

static inline void vec3_set(float to[3], float value)
{
    to[0] = value, to[1] = value, to[2] = value;
}

static inline void vec3_sub(float to[3], const float a[3], const float b[3])
{
    to[0] = a[0] - b[0], to[1] = a[1] - b[1], to[2] = a[2] - b[2];
}

/* to += a * s */
static inline void vec3_add_scaled(float to[3], const float a[3], float s)
{
    to[0] += a[0] * s, to[1] += a[1] * s, to[2] += a[2] * s;
}

static inline void vec3_scale(float v[3], float s)
{
    v[0] *= s, v[1] *= s, v[2] *= s;
}

static inline void vec3_cross(float to[3], const float a[3], const float b[3])
{
    float x = a[1] * b[2] - a[2] * b[1];
    float y = a[2] * b[0] - a[0] * b[2];
    float z = a[0] * b[1] - a[1] * b[0];
    to[0] = x, to[1] = y, to[2] = z;
}

static inline float vec3_length(const float v[3])
{
    return sqrtf(vec3_dot(v, v));
}

/* Scale to unit length; a vector without length becomes +z. Returns the former length. */
static inline float vec3_normalize(float v[3])
{
    float peak = fmaxf(fmaxf(fabsf(v[0]), fabsf(v[1])), fabsf(v[2]));
    if (!(peak > 0.0f) || !isfinite(peak)) {
        v[0] = 0.0f, v[1] = 0.0f, v[2] = 1.0f;
        return 0.0f;
    }
    vec3_scale(v, 1.0f / peak);
    float length = vec3_length(v);
    vec3_scale(v, 1.0f / length);
    return length * peak;
}

/* Two unit vectors that make a right-handed frame (u, v, forward) with a unit forward; v is near
 * up. */
static inline void vec3_frame(const float forward[3], const float up[3], float u[3], float v[3])
{
    float axis[3] = {up[0], up[1], up[2]};
    vec3_cross(u, axis, forward);
    if (vec3_dot(u, u) < 1e-8f * vec3_dot(axis, axis) || vec3_dot(axis, axis) <= 0.0f) {
        int least = fabsf(forward[1]) < 0.9f ? 1 : 2;
        vec3_set(axis, 0.0f);
        axis[least] = 1.0f;
        vec3_cross(u, axis, forward);
    }
    vec3_normalize(u);
    vec3_cross(v, forward, u);
}

#endif
