#version 450 core
// What is seen of a shadow theatre's screen: lamps' light where there is any, and, with TAKEN, without what shadows take away of it, which SAMPLES samples a
// pixel of a painted picture say.

in vec2 onCanvas;
layout(location = 1) uniform vec3 dark;    // in full shadow
layout(location = 2) uniform vec3 bright;  // what the lamps add to that where nobody is before them
layout(location = 3) uniform vec4 lit;     // the part of the canvas that is lit at all: left, top, right, bottom
#ifdef TAKEN
layout(binding = 0) uniform sampler2DMS taken;
#endif
layout(location = 0) out vec4 root;  // as a layer picture holds it

// What is left after many small parts were taken away may be rounding: less than this share of the whole is nothing.
const float least = 0.0001;

void main() {
    vec3 rest = bright;
#ifdef TAKEN
    vec3 gone = vec3(0.0);
    for (int i = 0; i < SAMPLES; ++i) gone += texelFetch(taken, ivec2(gl_FragCoord.xy), i).rgb;
    rest -= gone / float(SAMPLES);
    rest *= step(least * abs(bright), abs(rest));
#endif
    // The edge of the lit part goes through its pixels as smoothly as any other.
    vec2 pixel = max(fwidth(onCanvas), 1e-6);
    vec2 within = clamp((onCanvas - lit.xy) / pixel + 0.5, 0.0, 1.0) * clamp((lit.zw - onCanvas) / pixel + 0.5, 0.0, 1.0);
    root = vec4(sqrt(max(within.x * within.y * (dark + rest), 0.0)), 1.0);
}
