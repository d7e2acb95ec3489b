#pragma once

#include "drivers/common/found_device.h"
#include "drivers/surroundings.h"

#include "device/dmx_port.h"
#include "device/dmx_source.h"

#include "core/config.h"

#include <memory>

namespace fantascope::drivers {

// Art-Net 4 (Artistic Licence). README.md has the keys and what goes over the network.
struct ArtnetPort {
    static Result<std::unique_ptr<DmxPort>> open(const ConfigNode& options, int universe, const Surroundings& around);
};
struct ArtnetSource {
    static Result<std::unique_ptr<DmxSource>> open(const ConfigNode& options, int universe, const Surroundings& around);
};

}  // namespace fantascope::drivers
