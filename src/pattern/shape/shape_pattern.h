#pragma once

#include "pattern/shape/motion_settings.h"

#include "core/result.h"
#include "media/image.h"
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

// A mesh that is copied into instances. Its centroid is the origin, and its farthest vertex is at
// distance 1; x right, y up, z towards the viewer.
struct ElementalShape {
    std::string name;  // "triangle", or the file as the pattern file writes it: "sculpture.obj"
    TriangleMesh mesh;
    std::filesystem::path file = {};  // the mesh's file, absolute or relative to the working directory; empty: built in
};

// One copy of an elemental shape in the canvas plane.
struct ShapeInstance {
    // Stable for the life of the pattern, never given twice. The instance's random streams derive
    // from (seed, id, axis).
    std::uint32_t id = 0;
    std::uint32_t shape = 0;   // index into ShapePattern::shapes
    std::uint32_t group = 0;   // movement group, below ShapePattern::groups
    glm::dvec2 centre{0.0};    // canvas units: [0, aspect] x [0, 1], y down
    double size = 0;           // canvas heights: the radius of the sphere around the shape
    glm::dvec3 rotation{0.0};  // radians about x, y, z in the shape's frame, see rotationXyz()
    glm::vec3 colour{1.0f};    // linear light, 0..1
};

// The pose of an instance at one moment: its rest plus its movement.
struct InstancePose {
    glm::dvec2 centre{0.0};
    double size = 0;
    glm::dvec3 rotation{0.0};
};

// How a guide's stored values map to linear light.
enum class GuideTransfer { Srgb, Linear };
// As files and reports write it.
constexpr std::string_view name(GuideTransfer transfer) { return transfer == GuideTransfer::Srgb ? "srgb" : "linear"; }

// In which values pattern and guide are compared. Eye and camera add light from afar, so only a
// pattern that was compared in light reads as the drawing from there. Stored values are the
// paper's.
enum class CompareSpace { Light, Stored };
// As files and reports write it.
constexpr std::string_view name(CompareSpace space) { return space == CompareSpace::Light ? "light" : "stored"; }

// The guide's values as a pattern is compared with them: its stored values, or their linear light,
// 0..1.
GreyImage comparedGuide(GreyImage stored, GuideTransfer transfer, CompareSpace space);

// A shape pattern: everything needed to draw it at any time. Value type; thread-safe to read.
struct ShapePattern {
    std::filesystem::path guide;  // the drawing that it reads as, absolute or relative to the working directory
    GuideTransfer guideTransfer = GuideTransfer::Srgb;
    CompareSpace compare = CompareSpace::Stored;  // it was compared with its guide in this space
    int width = 0, height = 0;  // pixels of the comparison with the guide; the canvas's aspect is width / height
    std::uint64_t seed = 0;     // below 2^63 in files
    std::uint32_t groups = 1;
    std::vector<ElementalShape> shapes;
    std::vector<ShapeInstance> instances;
    MotionSettings motion;

    double aspect() const { return static_cast<double>(width) / height; }
    std::size_t triangleCount() const;  // of all instances
    double meanSize() const;            // of all instances, canvas heights; 0 without instances
};

// Rotation, size and the flip of y of an orthographic view: canvas point = centre + (m * v).xy, and
// (m * v).z grows towards the viewer.
glm::dmat3 canvasFromShape(const InstancePose& pose);

// Reads a *.pattern.yaml (docs/pattern-format.md), strictly. Its shape files and its guide lie in
// its folder or below it. The guide need not exist: a show plays without it. Error: names file,
// line, column, key.
Result<ShapePattern> readPattern(const std::filesystem::path& file);
// Writes to a temporary file and renames it. The same pattern gives the same bytes in any folder.
// Reading the file gives the same pattern, except for the last bit of some angles (files have
// degrees); a pattern that was read from a file is written exactly. Shape files and guide must lie
// in the file's folder or below it; the caller copies them there. Error: they do not, or
// readPattern() would refuse the file; then nothing is written.
Result<void> writePattern(const std::filesystem::path& file, const ShapePattern& pattern);

}  // namespace fantascope::pattern
