#pragma once

#include "media/image.h"
#include "media/mesh.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <vector>

namespace fantascope {

// A flat region: the points inside an odd number of rings, so that a ring inside another is a hole.
// x right, y up.
struct Outline {
    std::vector<std::vector<glm::dvec2>> rings;  // closed; the first point is not repeated

    std::size_t pointCount() const;
};

// Reduces the points: the outline stays within `tolerance` of the original, or farther if that is
// needed to have at most `maxPoints` points, > 0. Narrower parts may vanish, and rings that are
// closer may cross. Units are those of the points.
Outline simplified(const Outline& outline, double tolerance, std::size_t maxPoints);

// The region as triangles in z = 0, anticlockwise as seen from +z; empty if it has no area.
TriangleMesh filled(const Outline& outline);

// Triangles in a plane, each oriented from the x axis towards the y axis.
struct FlatMesh {
    std::vector<glm::dvec2> vertices;
    std::vector<glm::uvec3> triangles;  // indices into vertices
};

// The region as triangles that bend well: no edge is longer than `maxEdge`, > 0, and no angle is
// below 20 degrees, except where the outline has a sharper angle or rings nearly touch. Points are
// added on the outline, inside, and where rings cross (Shewchuk 2002).
FlatMesh meshed(const Outline& outline, double maxEdge);

// The borders of the regions lighter than a half, in pixels, x right, y down; they run where the
// light passes a half between two pixel centres. The outside of the picture is dark. Rings do not
// touch. Rings around an island run clockwise as seen, those around a hole anticlockwise.
Outline tracedBorders(const GreyImage& picture);

// The share of each pixel with a nonzero winding number, so that overlaps stay filled. Rings as
// from tracedBorders(). Exact along a row, in 16 steps down a pixel.
GreyImage drawn(const Outline& outline, int width, int height);

}  // namespace fantascope
