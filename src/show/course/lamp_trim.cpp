#include "show/course/lamp_trim.h"

#include <cmath>

namespace fantascope::show {

void TrimCourses::put(Time at, const Step& step) {
    if (step.relaysOff != steps_.last().relaysOff) switched_ = at;
    steps_.set(at, step);
}

void TrimCourses::want(const LampTrim& trim, Time at, double speed) {
    const float from = this->at(at).share;
    put(at, {{from, trim.share, at, fromSeconds(std::abs(trim.share - from) / speed)}, trim.relaysOff});
}

void TrimCourses::releaseRelays(Time at) {
    if (steps_.last().relaysOff > 0) put(at, {steps_.last().share, 0});
}

LampTrim TrimCourses::at(Time time) const {
    const Step& step = steps_.at(time);
    return {step.share.valueAt(time), step.relaysOff};
}

}  // namespace fantascope::show
