#pragma once

#include "media/image.h"
#include "media/mesh.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <functional>
#include <optional>
#include <span>

namespace fantascope::plot {

// A pinhole camera in a world with y up, metres. The picture's top is towards +y, so the camera
// must not look straight up or down.
struct Camera {
    glm::dvec3 position{0, 1.6, 10}, lookAt{0, 1, 0};
    double fieldOfView = 0.6;  // vertical, radians; 0 .. pi

    // Where a point lies in a picture, pixels; nothing if it is not in front of the camera.
    std::optional<glm::dvec2> pixelAt(const glm::dvec3& point, int width, int height) const;
    // The nearest camera with the view direction `direction` whose picture contains all points.
    // `margin`: share of the picture's size.
    static Camera fitting(std::span<const glm::dvec3> points, const glm::dvec3& direction, double fieldOfView, double aspect,
                          double margin);
};

// Triangles, visible from both sides. `shade` gives the light from a place on them, linear RGB,
// 0..1, and the opacity. Its normal faces the camera, and is smoothed between triangles that share
// a vertex and meet at less than some 50 degrees.
struct Surface {
    TriangleMesh mesh;
    std::function<glm::vec4(const glm::vec3& place, const glm::vec3& normal)> shade;
    bool translucent = false;  // blended over everything behind it, in the surfaces' order; hides nothing
};

// Renders surfaces before a background (linear RGB), with a z-buffer and 3 x 3 samples per pixel.
// The same input gives the same bytes. Thread: reentrant.
RgbaImage rendered(std::span<const Surface> surfaces, const Camera& camera, const glm::vec3& background, int width, int height);

}  // namespace fantascope::plot
