#pragma once

#include "show/course/steps.h"

#include "core/clock.h"
#include "core/geometry.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace fantascope::show {

// How an output's picture is moved on its projector, to follow a projector that has moved: by how
// much the corners of the projector's whole picture are, in its pixels, clockwise from the top
// left. All zero: as the site file says.
using PictureShift = std::array<glm::vec2, 4>;

// The map of the pixels of a projector with `size` pixels that a shift makes; nothing: it would
// fold the picture.
std::optional<Homography> mapOf(const PictureShift& shift, glm::ivec2 size);
// The shift that makes a map.
PictureShift shiftOf(const Homography& map, glm::ivec2 size);
// How far the corner that moves farthest does, pixels.
float farthestOf(const PictureShift& shift);

// The shifts of all outputs in time. Each moves from where it is to where it is wanted at a
// constant speed, so nobody sees it jump. A pure function of time and of the calls so far. Thread:
// const functions are reentrant.
class ShiftCourses {
public:
    // `speed`: of the fastest corner, pixels per second.
    void want(std::size_t output, const PictureShift& shift, Time at, double speed);
    // Takes all shifts back.
    void takeBack(Time at, double speed);
    PictureShift at(std::size_t output, Time time) const;
    void forget(Time time);

private:
    struct Move {
        Time at{}, length{};
        PictureShift from{}, to{};
    };
    std::vector<Steps<Move>> moves_;  // by output
};

}  // namespace fantascope::show
