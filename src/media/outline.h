#pragma once

#include "media/image.h"
#include "media/mesh.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <vector>

namespace fantascope {

// A flat region: the points that an odd number of its rings run around, so that a ring inside
// another is a hole. x right, y up.
struct Outline {
    std::vector<std::vector<glm::dvec2>> rings;  // closed; the first point is not repeated

    std::size_t pointCount() const;
};

// With few points: the outline stays within `tolerance` of what it was, or farther if that is what
// it takes to have at most `most` points, > 0. What is narrower may go, and rings that lie closer
// may cross. The unit is that of the points.
Outline simplified(const Outline& outline, double tolerance, std::size_t most);

// The region as triangles in z = 0, anticlockwise as seen from +z; none if it has no area.
TriangleMesh filled(const Outline& outline);

// Triangles in a plane, each with its corners from the x axis towards the y axis.
struct FlatMesh {
    std::vector<glm::dvec2> vertices;
    std::vector<glm::uvec3> triangles;  // indices into vertices
};

// The region as triangles that bend well: no edge is longer than `longest`, > 0, and no angle below
// 20 degrees but where two sides of the outline meet at a sharper one, or where rings all but
// touch. Points are added on the outline and within (Shewchuk 2002); where rings cross, too.
FlatMesh meshed(const Outline& outline, double longest);

// The borders of what is lighter than a half, in pixels, x right, y down: where the light passes a
// half between the centres of two pixels. What lies beyond the picture is dark. Rings do not meet;
// those around an island run clockwise as seen, those around a hole the other way.
Outline tracedBorders(const GreyImage& picture);

// How much of each pixel lies where the rings' turns around it do not add up to zero; so what
// overlaps itself stays filled. Rings as those of tracedBorders; exact along a row, in 16 steps
// down a pixel.
GreyImage drawn(const Outline& outline, int width, int height);

}  // namespace fantascope
