#pragma once

#include "core/clock.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace fantascope::show {

// A value that changes at certain moments and stays the same in between. Value type; thread: const
// functions are reentrant.
template <class Value>
class Steps {
public:
    // A value that has been the same forever.
    explicit Steps(Value first = {}) { steps_.push_back({Time::min(), std::move(first)}); }

    // The value at `time`. For a time that is forgotten it gives what is oldest.
    const Value& at(Time time) const {
        const auto next = after(time);
        return next == steps_.begin() ? steps_.front().value : std::prev(next)->value;
    }
    const Value& last() const { return steps_.back().value; }
    // The value is another one from `at` on, which is no earlier than that of the previous call.
    void set(Time at, Value value) { steps_.push_back({at, std::move(value)}); }
    // Forgets what was over before `time`.
    void forget(Time time) {
        if (const auto next = after(time); next - steps_.begin() > 1) steps_.erase(steps_.begin(), std::prev(next));
    }

private:
    struct Step {
        Time at{};
        Value value;
    };
    auto after(Time time) const {
        return std::upper_bound(steps_.begin(), steps_.end(), time, [](Time t, const Step& step) { return t < step.at; });
    }
    std::vector<Step> steps_;  // by time; never empty
};

}  // namespace fantascope::show
