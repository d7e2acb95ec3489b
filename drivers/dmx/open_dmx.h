#pragma once

#include "drivers/byte_stream/serial.h"
#include "drivers/common/opening.h"
#include "drivers/common/service.h"
#include "drivers/dmx/enttec_message.h"
#include "drivers/dmx/widget_search.h"

#include "device/dmx_port.h"

#include "core/config/config.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace fantascope::drivers {

// A universe sent by an Enttec Open DMX USB or another bare serial adapter. This program generates
// every break and every byte itself.
class OpenDmxPort final : public DmxPort {
public:
    static Result<Opening<DmxPort>> fromConfig(const ConfigNode& options, int universe);

    DeviceStatus status() const override { return service_.status(); }
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override;

private:
    struct Options {
        WidgetChoice which;
        Time breakTime, markAfterBreak;
        double rate;  // frames a second
    };
    OpenDmxPort(const std::string& name, const Options& options, Clock& clock);
    Outage runOnce(Service& service);
    Result<void> repeat(Service& service);
    Result<void> sendPacket(const DmxPacket& packet);

    const Options options_;
    Clock& clock_;
    std::mutex mutex_;
    std::optional<DmxPacket> newest_;
    SerialStream line_;
    Service service_;
};

}  // namespace fantascope::drivers
