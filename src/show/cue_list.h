#pragma once

#include "show/show_state.h"
#include "show/wind.h"

#include "core/clock.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::show {

// A show's cues with every name looked up in one site: all that playback needs. See Show::bind.
struct CueList {
    struct Cue {
        Look look;
        Time fade{};                       // from what is seen when the cue is entered to the cue's look
        std::optional<Time> follow;        // from when the cue is entered until the next one is; none: it waits for an input
        std::vector<WindWish> winds = {};  // one for each output; a missing one is the usual wind
        std::string name = {};             // a revision of the list finds the cue by it
    };
    std::vector<Cue> cues;
    bool loops = false;        // the first cue comes after the last one
    Look dark;                 // what is seen before the first cue: black pictures, levels 0, relays in their safe states
    Time goInterval{};         // after a cue was entered, GO is ignored for this long
    double farthestShift = 0;  // a correction that moves a corner of a projector's picture farther is ignored, pixels
    double shiftSpeed = 1;     // of the fastest corner, pixels per second
    Time exchangeFade{};       // from one pattern of a source to the next
    struct {
        float least = 1;     // of the share
        double speed = 1;    // of the share, 1/s
        int relays = 0;      // that may be off
        Time relayHold{};    // after relays were switched by a trim, they stay for this long
    } trim{};                // the bounds of LampTrim; one beyond them is ignored
    Time blackoutFade{};     // from full light to none and back
    std::uint64_t seed = 1;  // of the show's own randomness: its gusts

    // The cue after a cue; -1 is before the first. Nothing: it is the last one.
    std::optional<int> after(int cue) const {
        if (cue + 1 < static_cast<int>(cues.size())) return cue + 1;
        return loops ? std::optional(0) : std::nullopt;
    }
};

}  // namespace fantascope::show
