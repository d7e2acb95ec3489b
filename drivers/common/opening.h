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

// What every driver's open() gets besides its own part of the site file. It outlives the device.
struct DriverContext {
    Clock& clock;
    site::World* world = nullptr;  // the simulated site's state; null: nothing is simulated
};

// The request to a display driver.
struct DisplayRequest {
    std::string name;  // of the output
    glm::ivec2 size{1920, 1080};
    double refreshRate = 60;  // Hz; for displays without a rate of their own
};

// A resource that a device needs, such as a serial line or a network address.
struct Use {
    std::string what;  // "/dev/ttyUSB0", "10.0.0.5:502"
    std::string how;   // devices that use a resource in the same way share it; empty: exclusive use
};

// A device that its driver has read from the site file. A driver's fromConfig() refuses every wrong
// key and value without touching the device, so a file can be checked on any machine. Opening::open
// is the only way to open the device.
template <class Port>
struct Opening {
    // Error: a simulated driver without a simulated site, or no OpenGL. A missing device is no
    // error: it is Absent.
    std::function<Result<std::unique_ptr<Port>>(const DriverContext&)> open;
    std::vector<Use> uses{};
    bool simulated = false;  // needs DriverContext::world
    // The name of the Claim on what the device uses exclusively: "Modbus module 10.0.0.5:502 unit
    // 1". "" if any number of programs may use it. It names the device that open() would use now,
    // so two files that describe one device differently agree. If no such device is there, it
    // repeats the description. It may search for the device, but changes nothing on it.
    std::function<std::string()> claim = [] { return std::string(); };
};

}  // namespace fantascope::drivers
