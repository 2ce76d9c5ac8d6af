// arrays.glsl - long arrays folded into layers of 2048 x 512 texels, and vectors into rows of 2048; included by passes.
// SPDX-License-Identifier: MIT
const uint NONE = 0xFFFFFFFFu;
const float PI = 3.14159265358979;

ivec3 array_at(uint i)
{
    return ivec3(int(i & 2047u), int((i >> 11) & 511u), int(i >> 20));
}

ivec2 vector_at(uint i)
{
    return ivec2(int(i & 2047u), int(i >> 11));
}

// Which element of a vector this fragment makes.
uint vector_index()
{
    return uint(gl_FragCoord.y) * 2048u + uint(gl_FragCoord.x);
}

// Place of an atlas index v * size + u.
ivec2 atlas_at(uint i, uint size)
{
    return ivec2(int(i % size), int(i / size));
}
