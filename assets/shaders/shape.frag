#version 450 core
// One facet.

flat in vec3 facetRoot;
layout(location = 0) out vec4 root;

void main() { root = vec4(facetRoot, 1.0); }
