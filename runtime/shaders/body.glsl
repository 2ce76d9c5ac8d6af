// body.glsl - radiance of a translucent body. C: cpu/cpu_shade.c.
// SPDX-License-Identifier: MIT
const int VIEW_COMBINED = 0, VIEW_LOCAL = 1, VIEW_GLOBAL = 2, VIEW_IRRADIANCE = 3, VIEW_OPAQUE = 4;
const int VIEW_NORMALS = 5, VIEW_CHARTS = 6, VIEW_RADIOSITY = 7, VIEW_VALUES = 8;

in vec3 v_position, v_normal, v_chart;
in vec2 v_uv;
uniform sampler2D u_irradiance; // atlases with gutters; alpha 1 where there is a value; the values of VIEW_VALUES
uniform sampler2D u_local;
uniform sampler2D u_global;
uniform sampler2D u_normal_map;
uniform sampler2D u_albedo;
uniform int u_has_normal_map, u_has_albedo;
uniform int u_view;
uniform int u_specular;
uniform float u_alpha;     // GGX roughness
uniform float u_eta;
uniform float u_exit_norm;
uniform vec3 u_tint;       // of what scatters out
uniform vec3 u_total;      // albedo of the opaque twin
uniform mat4 u_model;      // of the instance
uniform vec4 u_eye;        // position and 1, or direction and 0
layout(location = 0) out vec4 o_radiance;

// Bilinear by hand; texels without a value drop out.
vec3 fetch_atlas(sampler2D atlas, vec2 uv)
{
    vec2 at = uv - 0.5, base = floor(at), f = at - base;
    ivec2 size = textureSize(atlas, 0);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        ivec2 corner = ivec2(k & 1, k >> 1), i = ivec2(base) + corner;
        if (i.x < 0 || i.y < 0 || i.x >= size.x || i.y >= size.y) {
            continue;
        }
        vec4 texel = texelFetch(atlas, i, 0);
        float weight = (corner.x == 1 ? f.x : 1.0 - f.x) * (corner.y == 1 ? f.y : 1.0 - f.y) * texel.a;
        sum += vec4(texel.rgb, 1.0) * weight;
    }
    return sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
}

// Cosine towards the viewer. A normal that interpolation or the map turned away from a triangle that is
// seen counts as grazing: without this, F_t would draw black lines there.
float seen_cosine(vec3 n, vec3 v)
{
    vec3 facet = cross(dFdx(v_position), dFdy(v_position));
    float facing = abs(dot(facet, v)) / max(length(facet), 1e-30);
    return max(max(dot(n, v), min(facing, 0.1)), 1e-3);
}

// GGX with height-correlated masking, times the cosine of the light.
float ggx(float n_l, float n_v, float n_h)
{
    float a2 = u_alpha * u_alpha;
    float base = n_h * n_h * (a2 - 1.0) + 1.0;
    float density = a2 / (PI * base * base);
    float mask_l = n_v * sqrt(n_l * n_l * (1.0 - a2) + a2);
    float mask_v = n_l * sqrt(n_v * n_v * (1.0 - a2) + a2);
    return density * 0.5 * n_l / (mask_l + mask_v);
}

vec3 reflect_lights(vec3 smooth_n, vec3 n, vec3 v, float n_v)
{
    vec3 sum = vec3(0.0);
    for (int i = 0; i < u_light_count; i++) {
        vec3 l, light;
        if (light_kind(i) == KIND_PROBE) {
            continue;
        }
        light_at(i, v_position, u_lift, l, light);
        float n_l = dot(n, l);
        if (n_l <= 0.0 || dot(smooth_n, l) <= 0.0 || light.r + light.g + light.b <= 0.0) {
            continue;
        }
        vec3 h = normalize(l + v);
        float lobe = ggx(n_l, n_v, max(dot(n, h), 0.0)) * (1.0 - fresnel_transmit(dot(l, h), u_eta));
        sum += light * (lobe * visibility(i, v_position, smooth_n));
    }
    if (u_environment != 0) {
        vec3 mirrored = normalize(2.0 * n_v * n - v);
        sum += evaluate_sh(mirrored, vec3(1.0)) * (1.0 - fresnel_transmit(n_v, u_eta));
    }
    return sum;
}

// What leaves of a view mode, times pi, before Fresnel.
vec3 scattered()
{
    vec3 value = vec3(0.0);
    if (u_view == VIEW_IRRADIANCE || u_view == VIEW_OPAQUE) {
        value = fetch_atlas(u_irradiance, v_uv);
    }
    bool both = u_view == VIEW_COMBINED || u_view == VIEW_RADIOSITY;
    if (both || u_view == VIEW_LOCAL) {
        value += fetch_atlas(u_local, v_uv);
    }
    if (both || u_view == VIEW_GLOBAL) {
        value += fetch_atlas(u_global, v_uv);
    }
    if (u_has_albedo != 0 && u_view != VIEW_IRRADIANCE && u_view != VIEW_RADIOSITY) {
        value *= fetch_atlas(u_albedo, v_uv);
    }
    return value;
}

void main()
{
    vec3 smooth_n = normalize(v_normal), n = smooth_n;
    vec3 v = normalize(u_eye.xyz - v_position * u_eye.w);
    if (u_has_normal_map != 0) {
        n = normalize(mat3(u_model) * fetch_atlas(u_normal_map, v_uv));
    }
    float n_v = seen_cosine(n, v);
    o_radiance.a = 1.0;
    if (u_view == VIEW_NORMALS) {
        o_radiance.rgb = 0.5 + 0.5 * n;
        return;
    }
    if (u_view == VIEW_CHARTS) {
        o_radiance.rgb = v_chart * (0.3 + 0.7 * n_v);
        return;
    }
    if (u_view == VIEW_VALUES) {
        o_radiance.rgb = fetch_atlas(u_irradiance, v_uv);
        return;
    }
    vec3 factor = vec3(1.0 / PI);
    if (u_view == VIEW_OPAQUE) {
        factor *= u_total * u_tint;
    } else if (u_view != VIEW_IRRADIANCE && u_view != VIEW_RADIOSITY) {
        factor *= u_tint * (fresnel_transmit(n_v, u_eta) / u_exit_norm);
    }
    o_radiance.rgb = max(scattered() * factor, 0.0);
    if (u_specular != 0) {
        o_radiance.rgb += reflect_lights(smooth_n, n, v, n_v);
    }
}
