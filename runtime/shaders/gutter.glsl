// gutter.glsl - results for display: owned texels as they are, gutter texels from the surface across
// the seam; alpha tells where there is a value. C: method/atlas_fill.c.
// SPDX-License-Identifier: MIT
uniform usampler2D u_info;          // x: NONE where not owned; then y: gutter ordinal or NONE
uniform usampler2DArray u_source;   // [gutter] four atlas indices
uniform sampler2DArray u_weight;    // [gutter] four weights
uniform sampler2D u_irradiance;
uniform sampler2D u_local;
uniform sampler2D u_global;
uniform int u_atlas_size;
layout(location = 0) out vec4 o_irradiance;
layout(location = 1) out vec4 o_local;
layout(location = 2) out vec4 o_global;
layout(location = 3) out vec4 o_radiosity; // their sum, where a host wants it

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    uvec4 info = texelFetch(u_info, at, 0);
    o_irradiance = vec4(0.0);
    o_local = vec4(0.0);
    o_global = vec4(0.0);
    if (info.x != NONE) {
        o_irradiance = vec4(texelFetch(u_irradiance, at, 0).rgb, 1.0);
        o_local = vec4(texelFetch(u_local, at, 0).rgb, 1.0);
        o_global = vec4(texelFetch(u_global, at, 0).rgb, 1.0);
    } else if (info.y != NONE) {
        uvec4 source = texelFetch(u_source, array_at(info.y), 0);
        vec4 weight = texelFetch(u_weight, array_at(info.y), 0);
        for (int s = 0; s < 4; s++) {
            ivec2 from = atlas_at(source[s], uint(u_atlas_size));
            o_irradiance.rgb += weight[s] * texelFetch(u_irradiance, from, 0).rgb;
            o_local.rgb += weight[s] * texelFetch(u_local, from, 0).rgb;
            o_global.rgb += weight[s] * texelFetch(u_global, from, 0).rgb;
        }
        o_irradiance.a = 1.0;
        o_local.a = 1.0;
        o_global.a = 1.0;
    }
    o_radiosity = vec4(o_local.rgb + o_global.rgb, o_global.a);
}
