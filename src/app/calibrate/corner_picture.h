#pragma once

#include "vision/camera_model.h"
#include "vision/canvas_reach.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::app {

// A canvas whose wanted place a person is to choose, and what the person has to know for that.
struct OpenPlace {
    std::string canvas;
    std::vector<std::string> outputs;     // that were measured, by part of `reach`
    vision::CameraModel camera;           // its place in the world does not matter
    GreyImage picture;                    // of the camera: the wall in the outputs' light, stored values
    vision::CanvasReach reach;            // of the outputs' light
    std::array<glm::dvec2, 4> corners{};  // that the program would take: camera pixels, clockwise from the top left
};

// What a person has chosen so far.
struct CornerView {
    std::string title;
    std::vector<glm::dvec2> corners;  // camera pixels, clockwise from the canvas's top left; 4 at most
    std::size_t chosen = 0;           // of `corners`
    std::string message;              // one line
    bool isRefusal = false;           // the message says why the place was not taken
};

// Draws the choice of a place: the camera's picture, where the outputs' light reaches, the canvas,
// a magnifier at the chosen corner, and what can be done. Dim, for eyes that are used to the dark.
// Thread: thread-bound.
class CornerPicture {
public:
    static constexpr glm::ivec2 kSize{1280, 720};
    static constexpr std::array<std::string_view, 4> kCorners = {"top left", "top right", "bottom right", "bottom left"};

    // The place outlives it.
    explicit CornerPicture(const OpenPlace& place);

    // From pixels of this picture to camera pixels, and back.
    glm::dvec2 cameraFromPicture(glm::dvec2 at) const { return (at - corner_) / scale_; }
    glm::dvec2 pictureFromCamera(glm::dvec2 pixel) const { return corner_ + pixel * scale_; }
    double scale() const { return scale_; }  // pixels of this picture for one of the camera
    RgbaImage drawn(const CornerView& view) const;

private:
    const OpenPlace& place_;
    double scale_;
    glm::dvec2 corner_;  // of the camera's picture
    GreyImage wall_;     // the camera's picture at this scale, with what no output lights hatched
};

}  // namespace fantascope::app
