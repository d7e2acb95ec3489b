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
        Time fade{};                       // from whatever is seen when the cue is entered to its look
        std::optional<Time> follow;        // after being entered, the next cue is entered by itself
        std::vector<WindWish> winds = {};  // one for each output; one that is missing is the usual wind
        std::string name = {};             // by which a revision of the list finds it again
    };
    std::vector<Cue> cues;
    bool loops = false;      // the first cue follows the last one, if that has a `follow`
    Look dark;               // what is seen before the first cue: black pictures, levels 0, relays in their safe states
    Time goInterval{};       // after a cue was entered, GO is ignored for this long
    Time blackoutFade{};     // from full light to none and back
    std::uint64_t seed = 1;  // of everything random in the show itself: its gusts
};

}  // namespace fantascope::show
