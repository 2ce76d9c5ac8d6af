// irradiance.glsl - E of each owned texel: cosine, exact Fresnel transmittance, shadows. C: cpu/cpu_lights.c.
// SPDX-License-Identifier: MIT
uniform sampler2D u_position; // xyz, area (0 where no texel is)
uniform sampler2D u_normal;
uniform float u_eta;
uniform vec3 u_zonal;
layout(location = 0) out vec4 o_irradiance;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(u_position, at, 0);
    vec3 n = texelFetch(u_normal, at, 0).xyz, sum = vec3(0.0);
    o_irradiance = vec4(0.0);
    if (dot(n, n) < 0.5) {
        return;
    }
    for (int i = 0; i < u_light_count; i++) {
        vec3 to_light, light;
        if (light_kind(i) == KIND_PROBE) {
            continue;
        }
        light_at(i, place.xyz, sqrt(place.w), to_light, light);
        float cosine = dot(n, to_light);
        if (cosine <= 0.0 || light.r + light.g + light.b <= 0.0) {
            continue;
        }
        sum += light * (cosine * fresnel_transmit(cosine, u_eta) * visibility(i, place.xyz, n));
    }
    if (u_environment != 0) {
        sum += environment_at(place.xyz, n, u_zonal, u_eta);
    }
    o_irradiance = vec4(sum, 1.0);
}
