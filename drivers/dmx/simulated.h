#pragma once

#include "drivers/site/plug.h"

#include "device/dmx_port.h"
#include "device/dmx_source.h"

#include "core/config/config.h"

namespace fantascope::drivers {

// One universe of lamps at the simulated site. Plug: "universe N".
class SimulatedDmxPort final : public DmxPort {
public:
    static Result<Opening<DmxPort>> fromConfig(const ConfigNode& options, int universe);

    DeviceStatus status() const override { return plug_.status(); }
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override;

private:
    SimulatedDmxPort(site::Plug plug, int universe) : plug_(std::move(plug)), universe_(universe) {}
    site::Plug plug_;
    int universe_;
};

// Another lighting desk at the simulated site. Plug: "desk N".
class SimulatedDmxSource final : public DmxSource {
public:
    static Result<Opening<DmxSource>> fromConfig(const ConfigNode& options, int universe);

    DeviceStatus status() const override { return plug_.status(); }
    std::optional<DmxInput> receive() override { return plug_.world().takeFromDesk(universe_); }

private:
    SimulatedDmxSource(site::Plug plug, int universe) : plug_(std::move(plug)), universe_(universe) {}
    site::Plug plug_;
    int universe_;
};

}  // namespace fantascope::drivers
