#version 450 core
// The least that places an instance: what outputs_bench compares our frame with.

layout(location = 0) in vec3 position;
layout(location = 1) in mat4 clipFromShape;
layout(location = 5) in vec3 colour;

flat out vec3 light;

void main() {
    gl_Position = clipFromShape * vec4(position, 1.0);
    light = colour;
}
