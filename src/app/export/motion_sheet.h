#pragma once

#include "theatre/deform/handle_motion.h"
#include "theatre/deform/triangulated_silhouette.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace fantascope::app {

// A silhouette at one moment of its motion. Pixels of the pictures that are written.
struct DeformedFrame {
    double time = 0;                   // seconds
    std::vector<glm::dvec2> vertices;  // of the triangles
    std::vector<glm::dvec2> places;    // of the handles
};

// The picture of one, white on black.
GreyImage pictureOf(const theatre::TriangulatedSilhouette& silhouette, const DeformedFrame& frame, glm::ivec2 size);
RgbaImage opaque(const GreyImage& picture);

// What a motion is checked by: the silhouette at rest with its triangles, then frames of the
// motion, all of them or so many as one can look at, each with its handles: those that move orange,
// those that are fixed blue.
RgbaImage motionSheet(const theatre::TriangulatedSilhouette& silhouette, const theatre::HandleMotion& motion,
                      const DeformedFrame& rest, std::span<const DeformedFrame> frames, glm::ivec2 size);

}  // namespace fantascope::app
