#pragma once
// The show's only result: what is seen at one moment. Renderer and lighting read it and send
// nothing back.

#include "show/course/lamp_trim.h"
#include "show/course/picture_shift.h"
#include "show/pattern_exchange.h"
#include "show/source_id.h"

#include "core/clock.h"
#include "core/wind.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace fantascope::show {

// How a layer combines with the layers below it, all in linear light.
enum class Blend {
    Add,       // adds its light, as another projector would
    Over,      // covers them where it is drawn
    Multiply,  // filters their light by its own, as a slide does
    Screen     // adds its light, but the sum does not exceed white
};

// One picture source on one output.
struct LayerState {
    SourceId source;
    float opacity = 0;  // 0..1, in linear light
    Blend blend = Blend::Add;
    Time begun{};                // own time of the source (PlayCourse) when it came onto the output; a video begins there
    PatternExchange exchange{};  // which of its patterns are seen
    Time behind{};               // by how much its own time is behind cue time
    float speed = 1;             // at which its own time goes by
    friend bool operator==(const LayerState&, const LayerState&) = default;
};

// Layers [first, last), composed from black; the first is at the bottom.
struct ComposedPicture {
    std::uint32_t first = 0, last = 0;
    float share = 1;  // of its light
    friend bool operator==(const ComposedPicture&, const ComposedPicture&) = default;
};

// One output's picture: the sum of the light of its layers and pictures; without any it is black.
// Layers before those of the first picture add their light one by one, each source once.
struct OutputState {
    std::vector<LayerState> layers;
    std::vector<ComposedPicture> pictures{};  // in the order of their layers
    friend bool operator==(const OutputState&, const OutputState&) = default;
};

// The layers that add their light one by one.
inline std::span<const LayerState> addedLayers(const OutputState& output) {
    return std::span(output.layers).first(output.pictures.empty() ? output.layers.size() : output.pictures[0].first);
}

// Everything that the site can show, in the site's order.
struct Look {
    std::vector<OutputState> outputs;  // one for each of Site::outputs
    std::vector<float> levels;         // 0..1 linear, one for each channel of each of Site::fixtures
    std::vector<std::uint8_t> relays;  // 1: on, one for each of Site::relays
    friend bool operator==(const Look&, const Look&) = default;
};

// Where a list of cues is.
struct ListPlace {
    int cue = -1;               // index into its cues of the current one; -1 before the first
    int loaded = -1;            // the cue that GO is to enter; -1: the one after the current one
    std::optional<int> next{};  // the cue that GO enters; nothing: there is none
    friend bool operator==(const ListPlace&, const ListPlace&) = default;
};

// A lamp, an index into Site::fixtures, that a person lets shine at least so bright.
struct RaisedLamp {
    int fixture = -1;
    float level = 0;
    friend bool operator==(const RaisedLamp&, const RaisedLamp&) = default;
};
// A relay, an index into Site::relays, that a person has switched, and no cue since.
struct SwitchedRelay {
    int relay = -1;
    bool on = false;
    friend bool operator==(const SwitchedRelay&, const SwitchedRelay&) = default;
};

// Where the cues are, and what the operator does to them.
struct Controls {
    int cue = -1;               // index into Show::cues of the current cue; -1 before the first
    int loaded = -1;            // the cue that GO is to enter; -1: the one after the current one
    std::optional<int> next{};  // the cue that GO enters; nothing: there is none
    bool blackout = false;      // pictures and fixtures are held dark
    bool panic = false;         // they are held dark, and relays safe, until the operator restores them
    bool paused = false;        // the cues' time is paused
    bool frozen = false;        // what is seen is kept, whatever the cues do
    float master = 1;           // the factor of pictures and levels that is wanted
    bool locked = false;        // nothing but darkness is taken from hand controller, contacts and windows
    int highlight = -1;         // index into Site::fixtures of the one that is shown at `highlightLevel`; -1: none
    float highlightLevel = 1;
    bool solo = false;                      // nothing is shown but that one
    std::vector<int> parked{};              // indices into Site::fixtures of those that stay as they are; ascending
    std::vector<RaisedLamp> raised{};       // ascending
    std::vector<SwitchedRelay> switched{};  // ascending
    std::vector<ListPlace> sides{};         // of each list that plays beside the main one
    friend bool operator==(const Controls&, const Controls&) = default;
};

// The ways in which an operator holds a show.
enum class Hold { Blackout, Panic, Pause, Freeze, Lock };
// Each, in that order: its name, and whether it is on.
constexpr struct {
    std::string_view name;
    bool Controls::*on;
} kHolds[] = {{"blackout", &Controls::blackout},
              {"panic", &Controls::panic},
              {"pause", &Controls::paused},
              {"freeze", &Controls::frozen},
              {"lock", &Controls::locked}};

// The look at one moment of show time. Value type. Reuse it from frame to frame: its vectors keep
// their capacity.
struct ShowState : Look, Controls {
    std::vector<Wind> winds;           // one for each of Site::outputs
    std::vector<PictureShift> shifts;  // one for each of Site::outputs
    LampTrim lamps{};                  // `levels` and `relays` are without it
    bool corrects = true;              // corrections are allowed
    Time time{};                       // show time
    Time cueTime{};                    // by which sources move, but for LayerState::behind
    bool moves = true;                 // cueTime goes on; else it stands still
    std::uint64_t inputs = 0;          // how many inputs have taken effect so far
    std::uint64_t revision = 0;        // how many revisions of the show are among them
    friend bool operator==(const ShowState&, const ShowState&) = default;
};

}  // namespace fantascope::show
