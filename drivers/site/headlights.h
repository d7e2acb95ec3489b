#pragma once
// The `headlights` of the `simulation:` section; README.md lists their keys.

#include "drivers/site/ground_path.h"
#include "drivers/site/lamp.h"

#include "core/clock.h"
#include "core/config/config.h"

#include <optional>

namespace fantascope::site {

// A lamp that moves along a path and shines where it goes.
struct Headlight {
    Lamp lamp;  // its place and aim count for nothing
    GroundPath path;
    double speed = 10;          // metres per second
    double height = 0.6;        // metres above the ground
    Time at{};                  // when it first enters the path
    std::optional<Time> every;  // from one entry to the next; nothing: it passes once

    // How long it takes to pass, seconds.
    double duration() const { return path.length() / speed; }
    // Nothing while it is not there.
    std::optional<Lamp> lampAt(Time time) const;
};

// Strict. Error: file, line, column, key.
Result<Headlight> readHeadlight(const ConfigNode& node);

}  // namespace fantascope::site
