#pragma once

#include "vision/nominal_view.h"
#include "vision/structured_light.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <optional>

namespace fantascope::vision {

// The map that a calibration would find if everything stood as the site file says: of the full
// light it knows only the projector's own fall-off, 1 where that is strongest.
ProjectorMap nominalMap(const NominalView& view);

// Where the camera sees an output's light, by cells of the projector's picture. A cell is a square
// of projector pixels; it is about as large as a camera pixel. Value type; constant.
class OutputView {
public:
    // `map`: from camera pixels to projector pixels, as calibrated or nominal. `projector`: its
    // pixels. `gamma`: of the projector: light = stored ^ gamma. `step`: camera pixels that count
    // as one. Nothing: the camera sees too little of the output.
    static std::optional<OutputView> of(const ProjectorMap& map, glm::ivec2 projector, double gamma, int step);

    // Projector pixels along a cell's side.
    int cellSize() const { return cellSize_; }
    // By cell: where the camera sees it, in camera pixels; NaN: nowhere.
    const Image<glm::vec2>& camera() const { return camera_; }
    // By cell: the light that the camera gets of it at full light; 0: it is not seen.
    const GreyImage& full() const { return full_; }
    // By cell: the linear light of a frame that is sent to the projector, 0..1; the mean of the
    // channels. The frame has the projector's size.
    GreyImage lightOf(const RgbaImage& frame) const;

private:
    int cellSize_ = 1;
    glm::ivec2 projector_{0};
    Image<glm::vec2> camera_;
    GreyImage full_;
    std::array<float, 256> light_{};  // of a stored value, / 3
};

}  // namespace fantascope::vision
