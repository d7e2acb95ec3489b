#version 450 core
// The canvas as one rectangle, through the output's projective warp.

layout(location = 0) uniform mat3 clipFromCanvas;  // (x, y, w); the canvas is 0 .. 1 in both directions here

out vec2 onCanvas;

void main() {
    onCanvas = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec3 clip = clipFromCanvas * vec3(onCanvas, 1.0);
    gl_Position = vec4(clip.xy, 0.0, clip.z);
}
