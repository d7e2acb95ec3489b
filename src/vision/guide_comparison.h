#pragma once

#include "vision/camera_model.h"

#include "core/warp.h"
#include "media/image.h"

#include <memory>
#include <optional>

namespace fantascope::vision {

// What the site file says about one output and the camera that watches it: never more than what a
// technician measured and wrote down.
struct NominalView {
    CameraModel camera;
    CameraModel projector;
    double canvasAspect = 16.0 / 9;  // width / height
    Warp warp = Warp::straight({1, 1});
    Plane surface;  // what the picture falls on
};

// z_camera: how far the picture on the wall, as the camera sees it, is from the guide drawing; 0 is
// the guide itself. The camera's counterpart of the pattern's goal function (Ji et al. 2015,
// section 4.1), low-passed because the camera is coarse and the shapes are either white or black
// where the guide is grey.
class GuideComparison {
public:
    // `wanted`: the light wanted at every place of the canvas, 0..1, in the space that the pattern
    // was compared in: the guide's stored values for the paper's method, its linear light for one
    // that compares light. Not empty; stretched over the canvas.
    GuideComparison(const NominalView& view, const GreyImage& wanted);

    // z in [0, 1] of one camera frame (stored sRGB values), or nothing if the frame shows no
    // picture to compare: it is not of camera.size, too dark, too flat, or the camera does not see
    // most of the output. Whether the show wants the guide there at this moment is for the caller
    // to know: any other picture scores badly. Exposure, fades, the colour of the shapes and smooth
    // light of other lamps hardly matter; where the picture stands does. Thread: reentrant.
    std::optional<double> compare(const RgbaImage& frame) const;

private:
    struct Tables;
    std::shared_ptr<const Tables> tables_;
};

}  // namespace fantascope::vision
