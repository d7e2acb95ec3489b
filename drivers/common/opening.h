#pragma once

#include "core/clock.h"
#include "core/result.h"

#include <glm/vec2.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

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

// A thing outside that a device needs, such as a serial line or an address on a network.
struct Use {
    std::string what;  // "/dev/ttyUSB0", "10.0.0.5:502"
    std::string how;   // devices that use one thing alike share it; empty: each needs it for itself
};

// A device as its driver has read it from the site file. A driver's fromConfig() refuses every
// wrong key and value and touches no device, so that a file can be checked anywhere; what it gives
// is the only way to open the device.
template <class Port>
struct Opening {
    // Error: no simulated site for a simulated driver, or no OpenGL. A device that is not there is
    // Absent.
    std::function<Result<std::unique_ptr<Port>>(const Surroundings&)> open;
    std::vector<Use> uses{};
    bool simulated = false;  // it needs Surroundings::world
    // The name of what the device takes for one program alone (Claim), "Modbus module 10.0.0.5:502
    // unit 1"; "" where any number of programs may use it. Of the device that open() would take
    // now, so that two files which tell it by other words agree; of the words where none is there.
    // It may look for the device and changes nothing of it.
    std::function<std::string()> claim = [] { return std::string(); };
};

}  // namespace fantascope::drivers
