#version 450 core
// What is seen of the screen: what is left of the lamps' light, where there is any. SAMPLES is defined.

in vec2 onCanvas;
layout(location = 1) uniform vec3 dark;    // in full shadow
layout(location = 2) uniform vec3 bright;  // what the lamps add to that where nobody is before them
layout(location = 3) uniform vec4 lit;     // the part of the canvas that is lit at all: left, top, right, bottom
layout(binding = 0) uniform sampler2DMS taken;
layout(location = 0) out vec4 root;  // as a layer picture holds it

// What is left after many small parts were taken away may be rounding: less than this share of the whole is nothing.
const float least = 0.002;

void main() {
    vec3 gone = vec3(0.0);
    for (int i = 0; i < SAMPLES; ++i) gone += texelFetch(taken, ivec2(gl_FragCoord.xy), i).rgb;
    vec3 rest = bright - gone / float(SAMPLES);
    rest *= step(least * abs(bright), abs(rest));
    // The edge of the lit part goes through its pixels as smoothly as any other.
    vec2 pixel = max(fwidth(onCanvas), 1e-6);
    vec2 within = clamp((onCanvas - lit.xy) / pixel + 0.5, 0.0, 1.0) * clamp((lit.zw - onCanvas) / pixel + 0.5, 0.0, 1.0);
    root = vec4(sqrt(max(within.x * within.y * (dark + rest), 0.0)), 1.0);
}
