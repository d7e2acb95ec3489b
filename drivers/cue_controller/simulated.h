#pragma once

#include "drivers/site/plug.h"

#include "device/cue_controller.h"

#include "core/config/config.h"

#include <set>

namespace fantascope::drivers {

// The hand controller of the simulated site, pressed by World::press(). Plug: "cue controller".
class SimulatedCueController final : public CueController {
public:
    static Result<Opening<CueController>> fromConfig(const ConfigNode& options);
    ~SimulatedCueController() override;

    DeviceStatus status() const override { return plug_.status(); }
    std::optional<ButtonEvent> poll() override;
    void light(int button, const ButtonLight& light) override;

private:
    explicit SimulatedCueController(site::Plug plug) : plug_(std::move(plug)) {}
    site::Plug plug_;
    std::set<int> down_;  // buttons whose press was polled
    std::set<int> lost_;  // those of down_ whose release was lost
    std::set<int> told_;  // buttons that were given a light
};

}  // namespace fantascope::drivers
