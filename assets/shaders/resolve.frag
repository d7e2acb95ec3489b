#version 450 core
// The light of one pixel of all layers: of each the mean over its samples, which hold the square roots of linear light, and the sum over
// the layers. LAYERS and SAMPLES are known when it is compiled: a software OpenGL spends as much on counting a loop as on what it does.

layout(binding = 0) uniform sampler2DMS roots[LAYERS];
layout(location = 0) uniform float opacity[LAYERS];
layout(location = 0) out vec4 colour;  // linear; OpenGL stores it as sRGB

void main() {
    vec3 sum = vec3(0.0);
    for (int layer = 0; layer < LAYERS; ++layer) {
        vec3 light = vec3(0.0);
        for (int i = 0; i < SAMPLES; ++i) {
            vec3 root = texelFetch(roots[layer], ivec2(gl_FragCoord.xy), i).rgb;
            light += root * root;
        }
        sum += light * (opacity[layer] / float(SAMPLES));
    }
    colour = vec4(sum, 1.0);
}
