// caster.glsl - vertex stage of the shadow pass: puts corners on a shadow map.
// SPDX-License-Identifier: MIT
layout(location = 0) in vec3 a_position;
uniform vec4 u_row[4]; // x, y, linear depth, w
uniform vec4 u_fit;    // -, perspective, near, far
out float v_depth;

void main()
{
    vec4 p = vec4(a_position, 1.0);
    float w = dot(u_row[3], p);
    v_depth = dot(u_row[2], p);
    // z serves clipping alone: what is stored is the linear depth.
    float z = u_fit.y > 0.5 ? ((u_fit.w + u_fit.z) * w - 2.0 * u_fit.w * u_fit.z) / (u_fit.w - u_fit.z)
                            : 2.0 * v_depth - 1.0;
    gl_Position = vec4(dot(u_row[0], p), dot(u_row[1], p), z, w);
}
