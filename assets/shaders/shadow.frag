#version 450 core
// The light that a shadow takes away.

layout(location = 2) uniform vec3 taken;
layout(location = 0) out vec4 sum;

void main() { sum = vec4(taken, 1.0); }
