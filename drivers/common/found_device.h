#pragma once

#include <string>

namespace fantascope::drivers {

// A device on this machine or its network, whether or not a site file names it.
struct FoundDevice {
    std::string family;    // the folder of its driver: "dmx", "camera"
    std::string what;      // "ENTTEC DMX USB PRO, firmware 1.44"
    std::string identity;  // what tells it from others of its kind: "serial EN123456"
    std::string where;     // "/dev/ttyUSB0", "10.0.0.5"
    std::string why;       // why it cannot be used and what to do about it; empty: it can be used
    std::string options;   // for the site file: "{driver: enttec_pro, serial: EN123456}"
};

}  // namespace fantascope::drivers
