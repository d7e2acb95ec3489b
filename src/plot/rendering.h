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

// A pinhole camera in a y-up world, metres; the picture's top is towards +y. It looks neither
// straight up nor straight down.
struct Camera {
    glm::dvec3 position{0, 1.6, 10}, lookAt{0, 1, 0};
    double fieldOfView = 0.6;  // of the picture's height, radians; 0 .. pi

    // Where a point falls in a picture, pixels; none of what is not before the camera.
    std::optional<glm::dvec2> pixelAt(const glm::dvec3& point, int width, int height) const;
    // The camera that looks along `direction` from as near as all points fit into the picture, with
    // a margin: a share of its size.
    static Camera fitting(std::span<const glm::dvec3> points, const glm::dvec3& direction, double fieldOfView, double aspect,
                          double margin);
};

// Triangles, seen from both sides, and what light comes from a place on them: linear RGB, 0..1, and
// opacity. The normal is turned to the camera, and smooth where triangles that share a vertex meet
// at less than some 50 degrees.
struct Surface {
    TriangleMesh mesh;
    std::function<glm::vec4(const glm::vec3& place, const glm::vec3& normal)> shade;
    bool translucent = false;  // blended over what is behind it, in the surfaces' order, and hides nothing
};

// The surfaces before a background (linear RGB), the nearest in front, by a z-buffer with 3 x 3
// samples a pixel. The same input gives the same bytes. Thread: reentrant.
RgbaImage rendered(std::span<const Surface> surfaces, const Camera& camera, const glm::vec3& background, int width, int height);

}  // namespace fantascope::plot
