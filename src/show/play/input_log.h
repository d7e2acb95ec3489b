#pragma once

#include "show/cue_list.h"
#include "show/play/input.h"
#include "show/play/playback.h"

#include "core/append_log.h"

#include <cstdint>
#include <functional>
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
    std::shared_ptr<const CueList> revision{};  // only for Input::Kind::Revise: the list that it names; null: there is none
};

// The one way into the show: every input is submitted here. The log puts all inputs in one order,
// decides the outcome of each, and gives every reader the same sequence. A late reader misses no
// input.
//
// Thread: submit(), add() and foresee() from any thread; they wait only for each other. Readers as
// AppendLog says.
class InputLog {
public:
    using Reader = AppendLog<LoggedInput>::Reader;

    explicit InputLog(std::shared_ptr<const CueList> cues) : revisions_{std::move(cues)}, playback_(revisions_[0]) {}
    explicit InputLog(const CueList& cues) : InputLog(std::make_shared<const CueList>(cues)) {}

    // The list that the log began with.
    std::shared_ptr<const CueList> cues() const;
    // Adds a list that a later Input::Kind::Revise may name. Returns its number: 1, 2, 3, ...; the
    // list that the log began with is 0. The show does not change until that input comes.
    int add(std::shared_ptr<const CueList> cues);

    LoggedInput submit(const Input& input);
    // Calls `write` with every input from now on, before any reader sees it. Nothing: no more.
    // `write` must not submit inputs.
    void writeTo(std::function<void(const LoggedInput&)> write);
    // Works out the cues that follow by themselves until `time`. Call it now and then, so that the
    // first input after hours of a loop need not wait for that. Nothing changes.
    void foresee(Time time);
    // A reader that begins with the first input. The log outlives it.
    Reader reader() const { return inputs_.reader(); }

private:
    mutable std::mutex mutex_;  // of:
    std::vector<std::shared_ptr<const CueList>> revisions_;
    Playback playback_;
    std::uint64_t count_ = 0;
    std::function<void(const LoggedInput&)> write_;
    AppendLog<LoggedInput> inputs_;
};

}  // namespace fantascope::show
