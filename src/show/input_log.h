#pragma once

#include "show/cue_list.h"
#include "show/input.h"
#include "show/playback.h"

#include "core/append_log.h"

#include <cstdint>
#include <mutex>

namespace fantascope::show {

// An input that has its place among all others.
struct LoggedInput {
    std::uint64_t number = 0;  // 0, 1, 2, ...
    Input input;
    Outcome outcome = Outcome::Taken;
};

// The one way into the show: whoever asks for something submits it here. The log puts all inputs in
// one order, says what becomes of each, and hands the same sequence to everybody who reads it.
// Nothing is lost, however late somebody reads.
//
// Thread: submit() from any, which waits for other submissions alone; readers as AppendLog says.
class InputLog {
public:
    using Reader = AppendLog<LoggedInput>::Reader;

    explicit InputLog(const CueList& cues) : playback_(cues) {}

    // What the inputs step through.
    const CueList& cues() const { return playback_.cues(); }

    LoggedInput submit(const Input& input);
    // From the first input on. The log outlives it.
    Reader reader() const { return inputs_.reader(); }

private:
    std::mutex mutex_;  // of:
    Playback playback_;
    std::uint64_t count_ = 0;
    AppendLog<LoggedInput> inputs_;
};

}  // namespace fantascope::show
