#include "drivers/camera/simulated.h"

namespace fantascope::drivers {

Result<Opening<CameraSource>> SimulatedCamera::fromConfig(const ConfigNode& options) {
    return site::Plug::fromConfig<CameraSource>(options, "camera", LossAction::Dark,
                                                [](site::Plug plug) { return new SimulatedCamera(std::move(plug)); });
}

}  // namespace fantascope::drivers
