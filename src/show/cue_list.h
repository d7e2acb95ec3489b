#pragma once

#include "show/course/course.h"
#include "show/course/wind.h"
#include "show/show_state.h"
#include "show/source_id.h"

#include "core/clock.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::show {

// A show has at most so many lists beside the main one.
constexpr std::size_t kMostSides = 8;
// Cues that follow each other in a circle take at least so long for it.
constexpr Time kShortestLoop = std::chrono::milliseconds(100);

// How what is seen moves to another look. What becomes brighter comes in, what becomes darker goes
// out.
struct Fade {
    Time in{}, out{};
    Curve curve = Curve::Linear;

    Fade() = default;
    template <class Rep, class Period>
    Fade(std::chrono::duration<Rep, Period> both) : in(both), out(both) {}
    Fade(Time fadeIn, Time fadeOut, Curve along) : in(fadeIn), out(fadeOut), curve(along) {}
    Time longer() const { return std::max(in, out); }
    friend bool operator==(const Fade&, const Fade&) = default;
};

// Things that begin to move to a look at the same moment. A thing without a fade goes on as before.
struct Movement {
    Time start{};
    Time begun{};                                          // from when sources that come play; `start` or earlier
    std::vector<std::optional<Fade>> outputs{}, levels{};  // of each of a Look's
    // What becomes of a relay. GoesOn: it is as the look says, unless another list has switched it
    // since. Releases: the list has no say in it any more.
    enum class Relay : std::uint8_t { Stays, GoesOn, Switches, Releases };
    std::vector<Relay> relays{};
    struct Layer {
        std::size_t output = 0;
        SourceId source;
        std::optional<Fade> fade;
    };
    std::vector<Layer> layers{};       // that do not move as their output does
    std::optional<Fade> speeds{};      // of the sources; without a fade they go on as before
    std::vector<SourceId> restarts{};  // they begin again
};

// A show's cues with every name looked up in one site: all that playback needs. The main list, and
// the lists that play beside it. See Show::bind.
struct CueList {
    // Some things that move to a cue's look in their own time. No thing is in two parts of a cue.
    struct Part {
        Time wait{};  // from when the cue is entered until they begin to change
        Fade fade;
        std::vector<std::size_t> outputs = {}, levels = {}, relays = {};  // indices into Look's
        struct Layer {
            std::size_t output = 0;
            SourceId source;
        };
        std::vector<Layer> layers = {};  // that move apart from the rest of their output; they must add their light
    };
    struct Cue {
        Look look;
        Fade fade;                         // from what is seen when the cue begins to change, to its look
        std::optional<Time> follow;        // from when the cue is entered until another one is; none: it waits for an input
        std::vector<WindWish> winds = {};  // one for each output; a missing one is the usual wind
        std::string name = {};             // a revision of the list finds the cue by it
        Time wait = {};                    // from when the cue is entered until it begins to change
        std::vector<Part> parts = {};      // all else moves by `wait` and `fade`
        std::vector<int> followers = {};   // one of these follows, by chance; empty: the one after it in the list
        int times = 0;                     // so often in a row; then the one after it in the list. 0: always
        std::vector<std::uint8_t> tracksRelays = {};  // for each relay, 1: the look does not name it; a missing one: 0
        struct SideCue {
            std::size_t list = 0;  // index into `sides`
            int cue = -1;          // -1: the dark before the first
        };
        std::vector<SideCue> with = {};  // that are entered together with this one; only of the main list

        struct Speed {
            SourceId source;
            float speed = 1;
        };
        std::vector<Speed> speeds = {};       // at which sources play; a missing one plays at 1
        std::vector<SourceId> restarts = {};  // sources that begin again with this cue
        struct Ending {
            SourceId source;
            Time length{};  // of its own time, from when it comes until it is over
        };
        // With any, `follow` counts from when the look is whole and all of these are over; but at
        // least kShortestLoop passes.
        std::vector<Ending> endings = {};

        // From when the cue is entered until another one follows, if its sources come with it and
        // play at its speeds; nothing: none does.
        std::optional<Time> usualFollow() const;
        // The least that this may be.
        std::optional<Time> soonestFollow() const {
            return follow && !endings.empty() ? std::max(kShortestLoop, length() + *follow) : follow;
        }
        // From when the cue is entered until it begins to change what is seen.
        Time firstWait() const {
            Time first = wait;
            for (const Part& part : parts) first = std::min(first, part.wait);
            return first;
        }
        // From when the cue is entered until its look is whole.
        Time length() const {
            Time end = wait + fade.longer();
            for (const Part& part : parts) end = std::max(end, part.wait + part.fade.longer());
            return end;
        }
        // How a cue that was entered at `entered` moves what is seen from `at` on, by start. What
        // has begun before `at` takes the rest of its fade, but no less than `least`.
        std::vector<Movement> movements(Time entered, Time at, Time least) const;
        float speedOf(SourceId source) const {
            const auto found = std::ranges::find(speeds, source, &Speed::source);
            return found == speeds.end() ? 1 : found->speed;
        }
    };
    std::vector<Cue> cues;
    bool loops = false;                                      // the first cue comes after the last one
    std::vector<std::shared_ptr<const CueList>> sides = {};  // for the same site; they have no sides of their own
    std::string name = {};                                   // of a side
    std::optional<int> start = {};                           // of a side: entered when the main list leaves the dark
    // The list that moves the wind of each output: 0 is this one, else the side, from 1; a missing
    // one: 0.
    std::vector<std::size_t> windLists = {};
    Look dark;          // what is seen before the first cue: black pictures, levels 0, relays in their safe states
    Time goInterval{};  // after a cue was entered, GO is ignored for this long
    struct Levels {
        std::size_t first = 0, count = 0;
    };
    std::vector<Levels> fixtures = {};  // the levels of each of Site::fixtures
    double farthestShift = 0;           // a correction that moves a corner of a projector's picture farther is ignored, pixels
    double shiftSpeed = 1;              // of the fastest corner, pixels per second
    Time exchangeFade{};                // from one pattern of a source to the next
    struct {
        float least = 1;     // of the share
        double speed = 1;    // of the share, 1/s
        int relays = 0;      // that may be off
        Time relayHold{};    // after relays were switched by a trim, they stay for this long
    } trim{};                // the bounds of LampTrim; one beyond them is ignored
    Time blackoutFade{};     // from full light to none and back
    Time panicFade{};        // from full light to none in a panic
    Time darkFade{};         // from a cue to the dark before the first
    std::uint64_t seed = 1;  // of the show's own randomness: its gusts

    // The cue after a cue; -1 is before the first. Nothing: it is the last one.
    std::optional<int> after(int cue) const {
        if (cue + 1 < static_cast<int>(cues.size())) return cue + 1;
        return loops ? std::optional(0) : std::nullopt;
    }
};

}  // namespace fantascope::show
