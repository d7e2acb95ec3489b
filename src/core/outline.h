#pragma once

#include "core/mesh.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <vector>

namespace fantascope {

// A flat region: the points that an odd number of its rings run around, so that a ring inside another is a hole. x right, y up.
struct Outline {
    std::vector<std::vector<glm::dvec2>> rings;  // closed; the first point is not repeated

    std::size_t pointCount() const;
};

// With few points: the outline stays within `tolerance` of what it was, or farther if that is what it takes to have at most `most`
// points, > 0. What is narrower may go, and rings that lie closer may cross. The unit is that of the points.
Outline simplified(const Outline& outline, double tolerance, std::size_t most);

// The region as triangles in z = 0, anticlockwise as seen from +z; none if it has no area.
TriangleMesh filled(const Outline& outline);

}  // namespace fantascope
