#include "drivers/camera/simulated.h"

namespace fantascope::drivers {

Result<std::unique_ptr<CameraSource>> SimulatedCamera::open(const ConfigNode& options, const Surroundings& around) {
    auto plug = TRY(site::Plug::open(options, around, "camera", LossAction::Dark));
    return std::unique_ptr<CameraSource>(new SimulatedCamera(std::move(plug)));
}

}  // namespace fantascope::drivers
