#pragma once

#include "drivers/site/plug.h"

#include "device/camera_source.h"

#include "core/config/config.h"

namespace fantascope::drivers {

// The camera of the simulated site. site::SimulatedSite sends its frames through the world.
// Plug: "camera".
class SimulatedCamera final : public CameraSource {
public:
    static Result<Opening<CameraSource>> fromConfig(const ConfigNode& options);

    DeviceStatus status() const override { return plug_.status(); }
    std::shared_ptr<const CameraFrame> newest() override { return plug_.world().takeFromCamera(); }
    CameraDescription description() const override {
        return {.card = "simulated", .serial = {}, .format = {}, .lacks = {}, .exposure = {}};
    }

private:
    explicit SimulatedCamera(site::Plug plug) : plug_(std::move(plug)) {}
    site::Plug plug_;
};

}  // namespace fantascope::drivers
