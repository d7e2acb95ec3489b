#version 450 core
// Places one instance of an elemental shape in the output's picture, straight through the output's projective warp.

layout(location = 0) in vec3 position;       // in the shape's frame
layout(location = 1) in vec3 normal;         // of the facet whose last corner this is; zero on flat shapes
layout(location = 2) in mat4 clipFromShape;  // this and the rest: of the instance
layout(location = 6) in vec3 towardsLight;   // in the shape's frame
layout(location = 7) in vec3 colour;         // linear light

layout(location = 0) uniform vec3 inside[4];  // the edges of what is shown: dot with clip (x, y, w) is positive inside, before a mesh bends it

out float gl_ClipDistance[4];
flat out vec3 facetRoot;  // of the triangle's last corner: what the layer picture holds, the square root of linear light

// A facet that faces away from the light keeps this share of its colour: enough to tell facets apart, never a black hole in the drawing.
const float darkest = 0.75;

void main() {
    gl_Position = clipFromShape * vec4(position, 1.0);
    for (int edge = 0; edge < 4; ++edge) gl_ClipDistance[edge] = dot(inside[edge], gl_Position.xyw);
#ifdef BENT
    gl_Position = bent(gl_Position);
#endif

    // Open meshes show both sides: the side that is seen counts as the outside. Depth falls towards the viewer.
    vec3 away = vec3(clipFromShape[0].z, clipFromShape[1].z, clipFromShape[2].z);
    float facing = dot(away, normal) > 0.0 ? -1.0 : 1.0;
    float lit = max(facing * dot(towardsLight, normal), 0.0);
    float shade = 1.0 - (1.0 - darkest) * (dot(normal, normal) - lit);  // 1 without a normal
    facetRoot = sqrt(shade * colour);
}
