// irradiance.glsl - E of each owned texel: cosine, exact Fresnel transmittance, shadows. C: cpu/cpu_lights.c.
// SPDX-License-Identifier: MIT
uniform sampler2D u_position; // xyz, area (0 where no texel is)
uniform sampler2D u_normal;
uniform mat4 u_model;         // of the instance: rotation times scale, translation
uniform float u_scale;
uniform float u_eta;
uniform vec3 u_zonal;
layout(location = 0) out vec4 o_irradiance;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(u_position, at, 0);
    vec3 p = (u_model * vec4(place.xyz, 1.0)).xyz;
    vec3 n = mat3(u_model) * texelFetch(u_normal, at, 0).xyz / u_scale, sum = vec3(0.0);
    float extent = sqrt(place.w) * u_scale;
    o_irradiance = vec4(0.0);
    if (dot(n, n) < 0.5) {
        return;
    }
    for (int i = 0; i < u_light_count; i++) {
        vec3 to_light, light;
        if (light_kind(i) == KIND_PROBE) {
            continue;
        }
        light_at(i, p, extent, to_light, light);
        float cosine = dot(n, to_light);
        if (cosine <= 0.0 || light.r + light.g + light.b <= 0.0) {
            continue;
        }
        sum += light * (cosine * fresnel_transmit(cosine, u_eta) * visibility(i, p, n));
    }
    if (u_environment != 0) {
        sum += environment_at(p, n, u_zonal, u_eta);
    }
    o_irradiance = vec4(sum, 1.0);
}
