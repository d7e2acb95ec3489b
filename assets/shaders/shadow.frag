#version 450 core
// A shadow's colour: what it looks like, or what it takes away.

layout(location = 2) uniform vec3 shadow;
layout(location = 0) out vec4 colour;

void main() { colour = vec4(shadow, 1.0); }
