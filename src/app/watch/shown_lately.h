#pragma once

#include "core/clock.h"

#include <algorithm>
#include <deque>
#include <iterator>
#include <utility>

namespace fantascope::app {

// What was shown in the last seconds. A camera's picture is of a moment before it comes. Times are
// show time. Thread: thread-bound.
template <class State>
class ShownLately {
public:
    // `at`: not before the last one.
    void note(Time at, State state) {
        states_.emplace_back(at, std::move(state));
        while (at - states_.front().first > kKept) states_.pop_front();
    }
    bool empty() const { return states_.empty(); }
    // What was shown at a time; the oldest that is known, if it was before that. Something was
    // noted.
    const State& at(Time time) const {
        const auto next = std::ranges::upper_bound(states_, time, {}, &Entry::first);
        return next == states_.begin() ? next->second : std::prev(next)->second;
    }
    // Whether everything that was shown about a time is alike, as far as is known. A camera may
    // tell a time that is wrong by kLate.
    bool isSteady(Time time, const auto& areAlike) const {
        const State& then = at(time);
        if (!areAlike(at(time - kLate), then)) return false;
        return std::ranges::all_of(states_, [&](const Entry& entry) {
            return entry.first < time - kLate || entry.first > time + kLate || areAlike(entry.second, then);
        });
    }

private:
    static constexpr Time kKept = std::chrono::seconds(4), kLate = std::chrono::milliseconds(600);
    using Entry = std::pair<Time, State>;
    std::deque<Entry> states_;  // since when, oldest first
};

}  // namespace fantascope::app
