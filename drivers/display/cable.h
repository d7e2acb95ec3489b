#pragma once

#include "drivers/common/opening.h"
#include "drivers/site/plug.h"

#include "device/status.h"

#include "core/result.h"

#include <optional>
#include <string>

namespace fantascope::drivers {

// What a simulated site does to an output: it unplugs the line to the projector, or has OpenGL
// fail. Without a simulated site the line counts as plugged in, and OpenGL as working.
// Thread: thread-safe.
class Cable {
public:
    Cable(const DisplayRequest& request, const DriverContext& context) : name_(request.name) {
        if (context.world != nullptr) plug_.emplace(*context.world, name_, LossAction::Dark);
    }

    bool in() const { return !plug_ || plug_->in(); }
    // Error: it is unplugged.
    Result<void> check() const {
        if (in()) return {};
        return plug_->absent();
    }
    // Error: a simulated site has OpenGL fail for this output.
    Result<void> checkGraphics() const {
        if (!plug_ || plug_->world().graphicsWork(name_)) return {};
        return Error(name_ + ": its OpenGL fails, by a fault of the simulated site");
    }
    // The status of a display of `driver` that fails only by its cable.
    DeviceStatus status(const std::string& driver) const {
        DeviceStatus status{name_, driver, DeviceState::Running, LossAction::Dark, "", 0};
        if (plug_) status = plug_->status();
        status.driver = driver;
        return status;
    }

private:
    std::string name_;
    std::optional<site::Plug> plug_;
};

}  // namespace fantascope::drivers
