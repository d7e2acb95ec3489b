#pragma once

#include "drivers/common/opening.h"
#include "drivers/site/world.h"

#include "device/status.h"

#include "core/config/config.h"
#include "core/result.h"

#include <memory>
#include <string>

namespace fantascope::site {

// The device's end of its line to the world, from which it gets its status: Running while plugged
// in, else Absent; back at once when plugged in again. Thread: thread-safe, but lostAgain() is
// bound to the device's own thread.
class Plug {
public:
    // `device` is its name in the world. Losses count from now.
    Plug(World& world, std::string device, LossAction onLoss);
    // The same for a driver of the site file whose only key is `driver`; make(Plug) makes the
    // device. Error: another key, with its place in the file; when opened: there is no world.
    template <class Port, class Make>
    static Result<drivers::Opening<Port>> fromConfig(const ConfigNode& options, std::string device, LossAction onLoss,
                                                     Make make) {
        TRY(checkKeys(options));
        const auto open = [=](const drivers::DriverContext& context) -> Result<std::unique_ptr<Port>> {
            if (context.world == nullptr) return noWorld(options, device);
            return std::unique_ptr<Port>(make(Plug(*context.world, device, onLoss)));
        };
        return drivers::Opening<Port>{open, {}, true};
    }
    static Error noWorld(const ConfigNode& options, const std::string& device);

    World& world() const { return world_; }
    const std::string& device() const { return device_; }
    bool in() const { return world_.plugged(device_); }
    DeviceStatus status() const;
    // The error of a call while the device is not Running.
    Error absent() const;
    // Whether the device was lost since the last call (or since construction), even if it is back
    // already.
    bool lostAgain();

private:
    static Result<void> checkKeys(const ConfigNode& options);

    World& world_;
    std::string device_;
    LossAction onLoss_;
    int before_;   // losses before this device was opened
    int noticed_;  // losses that lostAgain() has reported
};

}  // namespace fantascope::site
