#pragma once
// The one value that the show gives out: what is to be seen at one moment. Renderer and lighting read it; nothing flows back.

#include <cstdint>
#include <vector>

#include "core/clock.h"

namespace fantascope::show {

// One picture source on one output.
struct LayerState {
    std::uint32_t source = 0;  // index into Show::sources
    float opacity = 0;         // 0..1, in linear light
};

// One output's picture: its layers from the bottom up, each added as light. An empty list is black.
struct OutputState {
    std::vector<LayerState> layers;
};

// Everything at one moment of show time. Value type; reused from frame to frame, so that its vectors keep their capacity.
struct ShowState {
    Time time{};                    // show time
    int cue = -1;                   // index into Show::cues of the cue that was entered last; -1 before the first
    bool blackout = false;          // the operator holds the picture and the lamps dark
    std::uint64_t inputs = 0;       // how many inputs have taken effect so far
    std::vector<OutputState> outputs;  // in the order of the site's outputs
    std::vector<float> levels;      // 0..1 linear, one for every fixture channel, in the patch's order
    std::vector<std::uint8_t> relays;  // 1: on, in the patch's order
};

}  // namespace fantascope::show
