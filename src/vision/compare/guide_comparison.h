#pragma once

#include "vision/nominal_view.h"

#include "media/image.h"

#include <memory>
#include <optional>

namespace fantascope::vision {

// How far a picture on the wall differs from what was wanted; each in [0, 1], 0 is the guide
// itself.
struct Likeness {
    double z = 1;                // z_camera
    std::optional<double> tone;  // tone_camera; nothing: no light is left that is the picture's
    friend bool operator==(const Likeness&, const Likeness&) = default;
};

// What is compared for z_camera, as pictures of the canvas. A cell is a 72nd of its height. Values
// are 0 where the camera does not see the output.
struct ComparedPictures {
    GreyImage wanted;      // by cell: blurred, and darker where the projector's fall-off is intended
    GreyImage seen;        // the same of the camera's picture with its exposure fitted; not blurred, and 3 x 3 values a cell
    GreyImage difference;  // by cell: seen - wanted, both blurred and without the fall-off, -1..1; z is the mean of its magnitude
    GreyImage inSight;     // by cell: 1 where the camera sees the output, else 0
};

// z_camera: how far the picture on the wall, as the camera sees it, differs from the guide drawing;
// 0 is the guide itself. It is the camera's counterpart of the pattern's goal function (Ji et al.
// 2015, section 4.1), low-passed because the camera is coarse and the shapes are white or black
// where the guide is grey. The projector's own fall-off counts as intended, unless it is evened
// out.
//
// tone_camera: the same in linear light, whatever the pattern was compared in, and of the light as
// it is: the wanted light at every place is the guide times one constant, without a lift, and
// fall-off counts as a fault. Of a guide with little contrast, z_camera takes stains for contrast;
// tone_camera does not.
class GuideComparison {
public:
    // `wanted`: the wanted light at every place of the canvas, 0..1, in the space in which the
    // pattern was compared: the guide's stored values for the paper's method, its linear light for
    // a method that compares light. `light`: the same in linear light. Neither is empty; both are
    // stretched over the canvas.
    GuideComparison(const NominalView& view, const GreyImage& wanted, const GreyImage& light);

    // Of one camera frame (stored sRGB values). Nothing if the frame shows no picture to compare:
    // it is not of camera.size, too dark or too flat, or the camera does not see most of the
    // output. The caller must know whether the show displays the guide at this moment: any other
    // picture scores badly. Exposure, fades, the colour of the shapes and smooth light of other
    // lamps hardly matter; the picture's place does. Thread: reentrant.
    std::optional<Likeness> compare(const RgbaImage& frame) const;
    // The same comparison as pictures; nothing where compare() has nothing. Thread: reentrant.
    std::optional<ComparedPictures> pictures(const RgbaImage& frame) const;

private:
    struct Tables;
    std::shared_ptr<const Tables> tables_;
};

}  // namespace fantascope::vision
