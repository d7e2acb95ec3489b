#pragma once

#include "core/clock.h"

#include <glm/vec2.hpp>

#include <string>

namespace fantascope::site {
class World;
}

namespace fantascope::drivers {

// What every driver's open() is handed besides its own part of the site file. Outlives the device.
struct Surroundings {
    Clock& clock;
    site::World* world = nullptr;  // the simulated site's state; null where nothing is simulated
};

// What a display driver is asked for.
struct DisplayRequest {
    std::string name;  // the output's
    glm::ivec2 size{1920, 1080};
    double refreshRate = 60;  // Hz; what a display without a rate of its own runs at
};

}  // namespace fantascope::drivers
