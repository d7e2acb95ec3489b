#pragma once

#include "show/cue_list.h"
#include "show/input.h"
#include "show/playback.h"

#include "core/append_log.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace fantascope::show {

// An input that has its place among all others.
struct LoggedInput {
    std::uint64_t number = 0;  // 0, 1, 2, ...
    Input input;
    Outcome outcome = Outcome::Taken;
    std::shared_ptr<const CueList> revision{};  // of an Input::Kind::Revise: what it names, if it is there
};

// The one way into the show: whoever asks for something submits it here. The log puts all inputs in
// one order, says what becomes of each, and hands the same sequence to everybody who reads it.
// Nothing is lost, however late somebody reads.
//
// Thread: submit() and add() from any, which wait for each other alone; readers as AppendLog says.
class InputLog {
public:
    using Reader = AppendLog<LoggedInput>::Reader;

    explicit InputLog(std::shared_ptr<const CueList> cues) : revisions_{std::move(cues)}, playback_(revisions_[0]) {}
    explicit InputLog(const CueList& cues) : InputLog(std::make_shared<const CueList>(cues)) {}

    // What the first input finds.
    std::shared_ptr<const CueList> cues() const;
    // Another list, for an Input::Kind::Revise to come: 1, 2, 3, ...; 0 is the one that it began
    // with. It changes nothing by itself.
    int add(std::shared_ptr<const CueList> cues);

    LoggedInput submit(const Input& input);
    // From the first input on. The log outlives it.
    Reader reader() const { return inputs_.reader(); }

private:
    mutable std::mutex mutex_;  // of:
    std::vector<std::shared_ptr<const CueList>> revisions_;
    Playback playback_;
    std::uint64_t count_ = 0;
    AppendLog<LoggedInput> inputs_;
};

}  // namespace fantascope::show
