#pragma once
// The one value that the show gives out: what is to be seen at one moment. Renderer and lighting
// read it; nothing flows back.

#include "show/source_id.h"

#include "core/clock.h"
#include "core/wind.h"

#include <cstdint>
#include <vector>

namespace fantascope::show {

// How a layer lies on those below it, all in linear light.
enum class Blend {
    Add,       // as another projector's light would
    Over,      // covers them where it is drawn
    Multiply,  // lets through as much of their light as its own says, as a slide does
    Screen     // as Add, but light on light comes to no more than white
};

// One picture source on one output.
struct LayerState {
    SourceId source;
    float opacity = 0;  // 0..1, in linear light
    Blend blend = Blend::Add;
    Time begun{};  // show time at which the source came onto the output: where a video begins
    friend bool operator==(const LayerState&, const LayerState&) = default;
};

// Layers [first, last) that are composed from black, the first at the bottom.
struct ComposedPicture {
    std::uint32_t first = 0, last = 0;
    float share = 1;  // of its light
    friend bool operator==(const ComposedPicture&, const ComposedPicture&) = default;
};

// One output's picture: the light of its layers and pictures, added up; nothing is black. Layers
// before those of the first picture add as light one by one, each source once.
struct OutputState {
    std::vector<LayerState> layers;
    std::vector<ComposedPicture> pictures{};  // in the order of their layers
    friend bool operator==(const OutputState&, const OutputState&) = default;
};

// Everything that the site can show, in the site's order.
struct Look {
    std::vector<OutputState> outputs;  // one for each of Site::outputs
    std::vector<float> levels;         // 0..1 linear, one for each channel of each of Site::fixtures
    std::vector<std::uint8_t> relays;  // 1: on, one for each of Site::relays
    friend bool operator==(const Look&, const Look&) = default;
};

// The look of one moment of show time. Value type; reused from frame to frame, so that its vectors
// keep their capacity.
struct ShowState : Look {
    std::vector<Wind> winds;   // one for each of Site::outputs
    Time time{};               // show time
    int cue = -1;              // index into Show::cues of the cue that was entered last; -1 before the first
    bool blackout = false;     // the operator holds the pictures and the lamps dark
    std::uint64_t inputs = 0;  // how many inputs have taken effect so far
    friend bool operator==(const ShowState&, const ShowState&) = default;
};

}  // namespace fantascope::show
