#pragma once

#include "vision/wall_watch.h"

#include "core/clock.h"
#include "core/geometry.h"

#include <glm/vec2.hpp>

#include <array>
#include <deque>
#include <optional>

namespace fantascope::vision {

// How far an output's picture has moved on the wall.
struct Drift {
    Homography moved;          // projector pixels: what was lit by p is lit by moved(p); the identity: nothing moved
    double px = 0;             // rms over the picture
    double sigma = 0;          // standard deviation of `moved`, rms over the picture, pixels
    double surfaceStayed = 0;  // mean of OutputSight::surfaceStayed

    // Whether a person could see it, and chance does not explain it.
    bool isSure() const { return px > 0.6 && px > 4 * sigma; }
};

// Follows an output's picture through many sights. A single sight may be wrong, for example because
// somebody stands in the picture, so the median of the last second counts. Thread: thread-bound.
class DriftTrack {
public:
    // `isSurveyed`: sights tell the movement since the calibration. Otherwise they tell it against
    // a plan, which nobody measures to the pixel, and the first second becomes the reference.
    // `projector`: its pixels.
    DriftTrack(glm::ivec2 projector, bool isSurveyed) : projector_(projector), isSurveyed_(isSurveyed) {}

    // Takes what a camera picture says; nothing: it says nothing about this output.
    void add(Time at, const std::optional<OutputSight>& sight);
    // Nothing: too few good sights in the last second, or they do not agree.
    const std::optional<Drift>& now() const { return now_; }
    // Begins again: where the picture is next counts as where it belongs.
    void forget();

private:
    struct Place {
        Time at{};
        bool isGood = false;
        std::array<double, 8> corners{};  // where the projector's corners' places are lit now, x and y in turn
        double sigma = 0, surfaceStayed = 0;
    };
    std::optional<Drift> estimate() const;

    glm::ivec2 projector_;
    bool isSurveyed_;
    std::deque<Place> places_;  // of the last second
    std::optional<Homography> reference_;
    std::optional<Drift> now_;
};

}  // namespace fantascope::vision
