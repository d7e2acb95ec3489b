#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace fantascope::theatre {

// The point of a triangle that is nearest to p: Ericson 2005, section 5.1.5.
glm::dvec3 nearestOf(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

// The side of the line from a to b on which the origin lies, as a sign. If the origin lies on the
// line, ties are broken consistently for both triangles that share the edge, so that a ray through
// an edge meets exactly one of them.
int sideOf(glm::dvec2 a, glm::dvec2 b);

}  // namespace fantascope::theatre
