#version 450 core
// The light of one facet.

flat in vec3 facetLight;  // linear
layout(location = 0) out vec4 colour;

void main() { colour = vec4(facetLight, 1.0); }
