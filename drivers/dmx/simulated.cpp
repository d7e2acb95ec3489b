#include "drivers/dmx/simulated.h"

#include <fmt/format.h>

namespace fantascope::drivers {

Result<std::unique_ptr<DmxPort>> SimulatedDmxPort::open(const ConfigNode& options, int universe, const Surroundings& around) {
    auto plug = TRY(site::Plug::open(options, around, fmt::format("universe {}", universe), LossAction::Hold));
    return std::unique_ptr<DmxPort>(new SimulatedDmxPort(std::move(plug), universe));
}

Result<void> SimulatedDmxPort::send(std::span<const std::uint8_t, kDmxSlots> slots) {
    if (!plug_.world().setSlots(universe_, slots)) return plug_.absent();
    return {};
}

Result<std::unique_ptr<DmxSource>> SimulatedDmxSource::open(const ConfigNode& options, int universe, const Surroundings& around) {
    auto plug = TRY(site::Plug::open(options, around, fmt::format("desk {}", universe), LossAction::Hold));
    return std::unique_ptr<DmxSource>(new SimulatedDmxSource(std::move(plug), universe));
}

}  // namespace fantascope::drivers
