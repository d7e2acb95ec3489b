#version 450 core
// A picture in the projector's own pixels, over what is there: stored values, multiplied by alpha, row 0 at the top.

layout(binding = 0) uniform sampler2D picture;
layout(location = 0) out vec4 colour;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    colour = texelFetch(picture, ivec2(pixel.x, textureSize(picture, 0).y - 1 - pixel.y), 0);
}
