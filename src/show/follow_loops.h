#pragma once

#include "show/cue_list.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace fantascope::show {

// The cues that may follow a cue by themselves: its own followers, and, once these had their turns,
// the one after it in the list. `Cue`: with `follow`, `soonestFollow()`, `followers` and `times`,
// as CueList::Cue.
template <class Cue>
std::vector<std::size_t> followersOf(const std::vector<Cue>& cues, std::size_t cue, bool loops) {
    const Cue& now = cues[cue];
    if (!now.follow) return {};
    std::vector<std::size_t> followers(now.followers.begin(), now.followers.end());
    const bool goesOn = followers.empty() || now.times > 0;
    if (goesOn && (loops || cue + 1 < cues.size())) followers.push_back((cue + 1) % cues.size());
    return followers;
}

// A cue of a circle of cues that follow each other in less than kShortestLoop; nothing: there is
// none.
template <class Cue>
std::optional<std::size_t> hurriedLoop(const std::vector<Cue>& cues, bool loops) {
    enum class State { New, Open, Done };
    std::vector<State> states(cues.size(), State::New);
    const std::function<std::optional<std::size_t>(std::size_t)> visit = [&](std::size_t cue) -> std::optional<std::size_t> {
        if (states[cue] == State::Open) return cue;
        if (states[cue] == State::Done) return std::nullopt;
        states[cue] = State::Open;
        if (const auto soonest = cues[cue].soonestFollow(); soonest && *soonest < kShortestLoop)
            for (const std::size_t follower : followersOf(cues, cue, loops))
                if (const auto found = visit(follower)) return found;
        states[cue] = State::Done;
        return std::nullopt;
    };
    for (std::size_t cue = 0; cue < cues.size(); ++cue)
        if (const auto found = visit(cue)) return found;
    return std::nullopt;
}

}  // namespace fantascope::show
