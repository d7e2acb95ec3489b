#version 450 core
// One facet, in the layer picture's square roots of linear light.

flat in vec3 facetColour;  // linear light
layout(location = 0) out vec4 root;

void main() { root = vec4(sqrt(facetColour), 1.0); }
