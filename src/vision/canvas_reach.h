#pragma once

#include "vision/camera_model.h"
#include "vision/structured_light.h"

#include "core/geometry.h"
#include "core/result.h"
#include "core/warp.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace fantascope::vision {

// An output's part of a canvas, and what of the camera's picture it lights. `map` outlives it.
struct LitPart {
    CanvasPart part{};
    const ProjectorMap* map = nullptr;
};

// A canvas that stands somewhere in a camera's picture. Its edges are straight as a lens without
// distortion sees them. Thread-safe to read.
class PlacedCanvas {
public:
    // `corners`: camera pixels, clockwise from the canvas's top left. Error: they are crossed or
    // folded.
    static Result<PlacedCanvas> of(const CameraModel& camera, const std::array<glm::dvec2, 4>& corners);

    // The camera pixel of a point of the unit canvas; nothing: no camera pixel sees it.
    std::optional<glm::dvec2> pixelFromCanvas(glm::dvec2 canvas) const;

private:
    PlacedCanvas(const CameraModel& lens, const Homography& viewFromCanvas) : lens_(lens), viewFromCanvas_(viewFromCanvas) {}

    CameraModel lens_;  // at the origin
    Homography viewFromCanvas_;
};

// Where outputs' light reaches in a camera's picture. Small holes count as lit; the outermost two
// or so pixels of the light do not, because a place would lose its edge there. Thread-safe to read.
class CanvasReach {
public:
    CanvasReach(const CameraModel& camera, const std::vector<LitPart>& parts);

    const CanvasPart& part(std::size_t index) const { return parts_[index].part; }
    std::size_t size() const { return parts_.size(); }  // how many parts
    // Whether the light of a part's output reaches a camera pixel.
    bool isLit(std::size_t part, glm::dvec2 pixel) const;
    // Camera pixels, two apart, that the light of a part's output reaches.
    std::vector<glm::dvec2> litPixels(std::size_t part) const;
    // A rectangle in the middle of what is lit, clockwise from the top left: camera pixels. It is
    // nobody's best place.
    std::array<glm::dvec2, 4> middle() const;
    // Whether each part's edge lies in the light of its output. What the edge encloses may have
    // holes, such as things before the wall. `pixelFromCanvas`: as in PlacedCanvas.
    bool covers(const std::function<std::optional<glm::dvec2>(glm::dvec2)>& pixelFromCanvas) const;
    // The parts whose edge does not.
    std::vector<std::size_t> uncovered(const PlacedCanvas& canvas) const;

private:
    struct Part {
        CanvasPart part;
        Image<std::uint8_t> lit;  // by cells of 2 x 2 camera pixels
    };
    bool coversPart(std::size_t part, const std::function<std::optional<glm::dvec2>(glm::dvec2)>& pixelFromCanvas) const;

    glm::ivec2 size_;  // of the camera's picture
    std::vector<Part> parts_;
};

}  // namespace fantascope::vision
