#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace fantascope::theatre {

// The point of a triangle that is nearest to p: Ericson 2005, section 5.1.5.
glm::dvec3 nearestOf(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

// On which side of the line from a to b the origin is; of a point on it the same for both of the
// triangles that share the edge, so that a ray through an edge meets one of them.
int sideOf(glm::dvec2 a, glm::dvec2 b);

}  // namespace fantascope::theatre
