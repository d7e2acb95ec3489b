#pragma once
// The `walkers` of the `simulation:` section; README.md lists their keys.

#include "drivers/site/body.h"
#include "drivers/site/ground_path.h"

#include "core/clock.h"
#include "core/config/config.h"

#include <optional>
#include <string>

namespace fantascope::site {

// A person who walks along a path, once or to and fro.
struct Walker {
    std::string name;
    double height = 1.75;         // metres
    glm::dvec3 reflectance{0.3};  // linear RGB, 0..1
    GroundPath path;
    double speed = 1.2;  // metres per second
    Time at{};           // when it appears at the first point
    bool loop = false;   // it walks to and fro for good; else it is gone at the end of the path

    // Nothing while it is not there.
    std::optional<Body> bodyAt(Time time) const;
};

// Strict. Error: file, line, column, key.
Result<Walker> readWalker(const ConfigNode& node);

}  // namespace fantascope::site
