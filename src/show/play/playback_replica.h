#pragma once

#include "show/play/input_log.h"
#include "show/play/playback.h"

#include "core/check.h"

namespace fantascope::show {

// One thread's own copy of the playback. Playback is a pure function of the inputs, and every
// replica reads the same log. So all replicas agree, and no thread has to ask another. Thread:
// bound to the thread that owns the replica.
class PlaybackReplica {
public:
    // `inputs` outlives the replica.
    explicit PlaybackReplica(const InputLog& inputs) : playback_(inputs.cues()), inputs_(inputs.reader()) {}

    // What is seen at `time`, given all inputs so far. `taken` is called with each input since the
    // last call.
    void stateAt(Time time, ShowState& state, const auto& taken) {
        while (const LoggedInput* const logged = inputs_.next()) {
            FANTASCOPE_CHECK(playback_.apply(logged->input, logged->revision) == logged->outcome,
                             "every copy of the playback comes to the same");
            taken(logged->input);
        }
        playback_.foresee(time);
        playback_.stateAt(time, state);
    }
    void stateAt(Time time, ShowState& state) {
        stateAt(time, state, [](const Input&) {});
    }

    // Whether there are inputs that the last stateAt() did not take.
    bool hasNews() const { return inputs_.hasNext(); }

    // The playback after the inputs that the last stateAt() took.
    const Playback& playback() const { return playback_; }

private:
    Playback playback_;
    InputLog::Reader inputs_;
};

}  // namespace fantascope::show
