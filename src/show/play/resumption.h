#pragma once

#include "show/play/input_log.h"
#include "show/play/journal.h"

#include "core/clock.h"

#include <optional>
#include <vector>

namespace fantascope::show {

// How a show goes on with what a journal has left.
struct Resumption {
    Time at{};            // show time at which it goes on
    int cue = -1;         // that is on then; -1: none
    bool isExact = true;  // fades, waits and follows go on, too; else its cue was entered again, and the
                          // journal's lines do not lead there (journal::Run::goesOn)
    friend bool operator==(const Resumption&, const Resumption&) = default;
};

// Brings a log that has no input yet to where a journal ends: submits its inputs again, and where
// lines were lost, inputs that lead to the controls that a later line tells of. If the journal is
// of another cue list, the cue of the same name is entered, and the controls are as they were.
// Exchanges and revisions are left out: what they bring belongs to a run.
// `at`: when the show goes on; no earlier than Journal::newest(). Nothing: no input is left, so the
// show begins.
std::optional<Resumption> resume(const Journal& journal, Time at, InputLog& inputs);

// The inputs that lead from controls to others, at `at`. The source is Input::Source::Journal.
std::vector<Input> repairs(const ShowState& now, const journal::State& wanted, Time at);

}  // namespace fantascope::show
