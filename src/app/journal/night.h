#pragma once

#include "show/play/journal.h"

#include "core/clock.h"
#include "core/wall_clock.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// What a journal says of its night, in the order in which it was. Times are show time, from the
// beginning of the night on.
struct Night {
    // A stretch of something that was so from a time until another.
    struct Stretch {
        Time from{}, to{};
        std::string what;
        friend bool operator==(const Stretch&, const Stretch&) = default;
    };
    // A run of the night.
    struct Run {
        Time from{}, to{};
        Time utc{};         // of `from`
        std::string ended;  // why; empty: it died
        bool goesOn = false;
    };
    struct Press {
        Time at{};
        std::string what, by;  // "go", "controller 4"
    };
    std::string show;
    std::vector<Run> runs;
    std::vector<Stretch> cues;   // by name
    std::vector<Stretch> holds;  // "blackout", "panic", "pause", "freeze", "lock"
    std::vector<Press> presses;  // of people; what the camera corrects is not among them
    std::size_t corrections = 0;
    std::vector<show::journal::Told> events;
    std::vector<std::pair<Time, std::int64_t>> lateFrames;  // at each look, since the look before
    std::int64_t frames = 0, late = 0;                      // of all runs
    std::map<std::string, std::vector<std::pair<Time, double>>> z;
    std::size_t damaged = 0, gaps = 0;  // lines; places where lines are missing

    std::size_t deaths() const;  // runs that did not end in order, without the last one
    Time length() const { return runs.empty() ? Time{} : runs.back().to; }
    // The moment of a show time by the clocks of this machine's zone.
    WallTime wallTimeOf(Time at) const;
};
Night nightOf(const show::Journal& journal);

// The audit of nights as a page of HTML that needs nothing else: a table of all nights, and of each
// one its cues, holds, presses, late frames and scores over time, and everything that happened.
std::string pageOf(const std::vector<std::pair<std::string, Night>>& nights);

}  // namespace fantascope::app
