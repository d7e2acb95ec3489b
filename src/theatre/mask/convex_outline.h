#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// Convex outlines in the plane: their corners anticlockwise. Any unit of length. Thread: reentrant.

// Of points (Andrew 1979); fewer than three corners if they lie on a line.
std::vector<glm::dvec2> hullOf(std::span<const glm::dvec2> points);
// The same as indices of the points: `corners` is overwritten and keeps its memory.
void findHull(std::span<const glm::dvec2> points, std::vector<std::uint32_t>& corners);
double areaOf(const std::vector<glm::dvec2>& hull);
double perimeterOf(const std::vector<glm::dvec2>& hull);
// Of a point from the segment between two.
double distanceTo(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec2& point);
// Of a point from an outline, negative inside.
double distanceTo(const std::vector<glm::dvec2>& hull, const glm::dvec2& point);
// The mean of points, at least one.
glm::dvec2 middleOf(const std::vector<glm::dvec2>& points);
// The ends of the part of a segment, from -reach to reach about `middle` along a unit vector, that
// lies in an outline grown by `grown`; none if its middle is not in it.
std::vector<glm::dvec2> partWithin(const std::vector<glm::dvec2>& hull, double grown, const glm::dvec2& middle,
                                   const glm::dvec2& along, double reach);

}  // namespace fantascope::theatre
