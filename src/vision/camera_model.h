#pragma once
// The map between the world and a camera's picture. A projector is a camera run backwards: the same
// model without distortion. Pixels as in media/image.h: the picture is [0, width] x [0, height],
// the centre of pixel (0, 0) at (0.5, 0.5).

#include "core/geometry.h"
#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <optional>

namespace fantascope::vision {

struct Ray {
    glm::dvec3 origin{0.0};          // metres
    glm::dvec3 direction{0, 0, -1};  // unit
};

// An infinite plane; `normal` is unit.
struct Plane {
    glm::dvec3 point{0.0};
    glm::dvec3 normal{0, 0, 1};

    // Where a ray hits the plane's front; nothing if it runs along or away from the plane, or comes
    // from behind.
    std::optional<glm::dvec3> hitBy(const Ray& ray) const;
};

// A pinhole camera with radial distortion (Brown 1966, first two terms). Value type; thread-safe to
// read.
struct CameraModel {
    Pose pose;
    glm::ivec2 size{640, 360};    // pixels
    double focal = 500;           // pixels, the same across and down
    glm::dvec2 centre{320, 180};  // where the axis meets the picture, in pixels
    double k1 = 0, k2 = 0;        // a point at r focal lengths from the axis appears at r (1 + k1 r^2 + k2 r^4)

    // A camera with `fieldOfView` radians across the picture's middle row, without distortion and
    // with its axis in the picture's middle. 0 < fieldOfView < pi. `centre`: where the axis meets
    // the picture, pixels; nothing: in its middle.
    // Error: the distortion folds the picture over inside its corners, so that one pixel would see
    // two directions.
    static Result<CameraModel> fromFieldOfView(const Pose& pose, glm::ivec2 size, double fieldOfView, double k1 = 0,
                                               double k2 = 0, std::optional<glm::dvec2> centre = {});
    // The field of view that fromFieldOfView() was given, radians.
    double fieldOfView() const;
    // A projector: throwRatio = distance / picture width, > 0; the lens shift moves the picture
    // right and up, in picture widths and heights.
    static CameraModel fromThrowRatio(const Pose& pose, glm::ivec2 size, double throwRatio, glm::dvec2 lensShift);

    // The pixel of a point in the world; it may lie outside the picture. Nothing if it is behind
    // the camera or beyond the fold of its distortion.
    std::optional<glm::dvec2> pixelFromWorld(glm::dvec3 point) const;
    // Its pixels per square metre of a surface, without distortion; `normal` is unit. 0 or less:
    // the surface faces away. A projector whose pixels all give the same light makes an illuminance
    // proportional to this.
    double pixelsPerArea(glm::dvec3 point, glm::dvec3 normal) const;
    // Whether a pixel position lies in the picture.
    bool inPicture(glm::dvec2 pixel) const;
    // The ray of a pixel position in the picture. Exact to 1e-12 focal lengths.
    Ray rayThrough(glm::dvec2 pixel) const;
};

// The four projector pixels, clockwise from the canvas's top left, that put the canvas on a flat
// quadrilateral in the world (corners in the same order, metres): the keystone correction computed
// from drawings. Error: a corner outside the projector's picture.
Result<std::array<glm::dvec2, 4>> rectifyingCorners(const CameraModel& projector, const std::array<glm::dvec3, 4>& corners);

}  // namespace fantascope::vision
