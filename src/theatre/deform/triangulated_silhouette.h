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

// A point that moves with a triangle, by its barycentric coordinates. If the point is a little
// outside, one of them is negative.
struct CarriedPoint {
    std::uint32_t triangle = 0;
    glm::dvec3 shares{0};
};

// A silhouette at rest with its interior triangulated (Igarashi et al. 2005, section 3; Won & Lee
// 2016, section 5). Pixels of its picture, x right, y down.
struct TriangulatedSilhouette {
    static constexpr int kVertices = 300, kFewestVertices = 20, kMostVertices = 5000, kMostRings = 200;

    // Triangulates the pixels lighter than a half, with triangles of similar size and about
    // `vertices` vertices, or more if the outline needs them. Islands and holes are preserved.
    // Error: nothing white, nothing black, an island of fewer than PoseTarget::kFewest pixels, more
    // than kMostRings islands and holes, parts that all but touch, a picture that is too large.
    static Result<TriangulatedSilhouette> of(const GreyImage& picture, int vertices = kVertices);

    // The point, carried by the triangle that contains it or is nearest to it.
    CarriedPoint carried(glm::dvec2 point) const;
    // The point of the triangles that is nearest.
    glm::dvec2 nearest(glm::dvec2 point) const;
    // The place of a carried point when the vertices are at `vertices`.
    glm::dvec2 placeOf(const CarriedPoint& point, std::span<const glm::dvec2> vertices) const;
    // The picture's own outline, which is finer than the triangles, carried by them.
    Outline outlineAt(std::span<const glm::dvec2> vertices) const;

    int width = 0, height = 0;  // of the picture
    FlatMesh rest;
    std::vector<std::vector<CarriedPoint>> outline;  // rings as in tracedBorders()
};

// Twice the signed area of a triangle; negative if it is turned over.
double doubleArea(const glm::uvec3& triangle, std::span<const glm::dvec2> vertices);

// The triangles that are turned over or have no area: there the silhouette is folded.
std::vector<std::size_t> foldedTriangles(const FlatMesh& rest, std::span<const glm::dvec2> vertices);

// The island of each vertex of a mesh, numbered from 0. An island is a set of vertices connected by
// triangles.
std::vector<std::size_t> islandsOf(const FlatMesh& mesh);

}  // namespace fantascope::theatre
