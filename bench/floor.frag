#version 450 core
// One colour an instance, see floor.vert.

flat in vec3 light;
layout(location = 0) out vec4 pixel;

void main() { pixel = vec4(light, 1.0); }
