// resolve.glsl - a pixel is the mean of its samples. C: cpu/cpu_tone.c.
// SPDX-License-Identifier: MIT
uniform sampler2D u_samples;
uniform int u_side; // samples along a side of a pixel
layout(location = 0) out vec4 o_picture;

void main()
{
    ivec2 base = ivec2(gl_FragCoord.xy) * u_side;
    vec4 sum = vec4(0.0);
    for (int k = 0; k < u_side * u_side; k++) {
        sum += texelFetch(u_samples, base + ivec2(k % u_side, k / u_side), 0);
    }
    o_picture = sum / float(u_side * u_side);
}
