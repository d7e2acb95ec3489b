#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::vision {

// What the site's lamps are set to: levels, relays and trims. In the same state they give the same
// light.
using LampState = std::vector<std::uint8_t>;

// What is usual in each state of the site's lamps. When cues come back to a state, what was learned
// in it counts again: if it were learned anew each time, its errors would add up over a night.
// Thread: thread-bound.
template <class Usual>
class UsualByLamps {
public:
    Usual* operator->() { return &usual_; }
    const Usual* operator->() const { return &usual_; }

    // The lamps change. `state`: nothing while they are changing. `isLearned`: what was usual until
    // now is known, and may be kept.
    void change(const std::optional<LampState>& state, bool isLearned) {
        if (state_ && isLearned) kept_.emplace_back(std::move(*state_), std::move(usual_));
        if (kept_.size() > kMost) kept_.pop_front();
        state_ = state;
        usual_ = {};
        if (!state) return;
        const auto found = std::ranges::find(kept_, *state, &std::pair<LampState, Usual>::first);
        if (found == kept_.end()) return;
        usual_ = std::move(found->second);
        kept_.erase(found);
    }

private:
    static constexpr std::size_t kMost = 100;  // states; a show with more has forgotten the oldest

    std::optional<LampState> state_;
    Usual usual_{};
    std::deque<std::pair<LampState, Usual>> kept_;  // the one that was left last is at the end
};

}  // namespace fantascope::vision
