#include "drivers/site/plug.h"

#include <fmt/format.h>

#include <utility>

namespace fantascope::site {
namespace {

constexpr const char* kAdvice = "unplugged in the simulated site; plug it in again";

}  // namespace

Plug::Plug(World& world, std::string device, LossAction onLoss)
    : world_(world), device_(std::move(device)), onLoss_(onLoss), before_(world.losses(device_)), noticed_(before_) {}

Result<void> Plug::checkKeys(const ConfigNode& options) {
    std::string driver;
    ConfigFields fields(options);
    fields.text("driver", driver);
    return fields.finish();
}

Error Plug::noWorld(const ConfigNode& options, const std::string& device) {
    return options.error(
        fmt::format("{}: driver 'simulated' needs a simulated site, and there is none; rehearse, or name a real driver", device));
}

DeviceStatus Plug::status() const {
    DeviceStatus status;
    status.name = device_;
    status.driver = "simulated";
    status.state = in() ? DeviceState::Running : DeviceState::Absent;
    status.onLoss = onLoss_;
    if (status.state != DeviceState::Running) status.detail = kAdvice;
    status.losses = world_.losses(device_) - before_;
    return status;
}

Error Plug::absent() const { return Error(fmt::format("{} is absent: {}", device_, kAdvice)); }

bool Plug::lostAgain() { return std::exchange(noticed_, world_.losses(device_)) != noticed_; }

}  // namespace fantascope::site
