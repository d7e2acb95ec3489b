#pragma once

#include "drivers/surroundings.h"

#include "device/dmx_port.h"
#include "device/dmx_source.h"

#include "core/config.h"

namespace fantascope::drivers {

// Streaming ACN (ANSI E1.31-2018). README.md has the keys and what goes over the network.
struct SacnPort {
    static Result<std::unique_ptr<DmxPort>> open(const ConfigNode& options, int universe, const Surroundings& around);
};
struct SacnSource {
    static Result<std::unique_ptr<DmxSource>> open(const ConfigNode& options, int universe, const Surroundings& around);
};

}  // namespace fantascope::drivers
