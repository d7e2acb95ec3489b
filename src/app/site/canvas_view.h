#pragma once

#include "drivers/site/scene.h"

#include "vision/camera_model.h"

#include "core/warp.h"

#include <glm/vec2.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// What one output's canvas meets in the scene, through its projector.
struct CanvasView {
    std::string name;  // the output's
    vision::CameraModel projector;
    std::optional<vision::Plane> surface;  // where the output's picture is to fall
    Warp warp;
    const std::vector<site::SceneObject>& objects;

    // Width and height of the canvas on the surface in metres, each the mean of two sides. Nothing
    // if no surface is declared, or the light misses it.
    std::optional<glm::dvec2> sizeOnSurface() const;
};

}  // namespace fantascope::app
