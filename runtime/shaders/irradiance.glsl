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

// Metres that a ray starts away from the surface: lights/relief.h.
float relief_start(float relief, float cosine)
{
    return relief > 1e-4 ? u_relief_reach * clamp(3.0 - cosine / relief, 0.0, 1.0) : 0.0;
}

// A texel, and the point of it at which rays start.
struct Texel {
    vec3 surface; // that point, in the body's coordinates
    vec3 p, n;    // centroid and lit normal, in the world's
    float relief;
    float extent; // metres
};

// Does anything hide a place, or a direction where it is not placed? to_light: unit direction at the texel.
bool is_hidden(Texel texel, vec3 to_light, float cosine, bool placed, vec3 place)
{
    float start = relief_start(texel.relief, cosine);
    vec3 own = texel.surface + start * (to_light * mat3(u_model)) / u_scale;
    vec3 origin = (u_model * vec4(own, 1.0)).xyz;
    return occluded(own, origin, placed ? place - origin : to_light, placed ? 0.99999 : 1e30);
}

bool is_distant(int i)
{
    int kind = light_kind(i);
    return kind == KIND_DIRECTIONAL || kind == KIND_PROBE;
}

// Lights without a place: a direction and a colour. Apart from the others, as some drivers go through every branch
// of a loop for every light.
vec3 light_distant(Texel texel)
{
    vec3 sum = vec3(0.0);
    for (int i = 0; i < u_light_count; i++) {
        vec3 to_light = -texelFetch(u_light, ivec2(1, i), 0).xyz;
        float cosine = dot(texel.n, to_light);
        if (is_distant(i) && cosine > 0.0 && !is_hidden(texel, to_light, cosine, false, vec3(0.0))) {
            sum += texelFetch(u_light, ivec2(2, i), 0).rgb * (cosine * fresnel_transmit(cosine, u_eta));
        }
    }
    return sum;
}

int next_placed(int i)
{
    while (i < u_light_count && is_distant(i)) {
        i++;
    }
    return i;
}

vec3 light_placed(Texel texel)
{
    vec3 sum = vec3(0.0);
    for (int i = next_placed(0); i < u_light_count; i = next_placed(i + 1)) {
        vec3 to_light, light;
        light_at(i, texel.p, texel.extent, to_light, light);
        float cosine = dot(texel.n, to_light);
        vec3 place = texelFetch(u_light, ivec2(0, i), 0).xyz;
        if (cosine > 0.0 && light.r + light.g + light.b > 0.0 && !is_hidden(texel, to_light, cosine, true, place)) {
            sum += light * (cosine * fresnel_transmit(cosine, u_eta));
        }
    }
    return sum;
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(u_position, at, 0);
    vec4 facing = texelFetch(u_normal, at, 0);
    Texel texel = Texel(texelFetch(u_origin, at, 0).xyz, (u_model * vec4(place.xyz, 1.0)).xyz,
                        mat3(u_model) * facing.xyz / u_scale, facing.w, sqrt(place.w) * u_scale);
    o_irradiance = vec4(0.0);
    if (dot(texel.n, texel.n) < 0.5) {
        return;
    }
    vec3 sum = light_distant(texel) + light_placed(texel);
    if (u_share < 1.0) {
        sum = mix(texelFetch(u_base, at, 0).rgb, sum, u_share);
    }
    o_irradiance = vec4(sum, 1.0);
}
