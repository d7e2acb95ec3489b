#pragma once

#include <string>

namespace fantascope::drivers {

// A device that this machine has, or that answers on its network, whether or not a site file names
// it.
struct FoundDevice {
    std::string family;    // as the folder of its driver: "dmx", "camera"
    std::string what;      // "ENTTEC DMX USB PRO, firmware 1.44"
    std::string identity;  // by what it is told from its like: "serial EN123456"
    std::string where;     // "/dev/ttyUSB0", "10.0.0.5"
    std::string why;       // why it cannot be used and what to do about it; empty where it can
    std::string options;   // what a site file says to use it: "{driver: enttec_pro, serial: EN123456}"
};

}  // namespace fantascope::drivers
