#pragma once

#include "core/clock.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace fantascope::app {

// Says which picture a camera's frame shows. Pictures follow each other without waiting for the
// camera; a frame's time stamp tells which of them it saw. A frame that may have seen two of them
// counts for none.
class PictureSchedule {
public:
    // How camera time follows the projectors: a picture is seen between `soonest` and `latest`
    // after it was shown, by the frames' own time stamps.
    struct Delay {
        Time soonest{}, latest{};
        Time middle() const { return (soonest + latest) / 2; }
    };
    // `period`: of the camera. An exposure, and the rolling from its first row to its last, take at
    // most one period each.
    PictureSchedule(Delay delay, Time period) : delay_(delay), period_(period) {}

    // How long a picture has to be shown so that at least `frames` frames show it and nothing else.
    Time dwell(int frames) const;
    // A picture is shown from a moment on; moments rise.
    void show(std::int64_t picture, Time from);
    // The picture that a frame exposed at `exposed` shows; nothing if it shows two, or none of
    // ours.
    std::optional<std::int64_t> pictureOf(Time exposed) const;

private:
    Time before() const { return period_ / 2; }  // an exposure begins so long before its time stamp at most
    Time after() const { return period_; }       // and ends so long after it

    struct Shown {
        std::int64_t picture = 0;
        Time from{};
    };
    const Delay delay_;
    const Time period_;
    std::vector<Shown> shown_;
};

}  // namespace fantascope::app
