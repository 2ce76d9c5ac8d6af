// surrounding.glsl - radiance of the diffuse surroundings. C: cpu/cpu_shade.c.
// SPDX-License-Identifier: MIT
in vec3 v_position, v_normal, v_chart;
in vec2 v_uv;
uniform vec3 u_reflectance;
uniform int u_view;
uniform vec4 u_eye;
layout(location = 0) out vec4 o_radiance;

void main()
{
    vec3 n = normalize(v_normal), sum = vec3(0.0);
    vec3 v = normalize(u_eye.xyz - v_position * u_eye.w);
    n = dot(n, v) < 0.0 ? -n : n;
    if (u_view == 5 || u_view == 6 || u_view == 8) { // normals, charts, values
        o_radiance = vec4(u_view == 5 ? 0.5 + 0.5 * n : vec3(0.5), 1.0);
        return;
    }
    for (int i = 0; i < u_light_count; i++) {
        vec3 l, light;
        if (light_kind(i) == KIND_PROBE) {
            continue;
        }
        light_at(i, v_position, u_lift, l, light);
        float cosine = dot(n, l);
        if (cosine > 0.0 && light.r + light.g + light.b > 0.0) {
            sum += light * (cosine * visibility(i, v_position, n));
        }
    }
    if (u_environment != 0) {
        sum += environment_at(v_position, n);
    }
    o_radiance = vec4(sum * u_reflectance / PI, 1.0);
}
