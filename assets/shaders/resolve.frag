#version 450 core
// The light of one pixel of a layer: the mean over its samples, which hold the square roots of linear light.

layout(binding = 0) uniform sampler2DMS roots;
layout(location = 0) uniform float opacity;
layout(location = 0) out vec4 colour;  // linear; OpenGL stores it as sRGB

void main() {
    int samples = textureSamples(roots);
    vec3 light = vec3(0.0);
    for (int i = 0; i < samples; ++i) {
        vec3 root = texelFetch(roots, ivec2(gl_FragCoord.xy), i).rgb;
        light += root * root;
    }
    colour = vec4(light * (opacity / float(samples)), 1.0);
}
