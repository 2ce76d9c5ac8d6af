// luminance.glsl - sums over 8 x 8 blocks: luminance, then its logarithm. C: cpu/cpu_tone.c.
// SPDX-License-Identifier: MIT
uniform sampler2D u_from;
uniform sampler2D u_mean; // sum of luminance, coverage
uniform int u_mode;       // 0: luminance of a picture, 1: its logarithm, 2: sums of sums
layout(location = 0) out vec4 o_sum;

void main()
{
    ivec2 base = ivec2(gl_FragCoord.xy) * 8, size = textureSize(u_from, 0);
    vec2 sum = vec2(0.0);
    float least = 1e-30;
    if (u_mode == 1) {
        vec2 mean = texelFetch(u_mean, ivec2(0), 0).rg;
        least = max(1e-3 * mean.x / max(mean.y, 1e-30), least);
    }
    for (int y = base.y; y < min(base.y + 8, size.y); y++) {
        for (int x = base.x; x < min(base.x + 8, size.x); x++) {
            vec4 value = texelFetch(u_from, ivec2(x, y), 0);
            if (u_mode == 2) {
                sum += value.rg;
                continue;
            }
            float luminance = dot(value.rgb, vec3(0.2126, 0.7152, 0.0722));
            float term = u_mode == 1 ? log(max(luminance, least)) : luminance;
            sum += value.a > 0.0 ? vec2(value.a * term, value.a) : vec2(0.0);
        }
    }
    o_sum = vec4(sum, 0.0, 1.0);
}
