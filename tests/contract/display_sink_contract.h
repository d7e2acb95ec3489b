#pragma once
// What every display promises (src/device/display_sink.h).

#include "device/display_sink.h"

#include "contract/contract.h"
#include "core/clock.h"

#include <glm/vec2.hpp>

#include <functional>
#include <memory>
#include <string>

namespace fantascope::contract {

// A display under test on a clock that stands still unless it is moved, so that whoever waits is found out.
struct DisplaySinkRig {
    // What was asked of open().
    std::string name;
    glm::ivec2 size{0};

    std::shared_ptr<ManualClock> clock;
    std::shared_ptr<void> surroundings;  // whatever else must outlive the display
    std::unique_ptr<DisplaySink> sink;
    std::unique_ptr<DisplaySink> neighbour;  // another output of the same kind on the same thread
    std::function<void()> unplug, plugIn;
};

Suite<DisplaySinkRig> displaySinkContract();

}  // namespace fantascope::contract
