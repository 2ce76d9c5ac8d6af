// rows.glsl - rows of an operator from their partial sums, added to what the target register holds.
// SPDX-License-Identifier: MIT
uniform usampler2DArray u_row_segment; // [row + 1]
uniform sampler2DArray u_scale;
uniform sampler2D u_partial;
uniform sampler2D u_base;
uniform int u_row_count;
layout(location = 0) out vec4 o_sum;

void main()
{
    uint row = vector_index();
    vec3 sum = vec3(0.0);
    o_sum = texelFetch(u_base, ivec2(gl_FragCoord.xy), 0);
    if (row < uint(u_row_count)) {
        uint last = texelFetch(u_row_segment, array_at(row + 1u), 0).r;
        for (uint s = texelFetch(u_row_segment, array_at(row), 0).r; s < last; s++) {
            sum += texelFetch(u_partial, vector_at(s), 0).rgb;
        }
        o_sum.rgb += sum * texelFetch(u_scale, array_at(row), 0).rgb;
    }
}
