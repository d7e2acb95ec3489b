#pragma once

#include "theatre/deform/handle_motion.h"
#include "theatre/deform/triangulated_silhouette.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace fantascope::app {

// A silhouette at one moment of its motion. Places are in pixels of the written pictures.
struct DeformedFrame {
    double time = 0;                   // seconds
    std::vector<glm::dvec2> vertices;  // of the triangles
    std::vector<glm::dvec2> places;    // of the handles
};

// The frame's picture, white on black.
GreyImage pictureOf(const theatre::TriangulatedSilhouette& silhouette, const DeformedFrame& frame, glm::ivec2 size);
RgbaImage opaque(const GreyImage& picture);

// A contact sheet for checking a motion: the silhouette at rest with its triangles, then frames of
// the motion, all of them or a selection of reasonable size. Handles that move are orange, fixed
// ones blue.
RgbaImage motionSheet(const theatre::TriangulatedSilhouette& silhouette, const theatre::HandleMotion& motion,
                      const DeformedFrame& rest, std::span<const DeformedFrame> frames, glm::ivec2 size);

}  // namespace fantascope::app
