#pragma once

#include "vision/nominal_view.h"

#include "media/image.h"

#include <glm/vec3.hpp>

#include <memory>
#include <optional>

namespace fantascope::vision {

// iou_camera: the intersection over union of the shadow on the wall, as the camera sees it, and the
// wanted one; 1: they are the same.
//
// The canvas is divided into cells, about as fine as the camera's pixels. Their light is modelled as
// a smooth lit level. Where there is shadow, it is less by the projector's light, which falls off as
// the projector's place tells. Level and loss are fitted to the frame together with the classes of
// the cells, without knowledge of the wanted shadow. A cell is shadow if it is nearer to the
// shadow's light than to the lit level, so the edge of a soft shadow is where half of the light is
// left. Ambient light and lamps hardly matter if their light is smooth over the canvas. The hard
// edge of a lamp's light, or paint on the wall that is as dark as the shadow, is taken for shadow.
class ShadowComparison {
public:
    static constexpr int kRows = 144;  // cells down the canvas if the camera's pixels are fine enough

    // `difference`: the light of a lit place less that of a place in shadow, by channel; not all 0.
    // `counted`: above a half where a place of the canvas counts; stretched over the canvas.
    ShadowComparison(const NominalView& view, glm::dvec3 difference, const GreyImage& counted);

    // Of one camera frame (stored sRGB values). `wanted`: above a half where a shadow is wanted;
    // stretched over the canvas. Nothing if the frame shows no shadow that stands out against
    // light: it is not of camera.size, too dark or too flat, or the camera does not see most of
    // what counts. The caller must know whether the show displays the shadow at this moment.
    // Thread: reentrant.
    std::optional<double> compare(const RgbaImage& frame, const GreyImage& wanted) const;

private:
    struct Tables;
    std::shared_ptr<const Tables> tables_;
};

}  // namespace fantascope::vision
