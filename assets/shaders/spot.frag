#version 450 core
// A point of a mirror ball's spot: the share of the lamp that is seen from it in the facet, as if the nearest edge were the only one.

flat in mat2 facet;
flat in float light;
in vec2 place;
layout(location = 0) out float spot;

// To the segment from -along to along about `middle`, squared.
float squaredTo(vec2 middle, vec2 along) {
    vec2 from = place - middle;
    vec2 off = from - along * clamp(dot(from, along) / dot(along, along), -1.0, 1.0);
    return dot(off, off);
}

void main() {
    float near = min(min(squaredTo(facet[1], facet[0]), squaredTo(-facet[1], facet[0])),
                     min(squaredTo(facet[0], facet[1]), squaredTo(-facet[0], facet[1])));
    vec2 within = abs(inverse(facet) * place);
    float outside = clamp(max(within.x, within.y) > 1.0 ? sqrt(near) : -sqrt(near), -1.0, 1.0);
    spot = light * (acos(outside) - outside * sqrt(1.0 - outside * outside)) / 3.14159265;
}
