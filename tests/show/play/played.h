#pragma once

#include "show/play/playback.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace fantascope::show {

// A list after inputs that are all taken.
inline Playback after(const CueList& list, std::initializer_list<Input> inputs) {
    Playback playback(list);
    for (const Input& input : inputs) EXPECT_EQ(playback.apply(input), Outcome::Taken) << seconds(input.at) << " s";
    return playback;
}

inline ShowState stateOf(const Playback& playback, Time time) {
    ShowState state;
    playback.stateAt(time, state);
    return state;
}

}  // namespace fantascope::show
