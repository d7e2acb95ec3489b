#pragma once

#include "app/calibrate/calibration_rig.h"
#include "app/calibrate/camera_sight.h"
#include "app/calibrate/picture_schedule.h"
#include "app/site/site_models.h"

#include "vision/camera_light.h"
#include "vision/projector_response.h"
#include "vision/structured_light.h"

#include "core/clock.h"
#include "core/result.h"
#include "media/image.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::app {

// Shows structured light on the outputs of a rig, one after the other, and learns from the camera
// which projector pixel lights each of its own. Thread: the rig's.
class LightSurvey {
public:
    struct Hooks {
        std::function<bool()> goesOn;                               // false: end with what there is
        std::function<void(double done, const std::string&)> tell;  // share of the current output, and what is done
    };
    // The rig outlives the survey. The site has a camera.
    LightSurvey(CalibrationRig& rig, const show::Site& site, Hooks hooks)
        : rig_(rig), site_(site), hooks_(std::move(hooks)), light_(cameraLightOf(site)) {}

    // What one output's survey found.
    struct Output {
        vision::ProjectorMap map;
        int period = 0;                               // of the structured light, projector pixels
        GreyImage dark;                               // by camera pixel: linear light while every output is dark
        GreyImage full;                               // the same while this output is white
        double gamma = 2.2;                           // of the projector: light = stored ^ gamma
        bool gammaIsKnown = false;                    // else it is the usual one
        std::vector<vision::PrimaryLight> primaries;  // empty if the output is alone on its canvas
        int repeated = 0;                             // pictures that were shown again because something moved
    };
    // Waits for the camera, and measures how long a picture takes to be seen, on the first of
    // `outputs` that it sees. Error: the camera gives no pictures, or sees none of the outputs.
    Result<void> begin(const std::vector<std::size_t>& outputs);
    // Error: the camera does not see the output, sees nothing at all, is saturated, or was lost;
    // the survey was ended.
    Result<Output> survey(std::size_t output);

    // How far something has moved since an output was surveyed, projector pixels: the camera, the
    // projector or the wall. What is farther than `still` is looked at again, since somebody may
    // pass.
    // Error: the calibration was ended; the camera was lost, or saw too little to tell.
    Result<double> movedSince(std::size_t output, const Output& found, double still);

    // From a picture's light to its arrival here.
    Time latency() const { return latency_; }

private:
    // A picture, and the mean of the frames that showed it.
    struct Taken {
        GreyImage light;
        int frames = 0;
    };
    using Picture = std::shared_ptr<const RgbaImage>;
    using Use = std::function<void(const CalibrationRig::Seen&)>;

    Result<void> awaitCamera();
    Result<bool> measureDelay(std::size_t output);
    // Shows one refresh, and calls `use` with the frame that came, unless it has another size than
    // the site file says.
    void step(const Use& use);
    Result<void> stepUntil(Time until, const Use& use);
    // Whether no frame has come for a while. The camera's driver needs seconds to be sure of that.
    bool isSilent() const;
    // That the camera stopped, why, and what to do.
    Error stopped() const;
    // Shows `count` pictures one after the other for `frames` camera frames each; a picture that
    // was missed has no frames. `picture` makes each when it is due; `colours` gets each frame that
    // counts.
    Result<std::vector<Taken>> take(std::size_t output, std::size_t count, const std::function<Picture(std::size_t)>& picture,
                                    int frames, const std::function<void(std::size_t, const RgbaImage&)>& colours = {});
    Result<int> decode(std::size_t output, const vision::StructuredLight& light, double gamma, vision::LightDecoder& decoder);
    Result<void> measureResponse(std::size_t output, const vision::LightDecoder& sight, Output& found);

    CalibrationRig& rig_;
    const show::Site& site_;
    const Hooks hooks_;
    const vision::CameraLight light_;
    CameraSight sight_;
    Time heard_{};   // when the newest frame came
    Time period_{};  // of the camera
    PictureSchedule::Delay delay_;
    Time arrival_{};  // the longest from an exposure to its arrival
    Time latency_{};
    double done_ = 0, share_ = 0;  // progress of the current output: before, and by, the pictures under way
    std::string doing_;
};

}  // namespace fantascope::app
