#pragma once

#include "app/base/interrupt.h"
#include "app/site/site_claims.h"

#include "show/site/site.h"

#include "device/camera_source.h"

#include "core/clock.h"
#include "core/result.h"

#include <cstdint>
#include <memory>
#include <string>

namespace fantascope::app {

// A camera before which somebody moves the lens board. Thread: thread-bound.
class LensCamera {
public:
    virtual ~LensCamera() = default;
    // Waits for the camera's next frame, some milliseconds at most; null: there is none now.
    virtual std::shared_ptr<const CameraFrame> next() = 0;
    // Whether there will be no other picture: the simulated person has shown the board from all
    // sides.
    virtual bool hasEnded() const { return false; }
    virtual DeviceStatus status() const = 0;
    virtual CameraDescription description() const = 0;
};

// The site's camera alone. `options`: its driver's keys, or others for the same camera. Error:
// another program has it; the driver's, about its keys. A missing camera is no error.
Result<std::unique_ptr<LensCamera>> openCamera(const show::Site& site, const ConfigNode& options, Clock& clock,
                                               const Interrupt& interrupt);
// The same with the site's own keys. The site has a camera.
Result<std::unique_ptr<LensCamera>> openCamera(const show::Site& site, Clock& clock, const Interrupt& interrupt);

}  // namespace fantascope::app
