#include "show/pattern_exchange.h"

#include "show/course/course.h"

#include <algorithm>
#include <iterator>

namespace fantascope::show {

bool PatternCourses::exchange(SourceId source, int number, Time at, Time fade) {
    const auto found = steps_.find(source);
    const Step* const last = found == steps_.end() ? nullptr : &found->second.back();
    const bool isAgain = last != nullptr && last->isBack && number == last->number;
    if (!isAgain && number != (last != nullptr ? last->number : 0) + 1) return false;
    const Time begin = last != nullptr ? std::max(at, last->at + last->fade) : at;
    steps_[source].push_back({begin, fade, number, false});
    return true;
}

void PatternCourses::takeBack(Time at, Time fade) {
    for (auto& [source, steps] : steps_) {
        const Step last = steps.back();
        if (!last.isBack) steps.push_back({std::max(at, last.at + last.fade), fade, last.number, true});
    }
}

PatternExchange PatternCourses::at(SourceId source, Time time) const {
    const auto found = steps_.find(source);
    if (found == steps_.end()) return {};
    const std::vector<Step>& steps = found->second;
    const auto next = std::ranges::upper_bound(steps, time, {}, &Step::at);
    if (next == steps.begin()) return {};
    const Step& step = *std::prev(next);
    const float share = Course{0, 1, step.at, step.fade, Curve::Smooth}.valueAt(time);
    if (step.isBack) return {step.number, share, 0};
    const bool isFromOriginal = std::prev(next) == steps.begin() || std::prev(next, 2)->isBack;
    return isFromOriginal ? PatternExchange{step.number, 1 - share, 0} : PatternExchange{step.number, 0, 1 - share};
}

}  // namespace fantascope::show
