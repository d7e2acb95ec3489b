#version 450 core
// What is seen of a shadow theatre's screen: lamps' light where there is any, and, with TAKEN, without what shadows take away of it, which SAMPLES samples a
// pixel of a painted picture say. With CURVED the canvas is an upright cylinder, unrolled: theatre::Screen says how.

in vec2 onCanvas;
layout(location = 1) uniform vec3 dark;    // in full shadow
layout(location = 2) uniform vec3 bright;  // what the lamps add to that where nobody is before them
layout(location = 3) uniform vec4 lit;     // the part of the flat screen that is lit at all: from x, y, to x, y; metres
layout(location = 4) uniform vec4 screen;  // the canvas: from x, y, to x, y; metres
#ifdef CURVED
layout(location = 5) uniform vec4 curve;  // the first lamp, in the screen's frame, and the cylinder's radius; metres
#endif
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
    vec2 place = vec2(mix(screen.x, screen.z, onCanvas.x), mix(screen.w, screen.y, onCanvas.y));
    float reached = 1.0;
#ifdef CURVED
    // theatre::flatFromUnrolled(): a surface that is turned away is dark.
    float angle = place.x / curve.w, rise = sin(0.5 * angle);
    vec3 toLight = curve.xyz - vec3(curve.w * sin(angle), place.y, 2.0 * curve.w * rise * rise);
    reached = step(abs(angle), MOST_ARC) * step(0.0, toLight.z * cos(angle) - toLight.x * sin(angle)) * step(1e-6, toLight.z);
    place = curve.xy - curve.z / max(toLight.z, 1e-6) * toLight.xy;
#endif
    // The edge of the lit part goes through its pixels as smoothly as any other.
    vec2 pixel = max(fwidth(place), 1e-6);
    vec2 within = reached * clamp((place - lit.xy) / pixel + 0.5, 0.0, 1.0) * clamp((lit.zw - place) / pixel + 0.5, 0.0, 1.0);
    root = vec4(sqrt(max(within.x * within.y * (dark + rest), 0.0)), 1.0);
}
