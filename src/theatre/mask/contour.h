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
    glm::dvec2 normal{0};  // outward, unit; zero where the disc around is symmetric
    double curvature = 0;  // positive where the white is convex, in 1 / the disc's radius
};

// Measures a mask around its contour points by integral invariants (Manay et al. 2006): with the
// disc of radius R around a contour point and A the white area in it, the curvature is 3 (pi R^2 /
// 2 - A) / R^3, and the outward normal points away from the white's centroid. No derivative of a
// staircase is taken.
class ContourDisc {
public:
    explicit ContourDisc(double radius);
    ContourPoint at(const BitMask& mask, glm::ivec2 pixel) const;
    int radius() const { return radius_; }  // no pixel farther away in x or in y counts

private:
    int radius_, full_ = 0;
    std::vector<std::uint64_t> rows_;  // of the disc, from the bit 0 at its left edge
};

// The contour of a mask, for questions about its nearest point.
class Contour {
public:
    // The white pixels that have a black 4-neighbour; what is beyond the mask's edge counts as
    // black.
    void find(const BitMask& mask);
    const BitMask& pixels() const { return pixels_; }
    // The contour pixel nearest to a pixel; of several the one found first: from the row outwards,
    // upper before lower, left before right. `other`: any pixel of the contour, which shortens the
    // search if it is near.
    std::optional<glm::ivec2> nearest(glm::ivec2 pixel, std::optional<glm::ivec2> other = {}) const;

private:
    BitMask pixels_;
};

// The outer contour of the largest white island of a mask as a closed chain of pixels, clockwise as
// seen (Moore's neighbours); empty for a black mask.
std::vector<glm::ivec2> outerContour(const BitMask& mask);

// So many points at equal distances along the outer contour.
std::vector<glm::ivec2> sampled(const std::vector<glm::ivec2>& contour, std::size_t count);

}  // namespace fantascope::theatre
