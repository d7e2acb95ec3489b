#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// Convex outlines in the plane, as corners in anticlockwise order. Any unit of length. Thread:
// reentrant.

// The convex hull of points (Andrew 1979). It has fewer than three corners if the points lie on a
// line.
std::vector<glm::dvec2> hullOf(std::span<const glm::dvec2> points);
// The same, as indices of the points. `corners` is overwritten and keeps its memory.
void findHull(std::span<const glm::dvec2> points, std::vector<std::uint32_t>& corners);
double areaOf(const std::vector<glm::dvec2>& hull);
double perimeterOf(const std::vector<glm::dvec2>& hull);
// The distance of `point` from the segment from `from` to `to`.
double distanceTo(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec2& point);
// The signed distance of a point from an outline, negative inside.
double distanceTo(const std::vector<glm::dvec2>& hull, const glm::dvec2& point);
// The mean of one or more points.
glm::dvec2 middleOf(const std::vector<glm::dvec2>& points);
// Clips a segment to an outline grown by `grown` and gives the two ends. The segment reaches from
// -reach to reach about `middle`, along the unit vector `along`. Empty if `middle` lies outside.
std::vector<glm::dvec2> partWithin(const std::vector<glm::dvec2>& hull, double grown, const glm::dvec2& middle,
                                   const glm::dvec2& along, double reach);

}  // namespace fantascope::theatre
