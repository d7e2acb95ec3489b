#pragma once

#include "app/live/frame_loop.h"
#include "app/parts/part.h"
#include "app/site/open_site.h"
#include "app/site/site_claims.h"

#include "show/play/input_log.h"
#include "show/play/show_clock.h"
#include "show/site/site.h"

#include "device/camera_source.h"

#include "core/clock.h"
#include "core/result.h"
#include "media/image.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace fantascope::app {

// The outputs of a site and its camera, for pictures that are sent pixel by pixel. On the simulated
// site a stepped clock runs as fast as it can, so the same seed gives the same pictures. Fixtures
// and relays of a real site are left alone. Thread: thread-bound, to the render thread.
class CalibrationRig {
public:
    struct Options {
        bool simulate = false;
        std::uint64_t seed = 1;  // of the simulated site's noise
        std::filesystem::path assets;
    };
    // Opens the displays and the camera; every output is dark. Error:
    // another program has one of them; there is no camera; a display cannot draw.
    static Result<std::unique_ptr<CalibrationRig>> open(const show::Site& site, const Options& options,
                                                        const Interrupt& interrupt);
    ~CalibrationRig();

    // Shows a picture of the output's size from the next step on, stored values as they are sent to
    // the projector; null: black.
    void show(std::size_t output, std::shared_ptr<const RgbaImage> picture);
    // A picture that the camera took, and when it arrived here.
    struct Seen {
        std::shared_ptr<const CameraFrame> frame;
        Time arrived{};
    };
    // Shows one refresh. Returns the camera's newest picture, if there is another one since.
    std::optional<Seen> step();
    Time now() const { return clock_->now(); }
    // Why the camera, or an output, cannot be used now; empty: it can.
    std::string cameraTrouble() const;
    CameraDescription camera() const { return open_->devices.camera->description(); }
    std::string outputTrouble(std::size_t output) const;

private:
    CalibrationRig(const show::Site& site, const Options& options);
    Result<void> begin(const Options& options, const Interrupt& interrupt);

    show::Site used_;  // what is opened: without fixtures and relays, if they are real
    SteadyClock steady_;
    SteppedClock stepped_;
    Clock* clock_;
    SiteClaims claims_;
    std::unique_ptr<OpenSite> open_;
    std::unique_ptr<show::InputLog> inputs_;
    std::unique_ptr<FrameLoop> frames_;
    std::vector<render::NewestFrame*> wall_;  // what simulated projectors throw; empty if they are real
};

}  // namespace fantascope::app
