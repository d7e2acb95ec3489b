#pragma once

#include "vision/camera_light.h"
#include "vision/watch/light_meter.h"
#include "vision/watch/output_view.h"
#include "vision/watch/registration.h"
#include "vision/watch/surroundings.h"
#include "vision/watch/wall_reflectance.h"

#include "media/image.h"

#include <memory>
#include <optional>
#include <vector>

namespace fantascope::vision {

// An output that the camera watches.
struct WatchedOutput {
    ProjectorMap map;         // which of its pixels lights each camera pixel, when all stands as it should
    bool isSurveyed = false;  // `map` was measured, so its light shows the surface's texture too
    glm::ivec2 projector{0};  // its pixels
    double gamma = 2.2;       // light = stored ^ gamma
    GreyImage dark{};         // by camera pixel: linear light while all outputs are dark; empty: unknown
};

// What one camera picture says of one output.
struct OutputSight {
    // Where the picture is now: what was lit by projector pixel p is lit by shownFromPlace(p). The
    // identity: nothing has moved.
    Homography shownFromPlace;
    double sigma = 0;      // standard deviation of that, rms over the picture, projector pixels
    double gain = 0;       // contrast on the wall / what full light is said to give
    double agreement = 0;  // correlation with the prediction where they agree at all, -1..1
    double used = 0;       // share of the pixels with content that agree
    // Whether the surface stayed where it was in the camera's picture: it did if the projector
    // moved, and moved with the picture if the camera did. In standard deviations; positive: the
    // surface stayed; 0: it has no texture, or nothing moved.
    double surfaceStayed = 0;
};

// What one camera picture says of the light.
struct WallLight {
    std::vector<std::optional<OutputLight>> outputs;  // nothing: the picture says nothing of it, or it is not known what is usual
    std::optional<SurroundingsLight> surroundings;    // nothing: there are none, or it is not known what is usual
    bool isSettling = false;                          // it will be known soon what is usual around the pictures
};

// A movement of the camera that explains how the pictures moved.
struct CameraMovement {
    double px = 0;      // rms movement of what the camera sees, its pixels
    double missed = 0;  // rms of what such a movement does not explain, its pixels
};

// Watches the outputs on the wall while the show runs. It predicts what the camera sees from what
// the projectors show, and registers that with what it does see. So it needs no test pictures
// (Johnson & Fuchs 2007: predict the camera's picture, not the projector's). Thread: thread-bound.
class WallWatch {
public:
    // `outputs`: nothing for an output that cannot be watched. `camera`: pixels of its picture.
    // `light`: how it stores light.
    WallWatch(const std::vector<std::optional<WatchedOutput>>& outputs, glm::ivec2 camera, const CameraLight& light = {});
    ~WallWatch();
    WallWatch(const WallWatch&) = delete;
    WallWatch& operator=(const WallWatch&) = delete;

    bool watches(std::size_t output) const;
    // The light of a frame by cells of the output's view, for look(). The output is watched.
    GreyImage lightOf(std::size_t output, const RgbaImage& frame) const;
    // Looks at a camera picture of the right size. `shown`: by output the light of the frame that
    // was visible when the picture was exposed; null: unknown. The result is by output; nothing:
    // the picture says nothing about this output, because it is dark, hidden or without content.
    std::vector<std::optional<OutputSight>> look(const RgbaImage& picture, const std::vector<const GreyImage*>& shown);
    // Measures the light in the picture that was looked at last, which takes about as long as ten
    // looks.
    WallLight measureLight();
    // Measures by the picture that was looked at last what the surface gives back of a surveyed
    // output. False: the picture says nothing of that.
    bool measureSurface(std::size_t output);
    // What those pictures say. The output is watched and surveyed.
    WallChange surfaceChange(std::size_t output) const;
    // Whether the picture that was looked at last is upside down: turned, it shows an output that
    // it does not show as it is.
    bool isUpsideDown() const;
    // Other lamps change, so their light is no fault. Nothing: they are changing.
    void lampsChange(const std::optional<LampState>& state);
    // The movement of the camera that best explains movements of pictures, as OutputSight has them;
    // null: an output that says nothing. Nothing: too few places are seen.
    std::optional<CameraMovement> cameraMovement(const std::vector<const Homography*>& shownFromPlace) const;

private:
    struct Output;
    struct Seen;
    GreyImage lightSeen(const RgbaImage& picture) const;
    Seen seenOf(std::size_t output, const GreyImage& light, const std::vector<GreyImage>& predicted) const;
    void findShared();
    GreyImage lightBeside(std::size_t output) const;
    void findAlone();
    void findSurroundings();

    glm::ivec2 camera_;
    int step_;  // camera pixels that count as one
    CameraLight light_;
    GreyImage dark_;
    GreyImage seen_;  // the picture that was looked at last, by coarse pixels
    std::optional<Surroundings> surroundings_;
    std::vector<std::unique_ptr<Output>> outputs_;
};

}  // namespace fantascope::vision
