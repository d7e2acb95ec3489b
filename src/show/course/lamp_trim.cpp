#include "show/course/lamp_trim.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fantascope::show {

void TrimCourses::put(const Step& step) {
    if (step.relaysOff != (steps_.empty() ? 0 : steps_.back().relaysOff)) switched_ = step.at;
    steps_.push_back(step);
}

void TrimCourses::want(const LampTrim& trim, Time at, double speed) {
    const float from = this->at(at).share;
    put({at, {from, trim.share, at, fromSeconds(std::abs(trim.share - from) / speed)}, trim.relaysOff});
}

void TrimCourses::releaseRelays(Time at) {
    if (!steps_.empty() && steps_.back().relaysOff > 0) put({at, steps_.back().share, 0});
}

LampTrim TrimCourses::at(Time time) const {
    const auto next = std::ranges::upper_bound(steps_, time, {}, &Step::at);
    if (next == steps_.begin()) return {};
    const Step& step = *std::prev(next);
    return {step.share.valueAt(time), step.relaysOff};
}

}  // namespace fantascope::show
