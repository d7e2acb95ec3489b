#pragma once

#include "vision/watch/wall_watch.h"

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
    bool isSure() const { return px > 0.6 && px > 3 * sigma; }
};

// Follows an output's picture through many sights. A single sight may be wrong, for example because
// somebody stands in the picture, so the median of the last 1.2 seconds counts. Thread:
// thread-bound.
class DriftTrack {
public:
    // `isSurveyed`: sights tell the movement since the calibration, to about a pixel. Otherwise
    // they tell it against a plan, which nobody measures to the pixel, and what is seen in the
    // first twenty seconds becomes the reference.
    // `low`, `high`: the rectangle of the projector's pixels that the picture is in.
    DriftTrack(glm::dvec2 low, glm::dvec2 high, bool isSurveyed) : low_(low), high_(high), isSurveyed_(isSurveyed) {}

    // Takes what a camera picture says; nothing: it says nothing about this output.
    void add(Time at, const std::optional<OutputSight>& sight);
    // The drift since the picture stood where `moved` says.
    Drift since(const Drift& drift, const Homography& moved) const;
    // Nothing: too few good sights of late, or they do not agree.
    const std::optional<Drift>& now() const { return now_; }
    // Begins again: where the picture is next counts as where it belongs.
    void forget();

private:
    struct Place {
        Time at{};
        bool isGood = false;
        std::array<double, 8> corners{};  // where the places of the rectangle's corners are lit now, x and y in turn
        double sigma = 0, surfaceStayed = 0;
    };
    std::optional<Drift> estimate() const;
    std::array<glm::dvec2, 4> corners() const;
    Homography mapTo(const std::array<glm::dvec2, 4>& target) const;
    void average(const Homography& place);

    glm::dvec2 low_, high_;
    bool isSurveyed_;
    std::deque<Place> places_;               // of the last 1.2 seconds; the last six where these are older
    std::array<glm::dvec2, 4> reference_{};  // where the places of the rectangle's corners were lit
    double weights_ = 0;
    int references_ = 0;  // how many estimates are averaged in it
    std::optional<Drift> now_;
};

}  // namespace fantascope::vision
