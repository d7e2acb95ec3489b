#include "show/course/cue_time.h"

namespace fantascope::show {

namespace {

constexpr Time kTick = std::chrono::nanoseconds(1);

}  // namespace

void CueTime::stand(Time at) {
    const Part last = parts_.last();
    if (!last.standsAt) parts_.set(at, {last.paused, at - last.paused});
}

void CueTime::goOn(Time at) {
    if (const std::optional<Time> stood = parts_.last().standsAt) parts_.set(at, {at - (*stood + kTick), {}});
}

void CueTime::tick(Time at) {
    Part part = parts_.last();
    if (!part.standsAt) return;
    *part.standsAt += kTick;
    parts_.set(at, part);
}

Time CueTime::at(Time showTime) const {
    const Part& part = parts_.at(showTime);
    return part.standsAt ? *part.standsAt : showTime - part.paused;
}

}  // namespace fantascope::show
