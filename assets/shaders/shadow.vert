#version 450 core
// Throws a point from a light onto the screen, and the screen onto the output's picture. With INSIDE what is beyond its edges is cut off. With
// CURVED the screen is an upright cylinder, seen unrolled: theatre::Screen says how.

layout(location = 0) in vec4 position;  // metres, stage frame

layout(location = 0) uniform mat4x3 screenFromStage;  // (X, Y, W); W: metres from the light
layout(location = 1) uniform mat3 clipFromScreen;     // (x, y, w)
#ifdef INSIDE
layout(location = 3) uniform vec3 inside[4];  // dot with clip (x, y, w) is positive inside, before a mesh bends it
out float gl_ClipDistance[4];
#endif
#ifdef CURVED
layout(location = 7) uniform vec4 curve;  // the light, in the screen's frame, and the cylinder's radius; metres

// theatre::unrolledFromFlat().
vec2 unrolled(vec2 onFlat) {
    vec3 way = vec3(onFlat, 0.0) - curve.xyz;
    vec2 from = vec2(curve.x, curve.z - curve.w);
    float a = dot(way.xz, way.xz), b = dot(way.xz, from), c = dot(from, from) - curve.w * curve.w;
    float t = (sign(curve.w) * sqrt(max(b * b - a * c, 0.0)) - b) / a;
    vec2 hit = (from + t * way.xz) / curve.w;
    return vec2(curve.w * atan(hit.x, -hit.y), curve.y + t * way.y);
}
#endif

// What is nearer to the light than this throws no shadow that could be drawn.
const float nearest = 0.02;

invariant gl_Position;

void main() {
    vec3 thrown = screenFromStage * position;
#ifdef CURVED
    thrown.xy = thrown.z * unrolled(thrown.xy / thrown.z);
#endif
    vec3 clip = clipFromScreen * thrown;
    gl_Position = vec4(clip.xy, clip.z - nearest, clip.z);  // depth: 0 at the light, growing along each ray
#ifdef INSIDE
    for (int edge = 0; edge < 4; ++edge) gl_ClipDistance[edge] = dot(inside[edge], clip);
#endif
#ifdef BENT
    gl_Position = bent(gl_Position);
#endif
}
