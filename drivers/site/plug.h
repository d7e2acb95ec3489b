#pragma once

#include "drivers/common/surroundings.h"
#include "drivers/site/world.h"

#include "device/status.h"

#include "core/config.h"
#include "core/result.h"

#include <memory>
#include <string>

namespace fantascope::site {

// A simulated device's end of its line to the world, from which it knows whether it is there and
// what its status is: Running while plugged in, Absent otherwise, back at once when plugged in
// again. Thread: thread-safe but for lostAgain(), which belongs to the device's own thread.
class Plug {
public:
    // `device` is its name in the world. Losses count from now.
    Plug(World& world, std::string device, LossAction onLoss);
    // The same for a driver of the site file, which has no key there but `driver`: make(Plug) gives
    // the device. Error: another key, with its place in the file; at the opening: there is no
    // world.
    template <class Port, class Make>
    static Result<drivers::Opening<Port>> fromConfig(const ConfigNode& options, std::string device, LossAction onLoss,
                                                     Make make) {
        TRY(checkKeys(options));
        const auto open = [=](const drivers::Surroundings& around) -> Result<std::unique_ptr<Port>> {
            if (around.world == nullptr) return noWorld(options, device);
            return std::unique_ptr<Port>(make(Plug(*around.world, device, onLoss)));
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
    // Whether the device was lost since the last call (or the construction), even if it is back
    // already.
    bool lostAgain();

private:
    static Result<void> checkKeys(const ConfigNode& options);

    World& world_;
    std::string device_;
    LossAction onLoss_;
    int before_;   // losses before this device was opened
    int noticed_;  // losses that lostAgain() told of
};

}  // namespace fantascope::site
