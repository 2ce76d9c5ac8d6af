// mesh.glsl - vertex stage of shading: places corners on the picture.
// SPDX-License-Identifier: MIT
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec2 a_uv;
layout(location = 3) in vec3 a_chart; // colour of the chart
uniform mat4 u_clip;  // of points before they are placed
uniform mat4 u_model; // of the instance
out vec3 v_position, v_normal, v_chart;
out vec2 v_uv;

void main()
{
    v_position = (u_model * vec4(a_position, 1.0)).xyz;
    v_normal = mat3(u_model) * a_normal;
    v_uv = a_uv;
    v_chart = a_chart;
    gl_Position = u_clip * vec4(a_position, 1.0);
}
