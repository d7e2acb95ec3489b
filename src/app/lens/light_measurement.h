#pragma once

#include "app/lens/lens_camera.h"
#include "app/lens/lens_file.h"

#include "core/result.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace fantascope::app {

// What a measurement of a camera's light found.
struct LightResult {
    KeptLight light;
    double dark = 0;      // the stored value without light, 0..255
    int exposures = 0;    // by which the response was measured; 0: sRGB was taken
    double rms = 0;       // of light, as a share of it
    std::string trouble;  // why sRGB was taken; empty: the response was measured
    CameraDescription camera;

    // "dark level 2.1 of 255, 3 hot pixels; response from 6 exposures, ...".
    std::string sentence() const;
};

// Measures a camera's dark frame, for which a person covers its lens, and then its response by
// exposures of known times, for which the lens is free and nothing moves. Thread: the caller's.
class LightMeasurement {
public:
    // Opens the camera, with its exposure locked at so many units of 100 us, or as the site file
    // says.
    using Open = std::function<Result<std::unique_ptr<LensCamera>>(std::optional<int> exposure)>;
    struct Hooks {
        std::function<bool()> goesOn;                               // false: end
        std::function<void(double done, const std::string&)> tell;  // what the person is to do, or what is done
    };
    LightMeasurement(Open open, const Clock& clock, Hooks hooks)
        : open_(std::move(open)), clock_(clock), hooks_(std::move(hooks)) {}

    // `middle`: the exposure around which others are taken, units of 100 us.
    // Error: the camera gives no picture; it was ended; so many hot pixels that the lens was not
    // covered. A camera whose exposure cannot be set is no error: sRGB is taken.
    Result<LightResult> measure(int middle);

private:
    using Frame = std::shared_ptr<const CameraFrame>;
    Result<Frame> next(LensCamera& camera);
    Result<void> await(LensCamera& camera, bool dark, const std::string& what);
    Result<GreyImage> mean(LensCamera& camera, int skipped);
    std::string measureResponse(int middle, LightResult& result);

    const Open open_;
    const Clock& clock_;
    const Hooks hooks_;
};

}  // namespace fantascope::app
