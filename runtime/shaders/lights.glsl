// lights.glsl - light that arrives at a point, and shadows; included by passes. C: cpu/cpu_lights.c.
// SPDX-License-Identifier: MIT
const int KIND_DIRECTIONAL = 1, KIND_SPOT = 2, KIND_PATCH = 3, KIND_PROBE = 4;

uniform sampler2D u_light;        // rows of 8 texels: light_list.h, parian_light_list_tables
uniform sampler2D u_layer;        // rows of 8 texels
uniform sampler2DArray u_shadow;  // nearest depth, linear
uniform sampler2DArray u_image;   // pictures with their levels, one long array
uniform int u_light_count;
uniform int u_shadow_size;
uniform float u_lift;
uniform int u_environment;
uniform vec3 u_sh[9];

// Exact unpolarised Fresnel transmittance from outside onto a body of relative index eta.
float fresnel_transmit(float cosine, float eta)
{
    float c = clamp(cosine, 0.0, 1.0);
    float inside = eta * eta - 1.0 + c * c;
    if (inside <= 0.0) {
        return 0.0;
    }
    float g = sqrt(inside);
    if (c + g <= 0.0) {
        return 0.0;
    }
    float parallel = (eta * eta * c - g) / (eta * eta * c + g);
    float perpendicular = (c - g) / (c + g);
    return 1.0 - 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

// Light that passes one shadow map; negative where the point does not fall on it.
float look_up_layer(int index, vec3 p, vec3 n)
{
    vec4 row_x = texelFetch(u_layer, ivec2(0, index), 0), row_y = texelFetch(u_layer, ivec2(1, index), 0);
    vec4 row_d = texelFetch(u_layer, ivec2(2, index), 0), row_w = texelFetch(u_layer, ivec2(3, index), 0);
    vec4 fit = texelFetch(u_layer, ivec2(4, index), 0); // texel scale, perspective, near, far
    float w = dot(row_w, vec4(p, 1.0));
    if (w <= 0.0) {
        return -1.0;
    }
    float texel = fit.x * w;
    vec4 q = vec4(p + n * (1.5 * texel + u_lift), 1.0);
    w = dot(row_w, q);
    if (fit.y > 0.5 && w <= fit.z) {
        return -1.0;
    }
    vec2 at = (vec2(dot(row_x, q), dot(row_y, q)) / w * 0.5 + 0.5) * float(u_shadow_size) - 0.5;
    float last = float(u_shadow_size) - 1.0;
    if (!(at.x >= 0.0 && at.y >= 0.0 && at.x < last && at.y < last)) {
        return -1.0;
    }
    float depth = dot(row_d, q) - 0.5 * texel / (fit.w - fit.z);
    ivec3 base = ivec3(ivec2(floor(at)), index);
    vec2 f = fract(at);
    float a = depth <= texelFetch(u_shadow, base, 0).r ? 1.0 : 0.0;
    float b = depth <= texelFetch(u_shadow, base + ivec3(1, 0, 0), 0).r ? 1.0 : 0.0;
    float c = depth <= texelFetch(u_shadow, base + ivec3(0, 1, 0), 0).r ? 1.0 : 0.0;
    float d = depth <= texelFetch(u_shadow, base + ivec3(1, 1, 0), 0).r ? 1.0 : 0.0;
    return mix(mix(a, b, f.x), mix(c, d, f.x), f.y);
}

float visibility(int light, vec3 p, vec3 n)
{
    vec4 layers = texelFetch(u_light, ivec2(6, light), 0);
    int first = int(layers.x), count = int(layers.y);
    for (int k = 0; k < count; k++) {
        float lit = look_up_layer(first + k, p, n);
        if (lit >= 0.0) {
            return lit;
        }
    }
    return 1.0;
}

uint level_side(uint side, uint level)
{
    return max(side >> level, 1u);
}

// Bilinear look-up in one level of a picture, black outside. picture: offset, width, height, levels.
vec3 image_level(uvec4 picture, uint level, vec2 st)
{
    uint offset = picture.x;
    for (uint l = 0u; l < level; l++) {
        offset += level_side(picture.y, l) * level_side(picture.z, l);
    }
    int w = int(level_side(picture.y, level)), h = int(level_side(picture.z, level));
    vec2 at = st * vec2(float(w), float(h)) - 0.5;
    vec2 base = floor(at), f = at - base;
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 4; k++) {
        ivec2 corner = ivec2(k & 1, k >> 1), i = ivec2(base) + corner;
        float weight = (corner.x == 1 ? f.x : 1.0 - f.x) * (corner.y == 1 ? f.y : 1.0 - f.y);
        if (i.x >= 0 && i.y >= 0 && i.x < w && i.y < h) {
            sum += weight * texelFetch(u_image, array_at(offset + uint(i.y * w + i.x)), 0).rgb;
        }
    }
    return sum;
}

