#version 450 core
// One pass of a convolution by fast Fourier transform, in place: a butterfly of RADIX points, which stand span / RADIX apart in one row or
// one column of the field. The passes of one transform have the spans N, N / R1, N / (R1 R2), ..., each the product of the radices to
// come; the inverse goes the same way back, so that nothing is ever brought into order: the filter's spectrum stands in the same disorder.
//
// A point of the field holds four real numbers, which are the picture's quarters, two to a complex number: a real filter keeps them apart.
//
// RADIX is defined, and what the pass does besides, all of it forward or INVERSE: SOURCE reads the picture; FILTER is the last pass forward, the product with the filter's spectrum, and the first pass back; SINK writes the
// blurred picture.

layout(local_size_x = 32) in;
layout(binding = 0, rgba32f) uniform restrict image2D field;

layout(location = 0) uniform ivec2 along;   // (1, 0) in rows, (0, 1) in columns
layout(location = 1) uniform int span;
layout(location = 2) uniform ivec2 count;   // butterflies in each dimension
layout(location = 3) uniform ivec2 quarter;  // where the last quarter begins
#ifdef SOURCE
layout(binding = 0) uniform sampler2D picture;
#endif
#ifdef FILTER
layout(binding = 0) uniform sampler2D spectrum;
#endif
#ifdef SINK
layout(binding = 1, r32f) uniform restrict writeonly image2D blurred;
layout(location = 4) uniform ivec2 margin;       // of the field's quarters around those of the picture
layout(location = 5) uniform vec2 fromCoverage;  // what is written: x + y * the blurred value
#endif

const float turn = 6.283185307179586;
const int half_ = (RADIX - 1) / 2;

vec2 times(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }
vec4 times(vec4 a, vec2 b) { return vec4(times(a.xy, b), times(a.zw, b)); }
vec4 timesI(vec4 a) { return vec4(-a.y, a.x, -a.w, a.z); }

// The Fourier transform of RADIX points; `sign` is that of the exponent. Points k and RADIX - k share their sums, and all cosines are
// constants.
void transform(inout vec4 v[RADIX], float sign) {
    vec4 even[half_ + 1], odd[half_ + 1];
    for (int j = 1; j <= half_; ++j) {
        even[j] = v[j] + v[RADIX - j];
        odd[j] = v[j] - v[RADIX - j];
    }
    vec4 first = v[0], middle = v[RADIX / 2];
    for (int k = 0; k <= RADIX / 2; ++k) {
        vec4 cosines = first, sines = vec4(0.0);
        for (int j = 1; j <= half_; ++j) {
            cosines += even[j] * cos(turn * float(j * k % RADIX) / float(RADIX));
            sines += odd[j] * sin(turn * float(j * k % RADIX) / float(RADIX));
        }
        if (RADIX % 2 == 0) cosines += k % 2 == 0 ? middle : -middle;
        vec4 turned = sign * timesI(sines);
        v[k] = cosines + turned;
        if (k > 0 && 2 * k < RADIX) v[RADIX - k] = cosines - turned;
    }
}

// The twiddle factors of a butterfly whose first point is the `place`th of its span.
void twiddle(inout vec4 v[RADIX], int place, float sign) {
    float angle = sign * turn * float(place) / float(span);
    vec2 step = vec2(cos(angle), sin(angle)), factor = step;
    for (int k = 1; k < RADIX; ++k) {
        v[k] = times(v[k], factor);
        factor = times(factor, step);
    }
}

#ifdef SOURCE
float valueAt(ivec2 pixel) {
    return all(lessThan(pixel, textureSize(picture, 0))) ? texelFetch(picture, pixel, 0).r : 0.0;
}
#endif

#ifdef SINK
void write(ivec2 pixel, float value) {
    if (all(lessThan(pixel, imageSize(blurred)))) imageStore(blurred, pixel, vec4(max(fromCoverage.x + fromCoverage.y * value, 0.0)));
}
#endif

void main() {
    ivec2 butterfly = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(butterfly, count))) return;
    ivec2 across = 1 - along;
    int number = butterfly.x * along.x + butterfly.y * along.y, apart = span / RADIX, place = number % apart;
    ivec2 first = butterfly * across + along * (number / apart * span + place), stride = along * apart;

    vec4 v[RADIX];
    for (int j = 0; j < RADIX; ++j) {
        ivec2 point = first + j * stride;
#ifdef SOURCE
        v[j] = vec4(valueAt(point), valueAt(point + quarter * ivec2(1, 0)), valueAt(point + quarter * ivec2(0, 1)),
                    valueAt(point + quarter));
#else
        v[j] = imageLoad(field, point);
#endif
    }
#if defined(FILTER)
    transform(v, -1.0);
    for (int j = 0; j < RADIX; ++j) v[j] = times(v[j], texelFetch(spectrum, first + j * stride, 0).xy);
    transform(v, 1.0);
#elif defined(INVERSE)
    twiddle(v, place, 1.0);
    transform(v, 1.0);
#else
    transform(v, -1.0);
    twiddle(v, place, -1.0);
#endif
    for (int j = 0; j < RADIX; ++j) {
        ivec2 point = first + j * stride;
#ifdef SINK
        point -= margin;
        if (any(lessThan(point, ivec2(0))) || any(greaterThanEqual(point, quarter))) continue;
        write(point, v[j].x);
        write(point + quarter * ivec2(1, 0), v[j].y);
        write(point + quarter * ivec2(0, 1), v[j].z);
        write(point + quarter, v[j].w);
#else
        imageStore(field, point, v[j]);
#endif
    }
}
