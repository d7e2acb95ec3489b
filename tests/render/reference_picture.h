#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/warp.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <optional>
#include <span>
#include <vector>

namespace fantascope::render {

// The points of the canvas at a projector's pixels: exact at the pixels' corners, interpolated
// linearly in between.
class CanvasUnderPixels {
public:
    CanvasUnderPixels(const Warp& warp, glm::ivec2 size);
    // Nothing outside the canvas's shown part. `pixel`: in [0, width] x [0, height].
    std::optional<glm::dvec2> at(glm::dvec2 pixel) const;

private:
    CanvasPart part_;
    glm::ivec2 size_;
    std::vector<std::optional<glm::dvec2>> corners_;  // (size.x + 1) x (size.y + 1)
};

// The picture that the renderer should draw of a pattern in the given poses, computed point by
// point from the definitions alone: each pixel is the mean light of samples x samples points; each
// point is mapped back to the canvas, where the last instance that covers it shows its nearest
// facet. Slow, and independent of OpenGL, clip space matrices, depth buffers and FacetMesh.
RgbaImage referencePicture(const pattern::ShapePattern& pattern, std::span<const pattern::InstancePose> poses, const Warp& warp,
                           glm::ivec2 size, int samples);

}  // namespace fantascope::render
