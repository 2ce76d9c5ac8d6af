// restrict.glsl - flux and direct radiosity at each vertex from E at its texels. C: cpu/cpu_transfer.c.
// SPDX-License-Identifier: MIT
uniform usampler2DArray u_offset; // [vertex + 1]
uniform usampler2DArray u_feed;   // atlas index, bits of the flux weight
uniform sampler2DArray u_weight;  // blending weight
uniform sampler2D u_irradiance;
uniform int u_vertex_count;
uniform int u_atlas_size;
uniform int u_weighted;
layout(location = 0) out vec4 o_flux;
layout(location = 1) out vec4 o_direct;

void main()
{
    uint v = vector_index();
    vec3 flux = vec3(0.0), direct = vec3(0.0);
    if (v < uint(u_vertex_count)) {
        uint last = texelFetch(u_offset, array_at(v + 1u), 0).r;
        for (uint k = texelFetch(u_offset, array_at(v), 0).r; k < last; k++) {
            uvec2 feed = texelFetch(u_feed, array_at(k), 0).rg;
            vec3 e = texelFetch(u_irradiance, atlas_at(feed.x, uint(u_atlas_size)), 0).rgb;
            flux += uintBitsToFloat(feed.y) * e;
            if (u_weighted != 0) {
                direct += texelFetch(u_weight, array_at(k), 0).rgb * e;
            }
        }
    }
    o_flux = vec4(flux, 1.0);
    o_direct = vec4(direct, 1.0);
}
