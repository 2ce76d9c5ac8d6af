// occlusion.glsl - does anything stand between a point and a light? Walks lights/occluder_tree.h; included by
// passes. C: cpu/cpu_occlusion.c.
// SPDX-License-Identifier: MIT
uniform sampler2D u_tree;   // rows of 2048
uniform sampler2D u_caster; // rows of 4 texels: parian_caster
uniform int u_caster_count;
uniform int u_own_first, u_own_count;

const float BOX_GRID = 4096.0;

vec4 tree_element(uint i)
{
    return texelFetch(u_tree, vector_at(i), 0);
}

// Source  [MoellerTrumbore97]
bool meets_triangle(uint at, vec3 origin, vec3 direction, float far)
{
    vec3 a = tree_element(at + 1u).xyz, b = tree_element(at + 2u).xyz;
    vec3 p = cross(direction, b), s = origin - tree_element(at).xyz, q = cross(s, a);
    float det = dot(a, p);
    if (det == 0.0) {
        return false;
    }
    float u = dot(s, p) / det, v = dot(direction, q) / det, t = dot(b, q) / det;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < far;
}

// Boxes until the ray enters a leaf, then its triangles, and so on: neighbours that run in step wait for each other
// at leaves alone.
bool meets_caster(uint at, uint end, vec3 origin, vec3 direction, float far)
{
    if (at >= end) {
        return false;
    }
    vec3 scale = tree_element(at + 1u).xyz, inverse = direction * scale;
    vec3 start = (origin - tree_element(at).xyz) * scale;
    inverse = 1.0 / mix(inverse, vec3(1e-20), lessThan(abs(inverse), vec3(1e-20)));
    bool met = false;
    at += 2u;
    while (at < end && !met) {
        uint leaf = 0u, leaf_end = 0u;
        while (at < end && leaf == leaf_end) {
            vec4 box = tree_element(at);
            vec3 upper = floor(box.xyz * (1.0 / BOX_GRID)), lower = box.xyz - BOX_GRID * upper;
            vec3 a = (lower - start) * inverse, b = (upper - start) * inverse;
            vec3 first = min(a, b), last = max(a, b);
            float enter = max(max(first.x, first.y), max(first.z, 0.0));
            float leave = min(min(last.x, last.y), min(last.z, far));
            uint after = uint(abs(box.w));
            bool inside = enter <= leave, leafs = box.w < 0.0;
            leaf = at + 1u;
            leaf_end = inside && leafs ? after : leaf;
            at = inside && !leafs ? leaf : after;
        }
        for (; leaf < leaf_end && !met; leaf += 3u) {
            met = meets_triangle(leaf, origin, direction, far);
        }
    }
    return met;
}

// direction of any length, in the world: what counts is within `far` times that. own: the origin in the coordinates
// of the instance that it lies on, whose bodies are the casters from u_own_first on.
bool occluded(vec3 own, vec3 origin, vec3 direction, float far)
{
    for (int c = 0; c < u_caster_count; c++) {
        vec4 row_x = texelFetch(u_caster, ivec2(0, c), 0), row_y = texelFetch(u_caster, ivec2(1, c), 0);
        vec4 row_z = texelFetch(u_caster, ivec2(2, c), 0), range = texelFetch(u_caster, ivec2(3, c), 0);
        vec4 from = vec4(origin, 1.0);
        vec3 start = vec3(dot(row_x, from), dot(row_y, from), dot(row_z, from));
        vec3 along = vec3(dot(row_x.xyz, direction), dot(row_y.xyz, direction), dot(row_z.xyz, direction));
        if (c >= u_own_first && c < u_own_first + u_own_count) {
            start = own; // without the rounding of there and back
        }
        if (meets_caster(uint(range.x), uint(range.y), start, along, far)) {
            return true;
        }
    }
    return false;
}
