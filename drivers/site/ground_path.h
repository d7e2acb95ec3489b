#pragma once

#include "core/config/config.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace fantascope::site {

// A way over the ground along straight lines: at least two points [x, z], each apart from the one
// before.
class GroundPath {
public:
    GroundPath() = default;  // no path yet: only to be assigned to
    // Error: file, line, column, key.
    static Result<GroundPath> read(const ConfigNode& node);

    double length() const;  // metres
    struct Place {
        glm::dvec3 position{0.0};       // on the ground
        glm::dvec3 direction{0, 0, 1};  // of travel, unit
    };
    // The place after `distance` metres, 0 .. length().
    Place at(double distance) const;

private:
    std::vector<glm::dvec2> points_;
    std::vector<double> distances_;  // of the points, along the path
};

}  // namespace fantascope::site