// The projected picture of a spot at a point, filtered over `extent` metres.
vec3 image_at(int light, vec3 away, float extent)
{
    vec3 forward = texelFetch(u_light, ivec2(1, light), 0).xyz;
    vec4 right = texelFetch(u_light, ivec2(3, light), 0);
    vec3 up = texelFetch(u_light, ivec2(4, light), 0).xyz;
    uvec4 picture = uvec4(texelFetch(u_light, ivec2(5, light), 0));
    if (picture.w == 0u) {
        return vec3(1.0);
    }
    float reach = dot(away, forward) * right.w;
    if (!(reach > 0.0)) {
        return vec3(0.0);
    }
    vec2 st = vec2(0.5 + 0.5 * dot(away, right.xyz) / reach, 0.5 - 0.5 * dot(away, up) / reach);
    if (!(st.x > -1.0 && st.x < 2.0 && st.y > -1.0 && st.y < 2.0)) {
        return vec3(0.0);
    }
    float pixel = 2.0 * reach / float(picture.y);
    float level = min(log2(max(extent / pixel, 1.0)), float(picture.w - 1u));
    uint fine = uint(level);
    float blend = level - float(fine);
    vec3 rgb = image_level(picture, fine, st);
    if (blend > 0.0) {
        rgb = mix(rgb, image_level(picture, fine + 1u, st), blend);
    }
    return rgb;
}

int light_kind(int light)
{
    return int(texelFetch(u_light, ivec2(0, light), 0).w);
}

// Direction towards a light and its irradiance on a plane perpendicular to it, unshadowed.
void light_at(int light, vec3 p, float extent, out vec3 to_light, out vec3 irradiance)
{
    vec4 position = texelFetch(u_light, ivec2(0, light), 0);
    vec4 direction = texelFetch(u_light, ivec2(1, light), 0);
    vec4 color = texelFetch(u_light, ivec2(2, light), 0);
    int kind = int(position.w);
    irradiance = color.rgb;
    if (kind == KIND_DIRECTIONAL || kind == KIND_PROBE) {
        to_light = -direction.xyz;
        return;
    }
    vec3 away = p - position.xyz;
    float far = length(away);
    to_light = far > 0.0 ? -away / far : vec3(0.0, 0.0, 1.0);
    float attenuation = 1.0 / max(far * far, extent * extent / PI);
    float cosine = -dot(to_light, direction.xyz);
    if (kind == KIND_PATCH) {
        attenuation *= max(cosine, 0.0);
    }
    if (kind == KIND_SPOT) {
        float ramp = clamp((cosine - color.w) / max(direction.w - color.w, 1e-6), 0.0, 1.0);
        attenuation *= ramp * ramp * (3.0 - 2.0 * ramp);
        if (attenuation > 0.0) {
            irradiance *= image_at(light, away, extent);
        }
    }
    irradiance *= attenuation;
}

// Sum of the environment's nine coefficients times their harmonics and zonal weights.
vec3 evaluate_sh(vec3 d, vec3 zonal)
{
    vec3 sum = zonal.x * 0.282094792 * u_sh[0];
    sum += zonal.y * 0.488602512 * (d.y * u_sh[1] + d.z * u_sh[2] + d.x * u_sh[3]);
    sum += zonal.z * (1.092548431 * (d.x * d.y * u_sh[4] + d.y * d.z * u_sh[5] + d.x * d.z * u_sh[7]) +
                      0.315391565 * (3.0 * d.z * d.z - 1.0) * u_sh[6] +
                      0.546274215 * (d.x * d.x - d.y * d.y) * u_sh[8]);
    return max(sum, 0.0);
}

// Share of the probes' light that is not blocked.
vec3 open_share(vec3 open, vec3 whole)
{
    return vec3(whole.r > 0.0 ? open.r / whole.r : 1.0, whole.g > 0.0 ? open.g / whole.g : 1.0,
                whole.b > 0.0 ? open.b / whole.b : 1.0);
}

// Irradiance of the environment's smooth part; probes tell how much of it is blocked, by shadow maps.
vec3 environment_at(vec3 p, vec3 n)
{
    vec3 open = vec3(0.0), whole = vec3(0.0);
    for (int i = 0; i < u_light_count; i++) {
        vec3 to_light = -texelFetch(u_light, ivec2(1, i), 0).xyz;
        float cosine = dot(n, to_light);
        if (light_kind(i) != KIND_PROBE || cosine <= 0.0) {
            continue;
        }
        vec3 part = cosine * texelFetch(u_light, ivec2(2, i), 0).rgb;
        whole += part;
        open += part * visibility(i, p, n);
    }
    return evaluate_sh(n, vec3(PI, 2.09439510, 0.785398163)) * open_share(open, whole);
}
