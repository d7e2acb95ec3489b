#version 450 core
// How much of each pixel of a coarse picture is covered in a painted one: the mean alpha of BLOCK x BLOCK pixels of SAMPLES samples.

layout(local_size_x = 32) in;
layout(binding = 0) uniform sampler2DMS painted;
layout(binding = 0, r32f) uniform restrict writeonly image2D coverage;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(coverage)))) return;
    float sum = 0.0;
    for (int y = 0; y < BLOCK; ++y)
        for (int x = 0; x < BLOCK; ++x)
            for (int i = 0; i < SAMPLES; ++i) sum += texelFetch(painted, pixel * BLOCK + ivec2(x, y), i).a;
    imageStore(coverage, pixel, vec4(sum / float(BLOCK * BLOCK * SAMPLES)));
}
