#pragma once
// What the site file says of an output and of the camera that watches it, and where the camera sees
// the cells of the output's picture.

#include "vision/camera_light.h"
#include "vision/camera_model.h"

#include "core/warp.h"
#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <vector>

namespace fantascope::vision {

// The site file's data about one output and the camera that watches it: only what a technician
// measured and wrote down.
struct NominalView {
    CameraModel camera;
    CameraLight light = {};
    CameraModel projector;
    double canvasAspect = 16.0 / 9;  // width / height
    Warp warp = Warp::straight({1, 1});
    Plane surface;  // the surface of the picture
    // The light correction evens out the projector's fall-off too, so it is no reason to be darker.
    bool isEvenedOut = false;

    // The camera's pixel for a place of the canvas, 0..1 from the top left. Nothing if the camera
    // does not see the place.
    std::optional<glm::dvec2> pixelOf(glm::dvec2 canvas) const;
};

// A cell of the canvas as the camera sees it: some places of it in camera pixels, and how strongly
// the projector lights it there.
struct CanvasCell {
    int column = 0, row = 0;
    std::vector<glm::vec2> places;
    double gain = 0;
};

// All cells of `grid` that the camera sees completely, by rows; the strongest gain is 1. A cell has
// `places` places across and down.
std::vector<CanvasCell> cellsInSight(const NominalView& view, glm::ivec2 grid, int places);

// The linear light of a stored frame, bilinear between pixel centres.
glm::dvec3 linearAt(const CameraLight& light, const RgbaImage& frame, glm::vec2 pixel);
// The same for a cell: the mean of its places.
glm::dvec3 linearOf(const CameraLight& light, const RgbaImage& frame, const CanvasCell& cell);

}  // namespace fantascope::vision
