#version 450 core
// Throws a point from a light onto the screen, and the screen onto the output's picture.

layout(location = 0) in vec4 position;  // metres, stage frame

layout(location = 0) uniform mat4x3 screenFromStage;  // (X, Y, W); W: metres from the light
layout(location = 1) uniform mat3 clipFromScreen;     // (x, y, w)

// What is nearer to the light than this throws no shadow that could be drawn.
const float nearest = 0.02;

invariant gl_Position;

void main() {
    vec3 clip = clipFromScreen * (screenFromStage * position);
    gl_Position = vec4(clip.xy, clip.z - nearest, clip.z);  // depth: 0 at the light, growing along each ray
#ifdef BENT
    gl_Position = bent(gl_Position);
#endif
}
