#include "pattern/shape/motion_file.h"
#include "pattern/shape/shape_fields.h"
#include "pattern/shape/shape_pattern.h"

#include "core/config/config.h"
#include "core/file.h"

#include <fmt/format.h>

#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <unordered_set>
#include <utility>

namespace fantascope::pattern {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kVersion = 1;
constexpr std::int64_t kMaxPixels = 16'384;  // per side; more than any projector has
// Far more than can be moved in real time; keeps a mistyped file from taking all memory.
constexpr std::int64_t kMaxInstances = 100'000;
constexpr double kMinSize = 1e-6, kMaxSize = 10;  // canvas heights

Result<glm::ivec2> readSize(const ConfigNode& node) {
    const auto sides = TRY(node.items(2, 2));
    return glm::ivec2(TRY(sides[0].integer(1, kMaxPixels)), TRY(sides[1].integer(1, kMaxPixels)));
}

Result<ElementalShape> readShape(const ConfigNode& node) {
    ShapeFields shape;
    ConfigFields fields(node);
    shape.declare(fields);
    TRY(fields.finish());
    return std::move(shape).chosen(node);
}

Result<ShapeInstance> readInstance(const ConfigNode& node, const ShapePattern& pattern) {
    ShapeInstance instance;
    ConfigFields fields(node);
    fields.integer("id", instance.id, 0, std::numeric_limits<std::uint32_t>::max());
    fields.integer("shape", instance.shape, 0, static_cast<std::int64_t>(pattern.shapes.size()) - 1);
    fields.integer("group", instance.group, 0, std::int64_t{pattern.groups} - 1);
    fields.read("centre", instance.centre, [&](const ConfigNode& at) -> Result<glm::dvec2> {
        const auto parts = TRY(at.items(2, 2));
        return glm::dvec2(TRY(parts[0].number(0, pattern.aspect(), "canvas heights")),
                          TRY(parts[1].number(0, 1, "canvas heights")));
    });
    fields.number("size", instance.size, kMinSize, kMaxSize, "canvas heights");
    fields.read("rotation", instance.rotation, [](const ConfigNode& at) -> Result<glm::dvec3> {
        return TRY(at.vector3(-360, 360, "degrees")) * std::numbers::pi / 180.0;
    });
    fields.read("colour", instance.colour,
                [](const ConfigNode& at) -> Result<glm::vec3> { return glm::vec3(TRY(at.vector3(0, 1))); });
    TRY(fields.finish());
    return instance;
}

Result<ShapePattern> patternOf(const ConfigNode& root) {
    ShapePattern pattern;
    glm::ivec2 size{};
    ConfigNode instances;
    ConfigFields fields(root);
    fields.header("pattern", kVersion);
    fields.path("guide", pattern.guide);
    fields.choice("guide_transfer", pattern.guideTransfer, {name(GuideTransfer::Srgb), name(GuideTransfer::Linear)});
    fields.optional().choice("compare", pattern.compare, {name(CompareSpace::Light), name(CompareSpace::Stored)});
    fields.read("size", size, readSize);
    fields.integer("seed", pattern.seed, 0, std::numeric_limits<std::int64_t>::max());
    fields.integer("groups", pattern.groups, 1, kMaxInstances);
    fields.list("shapes", pattern.shapes, readShape, 1);
    fields.optional().read("motion", pattern.motion, readMotion);
    fields.read("instances", instances, [](const ConfigNode& node) -> Result<ConfigNode> { return node; });
    TRY(fields.finish());
    pattern.width = size.x;
    pattern.height = size.y;

    // Instances are read last, since their bounds depend on shapes and groups, and keys may come in
    // any order.
    std::unordered_set<std::uint32_t> ids;
    for (const ConfigNode& node : TRY(instances.items(0, kMaxInstances))) {
        const ShapeInstance instance = TRY(readInstance(node, pattern));
        if (!ids.insert(instance.id).second)
            return node.error(fmt::format("id {} is given twice; every instance needs its own", instance.id));
        pattern.instances.push_back(instance);
    }
    return pattern;
}

std::string instanceText(const ShapeInstance& instance) {
    const auto& [id, shape, group, centre, size, rotation, colour] = instance;
    return fmt::format(
        "  - {{id: {}, shape: {}, group: {}, centre: [{}, {}], size: {}, rotation: [{}, {}, {}], colour: [{}, {}, {}]}}\n", id,
        shape, group, shortest(centre.x), shortest(centre.y), shortest(size), shortestDegrees(rotation.x),
        shortestDegrees(rotation.y), shortestDegrees(rotation.z), colour.r, colour.g,
        colour.b);  // fmt writes the shortest text that reads back as the same float
}

}  // namespace

Result<ShapePattern> readPattern(const fs::path& file) { return patternOf(TRY(ConfigNode::load(file))); }

Result<void> writePattern(const fs::path& file, const ShapePattern& pattern) {
    std::string text = fmt::format("fantascope: pattern\nversion: {}\nguide: {}\n", kVersion,
                                   fantascope::quoted(TRY(relativeTo(file, pattern.guide))));
    const auto add = [&]<class... Values>(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    };
    add("guide_transfer: {}\ncompare: {}\n", name(pattern.guideTransfer), name(pattern.compare));
    add("size: [{}, {}]\nseed: {}\ngroups: {}\nshapes:\n", pattern.width, pattern.height, pattern.seed, pattern.groups);
    for (const ElementalShape& shape : pattern.shapes) {
        if (shape.file.empty())
            add("  - builtin: {}\n", fantascope::quoted(shape.name));
        else
            add("  - file: {}\n", fantascope::quoted(TRY(relativeTo(file, shape.file))));
    }
    text += motionText(pattern.motion);
    text += pattern.instances.empty() ? "instances: []\n" : "instances:\n";
    for (const ShapeInstance& instance : pattern.instances) text += instanceText(instance);

    // A text that cannot be read back must not replace a good file.
    if (const auto readable = patternOf(TRY(ConfigNode::parse(text, file))); !readable)
        return readable.error().in("not written, as it could not be read again");
    return writeFile(file, text);
}

}  // namespace fantascope::pattern
