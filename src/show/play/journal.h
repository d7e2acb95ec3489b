#pragma once

#include "show/cue_list.h"
#include "show/play/input.h"
#include "show/show_state.h"

#include "core/clock.h"
#include "core/result.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace fantascope::show {

// What a journal says, line by line: all that is needed to go on with a show after the program or
// the machine has died, and to read later what the night was like. Times are show time.
namespace journal {

// A run began.
struct Run {
    Time at{};
    Time utc{};              // of its beginning, as WallTime::utc
    bool goesOn = false;     // with what the lines before have left; else those no longer count
    std::uint64_t list = 0;  // hashOf() its cue list
    std::string show;        // its file
    friend bool operator==(const Run&, const Run&) = default;
};
// The controls changed, by an input or by a follow; or they are told again, in case that line is
// lost.
struct State {
    Time at{};
    Controls controls;     // without any `next`
    bool corrects = true;  // corrections are allowed
    std::string cue;       // the name of the current one; empty: none
    friend bool operator==(const State&, const State&) = default;
};
struct Told {
    Time at{};
    std::string text;  // of an event
    friend bool operator==(const Told&, const Told&) = default;
};
// How the run was in the last minute or so.
struct Figures {
    Time at{};
    std::int64_t frames = 0, lateFrames = 0;        // on all outputs, since the run began
    std::vector<std::pair<std::string, double>> z;  // the camera's newest score of each output; negative: none yet
    friend bool operator==(const Figures&, const Figures&) = default;
};
// The machine's clock was set.
struct Clock {
    Time at{};
    Time utc{};  // that it shows now
    friend bool operator==(const Clock&, const Clock&) = default;
};
// Lines are missing here, because they could not be written.
struct Gap {
    Time at{};
    friend bool operator==(const Gap&, const Gap&) = default;
};
struct End {
    Time at{};
    std::string why;
    friend bool operator==(const End&, const End&) = default;
};

using Line = std::variant<Run, Input, State, Told, Figures, Clock, Gap, End>;

}  // namespace journal

// The first line of every journal.
constexpr std::string_view kJournalHead = "fantascope-journal 1\n";
// A line as it stands in the file, with its end. It begins with a hash of the rest, so that damage
// is found: "3f2a91c0 input 12500000000 go 0 terminal 0".
std::string lineOf(const journal::Line& line);

struct Journal {
    struct Entry {
        journal::Line line;
        bool isAfterDamage = false;  // lines before it, back to the previous entry, were left out
    };
    std::vector<Entry> entries;
    std::size_t bytes = 0;    // up to the end of the last whole line; what follows is torn
    std::size_t damaged = 0;  // lines that were left out
    bool isTorn = false;      // a last line without an end, or damaged, was cut

    // The newest time that a line tells since the show last began; 0 if there is none.
    Time newest() const;
    // What the machine's clock has shown when, by the newest line that tells. Nothing: none does.
    std::optional<journal::Clock> clock() const;
};

// Reads a journal. Damaged lines are left out. Error: its first line is not that of a journal, and
// no other is one of a journal either. An empty text, or a part of the first line, is an empty
// journal: the machine died at once.
Result<Journal> journalOf(std::string_view text);
// The same of a file. Error: names the file; also that it cannot be read.
Result<Journal> readJournal(const std::filesystem::path& file);

// A hash of all that says when which cue of a list is entered. With the same hash, the same inputs
// enter the same cues.
std::uint64_t hashOf(const CueList& list);

}  // namespace fantascope::show
