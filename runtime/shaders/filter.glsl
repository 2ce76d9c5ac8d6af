// filter.glsl - local part from the kernel of each texel, global part from its vertices. C: cpu/cpu_transfer.c.
// SPDX-License-Identifier: MIT
uniform usampler2D u_info;            // three vertices; interior ordinal, or border ordinal with bit 31
uniform sampler2D u_barycentric;
uniform sampler2D u_irradiance;
uniform sampler2D u_vertex;           // B at vertices
uniform sampler2DArray u_kernel;      // [tap][interior texel]
uniform usampler2DArray u_border;     // [border + 1] offset of the list
uniform usampler2DArray u_neighbour;  // atlas index
uniform sampler2DArray u_border_kernel;
uniform int u_width;                  // of the window; 0: no local part
uniform int u_interior_count;
uniform int u_atlas_size;
uniform vec3 u_channel_scale;
layout(location = 0) out vec4 o_local;
layout(location = 1) out vec4 o_global;

vec3 filter_window(ivec2 at, uint interior)
{
    vec3 sum = vec3(0.0);
    uint tap = interior;
    for (int dv = 0; dv < u_width; dv++) {
        for (int du = 0; du < u_width; du++, tap += uint(u_interior_count)) {
            vec3 e = texelFetch(u_irradiance, at + ivec2(du, dv) - u_width / 2, 0).rgb;
            sum += texelFetch(u_kernel, array_at(tap), 0).rgb * e;
        }
    }
    return sum;
}

vec3 filter_list(uint border)
{
    vec3 sum = vec3(0.0);
    uint last = texelFetch(u_border, array_at(border + 1u), 0).r;
    for (uint k = texelFetch(u_border, array_at(border), 0).r; k < last; k++) {
        uint source = texelFetch(u_neighbour, array_at(k), 0).r;
        vec3 e = texelFetch(u_irradiance, atlas_at(source, uint(u_atlas_size)), 0).rgb;
        sum += texelFetch(u_border_kernel, array_at(k), 0).rgb * e;
    }
    return sum;
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    uvec4 info = texelFetch(u_info, at, 0);
    o_local = vec4(0.0);
    o_global = vec4(0.0);
    if (info.x == NONE) {
        return;
    }
    vec2 beta = texelFetch(u_barycentric, at, 0).rg;
    o_global.rgb = beta.x * texelFetch(u_vertex, vector_at(info.x), 0).rgb +
                   beta.y * texelFetch(u_vertex, vector_at(info.y), 0).rgb +
                   (1.0 - beta.x - beta.y) * texelFetch(u_vertex, vector_at(info.z), 0).rgb;
    if (u_width > 0) {
        bool border = (info.w & 0x80000000u) != 0u;
        vec3 sum = border ? filter_list(info.w & 0x7FFFFFFFu) : filter_window(at, info.w);
        o_local.rgb = sum * u_channel_scale;
    }
}
