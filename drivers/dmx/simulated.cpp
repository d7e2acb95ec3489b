#include "drivers/dmx/simulated.h"

#include <fmt/format.h>

namespace fantascope::drivers {

Result<Opening<DmxPort>> SimulatedDmxPort::fromConfig(const ConfigNode& options, int universe) {
    return site::Plug::fromConfig<DmxPort>(
        options, fmt::format("universe {}", universe), LossAction::Hold,
        [universe](site::Plug plug) { return new SimulatedDmxPort(std::move(plug), universe); });
}

Result<void> SimulatedDmxPort::send(std::span<const std::uint8_t, kDmxSlots> slots) {
    if (!plug_.world().setSlots(universe_, slots)) return plug_.absent();
    return {};
}

Result<Opening<DmxSource>> SimulatedDmxSource::fromConfig(const ConfigNode& options, int universe) {
    return site::Plug::fromConfig<DmxSource>(
        options, fmt::format("desk {}", universe), LossAction::Hold,
        [universe](site::Plug plug) { return new SimulatedDmxSource(std::move(plug), universe); });
}

}  // namespace fantascope::drivers
