#version 450 core
// One point of a grid of rays that fall straight down through a wavy surface of water, where it meets the floor. Lengths are canvas
// heights, y down. WAVES is defined.

layout(location = 0) uniform int columns;    // of the grid's points
layout(location = 1) uniform vec4 grid;      // its first point, then the steps
layout(location = 2) uniform float aspect;   // the canvas's
layout(location = 3) uniform vec4 waves[WAVES];  // wave vector, strength, phase: see Water

out float spread;  // how much larger the picture of a small piece of the surface is than the piece; below 0 it is turned over

void main() {
    vec2 surface = grid.xy + grid.zw * vec2(gl_VertexID % columns, gl_VertexID / columns);
    vec2 floor_ = surface;
    float xx = 1.0, yy = 1.0, xy = 0.0;
    for (int i = 0; i < WAVES; ++i) {
        vec2 k = waves[i].xy;
        float angle = dot(k, surface) + waves[i].w, bend = waves[i].z * cos(angle);
        floor_ -= waves[i].z * sin(angle) * k;
        xx -= bend * k.x * k.x;
        yy -= bend * k.y * k.y;
        xy -= bend * k.x * k.y;
    }
    spread = xx * yy - xy * xy;
    gl_Position = vec4(2.0 * floor_ / vec2(aspect, 1.0) - 1.0, 0.0, 1.0);
}
