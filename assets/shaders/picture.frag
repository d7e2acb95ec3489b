#version 450 core
// A picture on the canvas: its light, as much of it as its alpha lets be. A pixel takes the mean over what of the picture it covers: bilinear
// taps, each of which stands for one texel's area, next to each other along both of the pixel's sides. An OpenGL's own anisotropic filter
// would do, if they were all alike and none blurred. Where a pixel covers more than MOST texels a side, the taps go to coarser levels.

in vec2 onCanvas;
layout(binding = 0) uniform sampler2D picture;  // light multiplied by alpha, and alpha
layout(location = 0) out vec4 root;             // as a layer picture holds it

void main() {
    vec2 size = vec2(textureSize(picture, 0));
    vec2 right = dFdx(onCanvas), down = dFdy(onCanvas);
    vec2 texels = vec2(length(right * size), length(down * size));  // along the pixel's sides
    float level = max(0.0, log2(max(texels.x, texels.y) / float(MOST)));
    texels = max(texels / exp2(level), 1.0);
    ivec2 taps = ivec2(ceil(texels - 0.01));
    // The outermost taps' texels end where the pixel does.
    vec2 reach = (texels - 1.0) / texels, between = reach / vec2(max(taps - 1, 1));
    vec2 first = onCanvas - 0.5 * (reach.x * right + reach.y * down);
    vec4 light = vec4(0.0);
    for (int y = 0; y < taps.y; ++y)
        for (int x = 0; x < taps.x; ++x)
            light += textureLod(picture, first + float(x) * between.x * right + float(y) * between.y * down, level);
    light /= float(taps.x * taps.y);
    root = sqrt(light);
}
