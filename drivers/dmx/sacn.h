#pragma once

#include "drivers/common/opening.h"

#include "device/dmx_port.h"
#include "device/dmx_source.h"

#include "core/config/config.h"

namespace fantascope::drivers {

// Streaming ACN (ANSI E1.31-2018). README.md lists the keys and the traffic.
struct SacnPort {
    static Result<Opening<DmxPort>> fromConfig(const ConfigNode& options, int universe);
};
struct SacnSource {
    static Result<Opening<DmxSource>> fromConfig(const ConfigNode& options, int universe);
};

}  // namespace fantascope::drivers
