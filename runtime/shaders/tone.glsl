// tone.glsl - exposure, tone curve, sRGB. C: cpu/cpu_tone.c.
// SPDX-License-Identifier: MIT
uniform sampler2D u_picture;
uniform sampler2D u_mean;  // sum of luminance, coverage
uniform sampler2D u_logs;  // sum of logarithms, coverage
uniform int u_auto, u_plain;
uniform int u_tone; // parian_tone
uniform float u_exposure;
layout(location = 0) out vec4 o_srgb;

vec3 neutral_curve(vec3 rgb)
{
    const float start = 0.8 - 0.04, desaturation = 0.15;
    float least = min(rgb.r, min(rgb.g, rgb.b));
    rgb -= least < 0.08 ? least - 6.25 * least * least : 0.04;
    float peak = max(rgb.r, max(rgb.g, rgb.b));
    if (peak < start) {
        return rgb;
    }
    float room = 1.0 - start;
    float new_peak = 1.0 - room * room / (peak + room - start);
    rgb *= new_peak / peak;
    float white = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
    return mix(rgb, vec3(new_peak), white);
}

vec3 encode(vec3 x)
{
    x = clamp(x, 0.0, 1.0);
    vec3 low = 12.92 * x, high = 1.055 * pow(max(x, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055;
    return vec3(x.r <= 0.0031308 ? low.r : high.r, x.g <= 0.0031308 ? low.g : high.g,
                x.b <= 0.0031308 ? low.b : high.b);
}

void main()
{
    vec4 picture = texelFetch(u_picture, ivec2(gl_FragCoord.xy), 0);
    if (u_plain == 0) {
        float exposure = u_exposure;
        vec2 mean = texelFetch(u_mean, ivec2(0), 0).rg, logs = texelFetch(u_logs, ivec2(0), 0).rg;
        if (u_auto != 0 && mean.x > 0.0 && mean.y > 0.0) {
            exposure *= 0.18 / exp(logs.x / logs.y);
        }
        picture.rgb = min(picture.rgb * exposure, 1e6);
        if (u_tone == 0) {
            picture.rgb = neutral_curve(picture.rgb);
        } else if (u_tone == 2) {
            picture.rgb /= 1.0 + max(dot(picture.rgb, vec3(0.2126, 0.7152, 0.0722)), 0.0);
        }
    }
    o_srgb = vec4(encode(picture.rgb), clamp(picture.a, 0.0, 1.0));
}
