#pragma once

#include "theatre/mask/bit_mask.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace fantascope::theatre {

// A point of a mask's contour: the centre of a white pixel with a black 4-neighbour.
struct ContourPoint {
    glm::ivec2 pixel{0};
    glm::dvec2 normal{0};  // outward, unit; zero if the white in the disc is symmetric
    double curvature = 0;  // positive where the white is convex, in units of 1 / the disc's radius
};

// Measures a mask around its contour points by integral invariants (Manay et al. 2006): with the
// disc of radius R around a contour point and A the white area in it, the curvature is 3 (pi R^2 /
// 2 - A) / R^3, and the outward normal points away from the white's centroid. It needs no
// derivative of the pixel staircase.
class ContourDisc {
public:
    explicit ContourDisc(double radius);
    ContourPoint at(const BitMask& mask, glm::ivec2 pixel) const;
    int radius() const { return radius_; }  // pixels; a pixel farther away in x or in y has no effect

private:
    int radius_, full_ = 0;
    std::vector<std::uint64_t> rows_;  // of the disc; bit 0 is at its left edge
};

// The contour of a mask, with nearest-point queries.
class Contour {
public:
    // Finds the white pixels that have a black 4-neighbour. Pixels beyond the mask's edge count as
    // black.
    void find(const BitMask& mask);
    const BitMask& pixels() const { return pixels_; }
    // The contour pixel nearest to a pixel; empty for an empty contour. Ties go to the one found
    // first: rows are searched outwards from the pixel's row, the upper before the lower, the left
    // before the right. `other`: any contour pixel; a near one shortens the search.
    std::optional<glm::ivec2> nearest(glm::ivec2 pixel, std::optional<glm::ivec2> other = {}) const;

private:
    BitMask pixels_;
};

// The outer contour of the largest white island of a mask, as a closed chain of pixels, clockwise
// as seen (Moore-neighbour tracing). It is empty for a black mask.
std::vector<glm::ivec2> outerContour(const BitMask& mask);

// `count` points at equal distances along a closed contour.
std::vector<glm::ivec2> sampled(const std::vector<glm::ivec2>& contour, std::size_t count);

}  // namespace fantascope::theatre
