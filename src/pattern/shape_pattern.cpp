#include "pattern/shape_pattern.h"

#include "pattern/elemental_shape.h"
#include "pattern/motion_section.h"

#include "core/check.h"
#include "core/config.h"
#include "core/file.h"
#include "core/geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace fantascope::pattern {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 1;
constexpr int kLargestSide = 16384;                // pixels, as for pictures
constexpr int kMostInstances = 1'000'000;          // a file with more is a mistake, not a drawing
constexpr double kFarthest = 100;                  // canvas units: no centre is beyond
constexpr double kLargest = 10, kSmallest = 1e-6;  // canvas units: an instance's size

Result<ElementalShape> readShape(const ConfigNode& node) {
    const std::string name = TRY(node.text());
    const auto& builtIn = builtInShapeNames();
    if (std::find(builtIn.begin(), builtIn.end(), name) != builtIn.end()) return loadShape(name);
    auto shape = loadShape(TRY(node.path()));
    if (!shape) return node.error(shape.error().message());
    shape->name = name;
    return shape;
}

Result<ShapeInstance> readInstance(const ConfigNode& node, const ShapePattern& pattern) {
    ShapeInstance instance;
    glm::dvec3 colour(1.0);
    ConfigFields fields(node);
    fields.integer("id", instance.id, 0, std::numeric_limits<std::uint32_t>::max());
    fields.integer("shape", instance.shape, 0, static_cast<std::int64_t>(pattern.shapes.size()) - 1);
    fields.integer("group", instance.group, 0, std::int64_t{pattern.groups} - 1);
    fields.vector2("centre", instance.centre, -kFarthest, kFarthest, "canvas heights");
    fields.number("size", instance.size, kSmallest, kLargest, "canvas heights");
    fields.read("rotation", instance.rotation, [](const ConfigNode& angles) -> Result<glm::dvec3> {
        const glm::dvec3 degrees = TRY(angles.vector3(-360, 360, "degrees"));
        return glm::dvec3(radians(degrees.x), radians(degrees.y), radians(degrees.z));
    });
    fields.vector3("colour", colour, 0, 1);
    TRY(fields.finish());
    instance.colour = colour;
    return instance;
}

Result<glm::ivec2> readResolution(const ConfigNode& node) {
    const auto sides = TRY(node.items(2, 2));
    return glm::ivec2(TRY(sides[0].integer(1, kLargestSide)), TRY(sides[1].integer(1, kLargestSide)));
}

// `file` as the pattern in `folder` names it, with '/' between its parts.
Result<std::string> nameFrom(const fs::path& folder, const fs::path& file) {
    const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(fs::absolute(folder).lexically_normal());
    if (relative.empty() || *relative.begin() == "..")
        return Error(
            fmt::format("{}: does not lie beside the pattern, in {} or below; copy it there", file.string(), folder.string()));
    return relative.generic_string();
}

std::string instanceLine(const ShapeInstance& i) {
    return fmt::format(
        "  - {{id: {}, shape: {}, group: {}, centre: [{}, {}], size: {}, rotation: [{}, {}, {}], colour: [{}, {}, {}]}}\n", i.id,
        i.shape, i.group, shortest(i.centre.x), shortest(i.centre.y), shortest(i.size), shortestDegrees(i.rotation.x),
        shortestDegrees(i.rotation.y), shortestDegrees(i.rotation.z), i.colour.r, i.colour.g, i.colour.b);
}

}  // namespace

std::size_t ShapePattern::triangleCount() const {
    std::size_t count = 0;
    for (const ShapeInstance& instance : instances) count += shapes[instance.shape].mesh.triangles.size();
    return count;
}

glm::dmat3 canvasFromShape(const InstancePose& pose) {
    const double size = pose.size;
    return glm::dmat3(size, 0, 0, 0, -size, 0, 0, 0, size) * rotationXyz(pose.rotation);
}

Result<ShapePattern> readPattern(const fs::path& file) {
    ShapePattern pattern;
    glm::ivec2 resolution(0);
    ConfigFields fields(TRY(ConfigNode::load(file)));
    fields.header("pattern", kVersion);
    fields.path("guide", pattern.guide);
    fields.choice("guide_transfer", pattern.guideTransfer, {name(GuideTransfer::Srgb), name(GuideTransfer::Linear)});
    fields.read("resolution", resolution, readResolution);
    fields.integer("seed", pattern.seed, 0, std::numeric_limits<std::int64_t>::max());
    fields.integer("groups", pattern.groups, 1, kMostInstances);
    fields.list("shapes", pattern.shapes, readShape, 1);
    fields.read("motion", pattern.motion, readMotion);
    std::set<std::uint32_t> ids;
    fields.list(
        "instances", pattern.instances,
        [&](const ConfigNode& node) -> Result<ShapeInstance> {
            const ShapeInstance instance = TRY(readInstance(node, pattern));
            if (!ids.insert(instance.id).second) return node.error(fmt::format("id {} is given twice", instance.id));
            return instance;
        },
        0, kMostInstances);
    TRY(fields.finish());
    pattern.width = resolution.x;
    pattern.height = resolution.y;
    return pattern;
}

Result<void> writePattern(const fs::path& file, const ShapePattern& pattern) {
    const fs::path folder = fs::absolute(file).parent_path();
    std::string text = fmt::format("fantascope: pattern\nversion: {}\n", kVersion);
    text += fmt::format("guide: {}\n", fantascope::quoted(TRY(nameFrom(folder, pattern.guide))));
    text += fmt::format("guide_transfer: {}\n", name(pattern.guideTransfer));
    text +=
        fmt::format("resolution: [{}, {}]  # pixels in which it was compared with the guide\n", pattern.width, pattern.height);
    text += fmt::format("seed: {}\ngroups: {}\n", pattern.seed, pattern.groups);
    text += "shapes:\n";
    for (const ElementalShape& shape : pattern.shapes) text += fmt::format("  - {}\n", fantascope::quoted(shape.name));
    text += motionSection(pattern.motion);
    // Lengths in canvas heights, y down; rotation in degrees; colour in linear light.
    text += pattern.instances.empty() ? "instances: []\n" : "instances:\n";
    for (const ShapeInstance& instance : pattern.instances) text += instanceLine(instance);
    return writeFile(file, text);
}

}  // namespace fantascope::pattern
