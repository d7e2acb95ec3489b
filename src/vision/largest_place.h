#pragma once

#include "vision/camera_model.h"
#include "vision/canvas_reach.h"

#include "core/geometry.h"

#include <array>
#include <optional>
#include <vector>

namespace fantascope::vision {

// The largest upright place for a canvas of this aspect (width / height) where the light of each
// output covers its part. Returns the canvas's corners in camera pixels, clockwise from the top
// left; nothing if there is no such place. `uprightFromView`: from directions in the camera's frame
// (x / z, y / z) to coordinates in which an upright place is a rectangle along the axes. With the
// identity, places are upright in the camera's picture.
std::optional<std::array<glm::dvec2, 4>> largestPlace(const CameraModel& camera, const std::vector<LitPart>& parts, double aspect,
                                                      const Homography& uprightFromView);

// The same map for a camera and a plane whose places are known. Its coordinates are metres on the
// plane, right and down. Up is the world's up; on level ground it is away from the camera.
Homography uprightFromView(const CameraModel& camera, const Plane& surface);

}  // namespace fantascope::vision
