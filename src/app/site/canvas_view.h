#pragma once

#include "drivers/site/scene.h"

#include "vision/camera_model.h"

#include "core/warp.h"

#include <glm/vec2.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// One output's canvas as the scene in the projector's light.
struct CanvasView {
    std::string name;  // the output's
    vision::CameraModel projector;
    std::optional<vision::Plane> surface;  // what the output is meant for
    Warp warp;
    const std::vector<site::SceneObject>& objects;

    // Metres across and down the canvas on the surface, each the mean of two sides; nothing where
    // no surface is declared, or it is not reached.
    std::optional<glm::dvec2> sizeOnSurface() const;
};

}  // namespace fantascope::app
