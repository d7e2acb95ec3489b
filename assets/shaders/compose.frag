#version 450 core
// The light of one pixel: LAYERS layers, each with the mean over its SAMPLES samples, on top of what was CARRIED here from those before; and
// with FINISH what the projector is sent for it. All of these are known when it is compiled: a software OpenGL spends as much on counting a
// loop as on what it does.
//
// Layers make pictures, each from black, and the pictures' light adds up with a weight each. A layer l of light c and coverage a lies on a
// picture p as p (1 - l.x a - l.y c) + l.z c: the numbers are those of its blend mode, times its opacity.

#if LAYERS > 0
layout(binding = 0) uniform sampler2DMS roots[LAYERS];  // the square roots of linear light, and coverage
layout(location = 0) uniform vec3 blend[LAYERS];
layout(location = 4) uniform vec2 turn[LAYERS];  // before the layer: the weight of the picture that ends here, and 0 where one begins, else 1
#endif
#ifdef CARRIED
layout(binding = 4) uniform sampler2D carriedSum;
layout(binding = 5) uniform sampler2D carriedPicture;
#endif

#ifdef FINISH
layout(location = 8) uniform float weight;  // of the last picture
layout(location = 0) out vec4 colour;
#ifdef TINT
layout(location = 9) uniform vec3 tint;
#endif
#ifdef CUBE
layout(binding = 6) uniform sampler3D cube;      // of stored sRGB values
layout(location = 10) uniform vec3 cubeFrom[2];  // place in the texture = stored * [0] + [1]
#endif
#ifdef BLEND
layout(binding = 7) uniform sampler2D blendMap;  // light * x + y
#endif
#ifdef GAIN
layout(binding = 8) uniform sampler2D gainMap;   // what is left of the light where the surface would be brighter than elsewhere
layout(location = 13) uniform float gainShare;  // how far that is faded in, 0..1
#endif
#if defined(GAIN) || defined(BLEND)
layout(location = 14) uniform mat3 onMaps;  // from a pixel to its place in these maps, 0..1; all 0: the maps lie pixel on pixel
vec4 mapped(sampler2D map, ivec2 pixel) {
    if (onMaps[2].z == 0.0) return texelFetch(map, pixel, 0);
    vec3 at = onMaps * vec3(gl_FragCoord.xy, 1.0);
    return texture(map, at.xy / at.z);
}
#endif
#ifdef ENCODE
layout(location = 12) uniform float gamma;  // 0: the sRGB function
#endif
#else
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 picture;
#endif

vec3 srgbFromLinear(vec3 light) { return mix(1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, 12.92 * light, lessThan(light, vec3(0.0031308))); }
vec3 linearFromSrgb(vec3 stored) { return mix(pow((stored + 0.055) / 1.055, vec3(2.4)), stored / 12.92, lessThan(stored, vec3(0.04045))); }

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 light = vec3(0.0), top = vec3(0.0);
#ifdef CARRIED
    light = texelFetch(carriedSum, pixel, 0).rgb;
    top = texelFetch(carriedPicture, pixel, 0).rgb;
#endif
#if LAYERS > 0
    for (int layer = 0; layer < LAYERS; ++layer) {
        vec4 mean = vec4(0.0);
        for (int i = 0; i < SAMPLES; ++i) {
            vec4 root = texelFetch(roots[layer], pixel, i);
            mean += root * root;
        }
        mean /= float(SAMPLES);
        light += turn[layer].x * top;
        top = turn[layer].y * top * (1.0 - blend[layer].x * mean.a - blend[layer].y * mean.rgb) + blend[layer].z * mean.rgb;
    }
#endif
#ifdef FINISH
    light += weight * top;
#ifdef TINT
    light *= tint;
#endif
#ifdef CUBE
    light = linearFromSrgb(texture(cube, srgbFromLinear(clamp(light, 0.0, 1.0)) * cubeFrom[0] + cubeFrom[1]).rgb);
#endif
#ifdef GAIN
    light = clamp(light, 0.0, 1.0) * mix(1.0, mapped(gainMap, pixel).x, gainShare);
#endif
#ifdef BLEND
    // Cut before it is shared: what a projector alone cannot show two of them must not.
    vec2 share = mapped(blendMap, pixel).xy;
    light = clamp(light, 0.0, 1.0) * share.x + share.y;
#endif
#ifdef ENCODE
    light = clamp(light, 0.0, 1.0);
    vec3 stored = gamma > 0.0 ? pow(light, vec3(1.0 / max(gamma, 0.1))) : srgbFromLinear(light);
#ifdef DITHER
    // Rounded up in as many of the pixels around as the value lies above a step (interleaved gradient noise, Jimenez 2014), in other
    // pixels for each primary. Black stays black, and a value that can be stored is stored everywhere.
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    stored = (floor(stored * 255.0 + 0.002 + 0.996 * fract(noise + vec3(0.0, 1.0, 2.0) / 3.0))) / 255.0;
#endif
    light = stored;
#endif
    colour = vec4(light, 1.0);
#else
    sum = vec4(light, 1.0);
    picture = vec4(top, 1.0);
#endif
}
