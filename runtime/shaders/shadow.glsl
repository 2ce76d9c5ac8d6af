// shadow.glsl - nearest depth from a light, linear in space. C: cpu/cpu_lights.c.
// SPDX-License-Identifier: MIT
in float v_depth;

void main()
{
    gl_FragDepth = v_depth;
}
