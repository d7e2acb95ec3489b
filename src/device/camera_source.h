#pragma once

#include "device/status.h"

#include "core/clock.h"
#include "media/image.h"

#include <cstdint>
#include <memory>

namespace fantascope {

struct CameraFrame {
    RgbaImage image;             // stored values, as the camera gives them; alpha 255
    Time exposed{};              // the middle of the exposure, on the clock that open() was handed
    std::uint64_t sequence = 0;  // the camera's own count; a gap says that frames were dropped
};

// A camera that watches the site. Thread: bound to the vision thread.
class CameraSource : public Device {
public:
    // The newest frame that has arrived and was not taken yet, or null. Never waits; older frames
    // are dropped, so `sequence` and `exposed` only rise. A frame stays valid for as long as it is
    // held; the next ones go elsewhere.
    // Loss: null until frames come again.
    virtual std::shared_ptr<const CameraFrame> newest() = 0;
};

}  // namespace fantascope
