#version 450 core
// The shown part of the canvas, through the output's projective warp: as one rectangle, or as CELLS x CELLS of them for a mesh to bend.

layout(location = 0) uniform mat3 clipFromCanvas;  // (x, y, w); the canvas is 0 .. 1 in both directions here
layout(location = 41) uniform vec4 part;           // of the canvas: left, top, width, height

out vec2 onCanvas;

void main() {
#ifdef BENT
    const int corners[6] = int[6](0, 1, 2, 1, 3, 2);
    int corner = corners[gl_VertexID % 6], cell = gl_VertexID / 6;
    vec2 onPart = vec2((cell % CELLS) + (corner & 1), (cell / CELLS) + (corner >> 1)) / CELLS;
#else
    vec2 onPart = vec2(gl_VertexID & 1, gl_VertexID >> 1);
#endif
    onCanvas = part.xy + part.zw * onPart;
    vec3 clip = clipFromCanvas * vec3(onCanvas, 1.0);
    gl_Position = vec4(clip.xy, 0.0, clip.z);
#ifdef BENT
    gl_Position = bent(gl_Position);
#endif
}
