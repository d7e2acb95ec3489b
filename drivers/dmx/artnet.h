#pragma once

#include "drivers/common/opening.h"

#include "device/dmx_port.h"
#include "device/dmx_source.h"

#include "core/config/config.h"

namespace fantascope::drivers {

// Art-Net 4 (Artistic Licence). README.md lists the keys and the traffic.
struct ArtnetPort {
    static Result<Opening<DmxPort>> fromConfig(const ConfigNode& options, int universe);
};
struct ArtnetSource {
    static Result<Opening<DmxSource>> fromConfig(const ConfigNode& options, int universe);
};

}  // namespace fantascope::drivers
