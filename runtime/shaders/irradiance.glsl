// irradiance.glsl - E of each owned texel: cosine, exact Fresnel transmittance, shadows by rays; the mean with the
// sets of samples before. C: cpu/cpu_irradiance.c.
// SPDX-License-Identifier: MIT
uniform sampler2D u_position; // xyz, area (0 where no texel is)
uniform sampler2D u_normal;   // xyz: that light falls on; relief: lights/relief.h
uniform sampler2D u_origin;   // where rays start
uniform sampler2D u_base;     // mean of the sets before
uniform mat4 u_model;         // of the instance: rotation times scale, translation
uniform float u_scale;
uniform float u_share;        // of this set in the new mean; 1: the first
uniform float u_eta;
uniform float u_relief_reach; // metres
layout(location = 0) out vec4 o_irradiance;

// Is light i hidden from where a ray starts? own, origin: that in the body's coordinates and in the world's;
// to_light: unit direction at the texel.
bool is_hidden(int i, vec3 own, vec3 origin, vec3 to_light)
{
    vec4 position = texelFetch(u_light, ivec2(0, i), 0);
    int kind = int(position.w);
    bool distant = kind == KIND_DIRECTIONAL || kind == KIND_PROBE;
    return occluded(own, origin, distant ? to_light : position.xyz - origin, distant ? 1e30 : 0.99999);
}

// Metres that a ray starts away from the surface: lights/relief.h.
float relief_start(float relief, float cosine)
{
    return relief > 1e-4 ? u_relief_reach * clamp(3.0 - cosine / relief, 0.0, 1.0) : 0.0;
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(u_position, at, 0);
    vec4 facing = texelFetch(u_normal, at, 0);
    vec3 surface = texelFetch(u_origin, at, 0).xyz;
    vec3 p = (u_model * vec4(place.xyz, 1.0)).xyz;
    vec3 n = mat3(u_model) * facing.xyz / u_scale;
    vec3 sum = vec3(0.0);
    float extent = sqrt(place.w) * u_scale;
    o_irradiance = vec4(0.0);
    if (dot(n, n) < 0.5) {
        return;
    }
    for (int i = 0; i < u_light_count; i++) {
        vec3 to_light, light;
        light_at(i, p, extent, to_light, light);
        float cosine = dot(n, to_light);
        if (cosine <= 0.0 || light.r + light.g + light.b <= 0.0) {
            continue;
        }
        float start = relief_start(facing.w, cosine);
        vec3 own = surface + start * (to_light * mat3(u_model)) / u_scale;
        if (!is_hidden(i, own, (u_model * vec4(own, 1.0)).xyz, to_light)) {
            sum += light * (cosine * fresnel_transmit(cosine, u_eta));
        }
    }
    if (u_share < 1.0) {
        sum = mix(texelFetch(u_base, at, 0).rgb, sum, u_share);
    }
    o_irradiance = vec4(sum, 1.0);
}
