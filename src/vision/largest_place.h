#pragma once

#include "vision/camera_model.h"
#include "vision/structured_light.h"

#include "core/geometry.h"
#include "core/warp.h"

#include <array>
#include <optional>
#include <vector>

namespace fantascope::vision {

// An output's part of a canvas, and what of the camera's picture it lights. `map` outlives it.
struct LitPart {
    CanvasPart part{};
    const ProjectorMap* map = nullptr;
};

// The largest upright place for a canvas of this aspect (width / height) that lies, part by part,
// in the light of its outputs: its corners in camera pixels, clockwise from the top left. Upright
// is what `uprightFromView` makes a rectangle: the map from directions in front of the camera
// (where its axis meets 1) to the surface; the identity for upright as the camera sees it.
// Nothing if no place is lit.
std::optional<std::array<glm::dvec2, 4>> largestPlace(const CameraModel& camera, const std::vector<LitPart>& parts, double aspect,
                                                      const Homography& uprightFromView);

// That map for a camera and a plane whose places are known: metres on the plane, right and down.
// The top of the picture is where the world is up; on a level plane, where it is away from the
// camera.
Homography uprightFromView(const CameraModel& camera, const Plane& surface);

}  // namespace fantascope::vision
