#pragma once

#include "device/status.h"

#include "core/clock.h"
#include "media/image.h"

#include <cstdint>
#include <memory>
#include <string>

namespace fantascope {

// What a camera says of itself. An empty field: it does not say.
struct CameraDescription {
    std::string card;    // its driver's name for it: "HD Webcam C525"
    std::string serial;  // its USB serial number; cheap cameras have none, or all the same
    std::string format;  // what it gives: "MJPG 1280 x 720 at 30 Hz"
    std::string lacks;   // what it cannot do of what the site file asks: "exposure cannot be set"
    Time exposure{};     // the length of an exposure, if it is locked and known; 0: it is not
    friend bool operator==(const CameraDescription&, const CameraDescription&) = default;
};

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
    // The camera as it was last found; all empty before that. Thread: any.
    virtual CameraDescription description() const = 0;
};

}  // namespace fantascope
