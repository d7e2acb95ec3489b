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
    std::uint64_t sequence = 0;  // the camera's own count; a gap means dropped frames
};

// A camera that watches the site. Thread: bound to the vision thread.
class CameraSource : public Device {
public:
    // The newest frame that was not taken yet; null if there is none. Never waits. Older frames are
    // dropped, so `sequence` and `exposed` only rise. A frame stays valid while it is held.
    // Loss: null until new frames arrive.
    virtual std::shared_ptr<const CameraFrame> newest() = 0;
};

}  // namespace fantascope
