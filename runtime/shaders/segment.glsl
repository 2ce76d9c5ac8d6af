// segment.glsl - partial sums of an operator's rows, up to 256 factors each. C: formats/core/operator.h.
// SPDX-License-Identifier: MIT
uniform usampler2DArray u_segment; // first run, number of runs, first factor
uniform usampler2DArray u_run;     // first column, number of columns
uniform sampler2DArray u_factor;
uniform sampler2D u_source;
uniform int u_segment_count;
layout(location = 0) out vec4 o_partial;

void main()
{
    uint s = vector_index();
    vec3 sum = vec3(0.0);
    if (s < uint(u_segment_count)) {
        uvec3 segment = texelFetch(u_segment, array_at(s), 0).rgb;
        uint factor = segment.z;
        for (uint r = segment.x; r < segment.x + segment.y; r++) {
            uvec2 run = texelFetch(u_run, array_at(r), 0).rg;
            for (uint k = 0u; k < run.y; k++, factor++) {
                sum += texelFetch(u_factor, array_at(factor), 0).rgb *
                       texelFetch(u_source, vector_at(run.x + k), 0).rgb;
            }
        }
    }
    o_partial = vec4(sum, 1.0);
}
