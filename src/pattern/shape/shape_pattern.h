#pragma once

#include "pattern/shape/motion_settings.h"

#include "core/result.h"
#include "media/mesh.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::pattern {

// A mesh to be copied into instances. Its geometric centre is the origin and its farthest vertex at
// distance 1; x right, y up, z to the viewer.
struct ElementalShape {
    std::string name;  // "triangle", or the file as the pattern names it: "sculpture.obj"
    TriangleMesh mesh;
    std::filesystem::path file = {};  // that the mesh came from, absolute or relative to the working directory; empty: built in
};

// One copy of an elemental shape in the picture plane.
struct ShapeInstance {
    std::uint32_t id =
        0;  // stable for the life of the pattern, never given twice; its random streams derive from (seed, id, axis)
    std::uint32_t shape = 0;   // index into ShapePattern::shapes
    std::uint32_t group = 0;   // its movement group, below ShapePattern::groups
    glm::dvec2 centre{0.0};    // canvas units: [0, aspect] x [0, 1], y down
    double size = 0;           // canvas units: the radius of the sphere around the shape
    glm::dvec3 rotation{0.0};  // radians about x, y, z in the shape's frame, see rotationXyz
    glm::vec3 colour{1.0f};    // linear light, 0..1
};

// Where an instance is at one moment: its rest values plus its movement.
struct InstancePose {
    glm::dvec2 centre{0.0};
    double size = 0;
    glm::dvec3 rotation{0.0};
};

// How a guide's stored values become linear light.
enum class GuideTransfer { Srgb, Linear };
constexpr std::string_view name(GuideTransfer transfer) {
    return transfer == GuideTransfer::Srgb ? "srgb" : "linear";
}  // in files and reports

// A shape pattern: everything that is needed to draw it at any time. Value type; thread-safe to
// read.
struct ShapePattern {
    std::filesystem::path guide;  // the drawing it reads as, absolute or relative to the working directory; for comparisons
    GuideTransfer guideTransfer = GuideTransfer::Srgb;
    int width = 0, height = 0;  // pixels in which it was compared with the guide; the canvas's aspect is width / height
    std::uint64_t seed = 0;     // below 2^63 in files
    std::uint32_t groups = 1;
    std::vector<ElementalShape> shapes;
    std::vector<ShapeInstance> instances;
    MotionSettings motion;

    double aspect() const { return static_cast<double>(width) / height; }
    std::size_t triangleCount() const;  // of all instances
    double meanSize() const;            // of all instances, canvas heights; 0 without any
};

// Rotation, size and the turned-over y of an orthographic view: canvas point = centre + (m * v).xy,
// and (m * v).z grows towards the viewer.
glm::dmat3 canvasFromShape(const InstancePose& pose);

// *.pattern.yaml (docs/pattern-format.md), strict; its shape files and its guide stand in the same
// folder or below it. The guide is not looked for: a show plays without. Error: names file, line,
// column, key.
Result<ShapePattern> readPattern(const std::filesystem::path& file);
// Written aside and renamed; the same pattern gives the same bytes, whatever the folder. Reading it
// gives the same pattern, but for the last bit of some angles (files have degrees); a pattern that
// was read comes back exactly. Shapes and guide must lie in the file's folder or below it (copied
// there by the caller). Error: they do not, or readPattern would refuse the file; then nothing is
// written.
Result<void> writePattern(const std::filesystem::path& file, const ShapePattern& pattern);

}  // namespace fantascope::pattern
