#pragma once

#include "pattern/shape_pattern.h"

#include "core/geometry.h"
#include "core/image.h"

#include <glm/vec2.hpp>

#include <span>

namespace fantascope::render {

// The picture that the renderer should draw of a pattern in the given poses, worked out point by point from the definitions
// alone: each pixel is the mean light of samples x samples points, each point is carried back to the canvas, and there the last
// instance that covers it shows its nearest facet. Slow and independent of OpenGL, matrices for clip space, depth buffers and
// meshes for facets.
RgbaImage referencePicture(const pattern::ShapePattern& pattern, std::span<const pattern::InstancePose> poses,
                           const Homography& projectorFromCanvas, glm::ivec2 size, int samples);

}  // namespace fantascope::render
