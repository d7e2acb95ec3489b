#version 450 core
// The light of one point of the canvas: between dark and bright, by the product of what LAYERS pictures of the canvas let through; and, with
// SHARP, of what SAMPLES samples a pixel of a painted picture leave uncovered.

in vec2 onCanvas;
layout(location = 1) uniform vec3 dark;
layout(location = 2) uniform vec3 bright;
#if LAYERS > 0
layout(location = 3) uniform vec4 place[LAYERS];  // of the canvas in the picture: scale, then offset
layout(binding = 1) uniform sampler2D through[LAYERS];
#endif
#ifdef SHARP
layout(binding = 0) uniform sampler2DMS painted;
#endif
layout(location = 0) out vec4 root;  // as a layer picture holds it

void main() {
    float light = 1.0;
#if LAYERS > 0
    for (int i = 0; i < LAYERS; ++i) light *= texture(through[i], onCanvas * place[i].xy + place[i].zw).r;
#endif
#ifdef SHARP
    float covered = 0.0;
    for (int i = 0; i < SAMPLES; ++i) covered += texelFetch(painted, ivec2(gl_FragCoord.xy), i).a;
    light *= 1.0 - covered / float(SAMPLES);
#endif
    root = vec4(sqrt(mix(dark, bright, light)), 1.0);
}
