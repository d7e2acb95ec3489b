#pragma once

#include "show/playback.h"

#include "core/bounded_queue.h"

namespace fantascope::app {

// One thread's own copy of the playback. Playback is a pure function of the inputs, so copies that are given the same inputs agree and
// no thread has to ask another one. Thread: give() from the input thread, all else from the one thread that owns the copy.
class PlaybackReplica {
public:
    explicit PlaybackReplica(const show::CueList& cues) : playback_(cues) {}

    // False: the owner has not looked for a long time; the input is lost to this copy.
    bool give(const show::Input& input) { return inbox_.push(input); }

    // What is seen at `time` given all inputs so far. `taken` is called with each input that is new since the last call.
    void stateAt(Time time, show::ShowState& state, const auto& taken) {
        while (const auto input = inbox_.pop()) {
            playback_.apply(*input);
            taken(*input);
        }
        playback_.stateAt(time, state);
    }
    void stateAt(Time time, show::ShowState& state) {
        stateAt(time, state, [](const show::Input&) {});
    }

    // With the inputs that the last stateAt() took.
    const show::Playback& playback() const { return playback_; }

private:
    static constexpr std::size_t kMostWaiting = 256;  // inputs; a hand gives a few a second, an owner looks many times a second
    show::Playback playback_;
    BoundedQueue<show::Input, kMostWaiting> inbox_;
};

}  // namespace fantascope::app
