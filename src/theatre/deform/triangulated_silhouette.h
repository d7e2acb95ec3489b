#pragma once

#include "core/result.h"
#include "media/image.h"
#include "media/outline.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// A point that a triangle carries along, by its barycentric coordinates; a little outside one of
// them is negative.
struct CarriedPoint {
    std::uint32_t triangle = 0;
    glm::dvec3 shares{0};
};

// A silhouette with its interior in triangles (Igarashi et al. 2005, section 3; Won & Lee 2016,
// section 5), as it is at rest. Pixels of its picture, x right, y down.
struct TriangulatedSilhouette {
    static constexpr int kVertices = 300, kFewestVertices = 20, kMostVertices = 5000, kMostRings = 200;

    // What is lighter than a half, in triangles of much the same size: about so many `vertices`, or
    // more where the outline takes them. Islands and holes stay what they are. Error: nothing
    // white, nothing black, an island of fewer than PoseTarget::kFewest pixels, more than
    // kMostRings islands and holes, parts that all but touch, a picture that is too large.
    static Result<TriangulatedSilhouette> of(const GreyImage& picture, int vertices = kVertices);

    // The triangle at a point, or the nearest to it, carries the point.
    CarriedPoint carried(glm::dvec2 point) const;
    // The point of the triangles that is nearest.
    glm::dvec2 nearest(glm::dvec2 point) const;
    // Where a carried point is once the vertices are there.
    glm::dvec2 placeOf(const CarriedPoint& point, std::span<const glm::dvec2> vertices) const;
    // The picture's own outline, finer than the triangles, carried along by them.
    Outline outlineAt(std::span<const glm::dvec2> vertices) const;

    int width = 0, height = 0;  // of the picture
    FlatMesh rest;
    std::vector<std::vector<CarriedPoint>> outline;  // rings as those of tracedBorders
};

// Twice the area of each triangle; negative where it is turned over.
double doubleArea(const glm::uvec3& triangle, std::span<const glm::dvec2> vertices);

// The triangles that are turned over or have no area: there the silhouette is folded.
std::vector<std::size_t> foldedTriangles(const FlatMesh& rest, std::span<const glm::dvec2> vertices);

// The islands of a mesh by a number for each vertex, from 0: those of one island hang together over
// triangles.
std::vector<std::size_t> islandsOf(const FlatMesh& mesh);

}  // namespace fantascope::theatre
