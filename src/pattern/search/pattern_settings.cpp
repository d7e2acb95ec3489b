#include "pattern/search/pattern_settings.h"

#include "pattern/search/search_bounds.h"
#include "pattern/shape/motion_file.h"
#include "pattern/shape/shape_fields.h"

#include "core/config/config.h"
#include "media/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

namespace fantascope::pattern {
namespace {

using Options = PatternSearch::Options;

constexpr int kVersion = 1;

// Fields for declareSearch() etc. in which every key is optional.
struct OptionalFields {
    ConfigFields& fields;

    template <class... Rest>
    void number(Rest&&... rest) {
        fields.optional().number(std::forward<Rest>(rest)...);
    }
    template <class... Rest>
    void integer(Rest&&... rest) {
        fields.optional().integer(std::forward<Rest>(rest)...);
    }
    template <class... Rest>
    void angle(Rest&&... rest) {
        fields.optional().angle(std::forward<Rest>(rest)...);
    }
};

// Checks the rules between keys: the order of thresholds and of sizes.
Result<Options> checked(const ConfigNode& node, const Options& options) {
    if (const auto good = options.check(); !good) return node.error(good.error().message());
    return options;
}

// Reads one section, whose numbers `declare` declares.
template <class Declare>
Result<Options> readSection(const ConfigNode& node, Options options, Declare declare) {
    ConfigFields fields(node);
    OptionalFields optional{fields};
    declare(optional, options);
    TRY(fields.finish());
    return checked(node, options);
}

// A picture to choose colours from. It is shrunk, since pixels much smaller than an instance make
// no difference.
Result<std::shared_ptr<const RgbaImage>> readColourPicture(const ConfigNode& node) {
    constexpr int kLongestSide = 1024;
    auto picture = readRgba(TRY(node.path()));
    if (!picture) return node.error(picture.error().message());
    const double shrink = std::min(1.0, double(kLongestSide) / std::max(picture->width(), picture->height()));
    const auto shrunk = [&](int side) { return std::max(1, static_cast<int>(std::lround(side * shrink))); };
    return std::shared_ptr<const RgbaImage>(
        std::make_shared<RgbaImage>(resized(*picture, shrunk(picture->width()), shrunk(picture->height()))));
}

Result<Options::Colours> readColours(const ConfigNode& node) {
    Options::Colours colours;
    std::optional<glm::dvec3> from, to;
    const auto readColour = [](const ConfigNode& at) -> Result<std::optional<glm::dvec3>> {
        return std::optional(TRY(at.vector3(0, 1)));
    };
    ConfigFields fields(node);
    fields.optional().read("from", from, readColour);
    fields.optional().read("to", to, readColour);
    fields.optional().read("picture", colours.picture, readColourPicture);
    TRY(fields.finish());
    if (!from && !colours.picture) return node.error("'from' or 'picture' is missing");
    if (colours.picture && (from || to))
        return node.error("'picture' excludes 'from' and 'to'; put them into an entry of their own");
    if (from) colours.from = *from;
    colours.to = to.value_or(colours.from);
    return colours;
}

// checked() checks their order.
Result<std::optional<glm::dvec2>> readSize(const ConfigNode& node) {
    return std::optional(TRY(node.vector2(1e-6, 2, "canvas heights")));
}

// One angle, +-, or a pair [from, to]; the result is in radians.
Result<std::optional<glm::dvec2>> readRotation(const ConfigNode& node, double max) {
    if (!node.isList()) {
        const double angle = radians(TRY(node.number(0, std::min(max, 180.0), "degrees")));
        return std::optional(glm::dvec2(-angle, angle));
    }
    const glm::dvec2 degrees = TRY(node.vector2(-max, max, "degrees"));
    return std::optional(glm::dvec2(radians(degrees.x), radians(degrees.y)));
}

Result<ShapeSettings> readShape(const ConfigNode& node) {
    ShapeFields named;
    Options::Shape own;
    ConfigFields fields(node);
    OptionalFields optional{fields};
    named.declare(fields);
    declareShape(optional, own);
    fields.optional().read("size", own.size, readSize);
    fields.optional().read("tilt", own.tilt, [](const ConfigNode& at) { return readRotation(at, kMaxTilt); });
    fields.optional().read("turn", own.turn, [](const ConfigNode& at) { return readRotation(at, kMaxTurn); });
    fields.optional().list("colours", own.colours, readColours, 1);
    TRY(fields.finish());
    Options alone;
    alone.shapes = {own};
    TRY(checked(node, alone));
    ElementalShape shape = TRY(std::move(named).chosen(node));
    return ShapeSettings{std::move(shape), std::move(own)};
}

// Built-in shapes are compared by name, others by file.
bool areSame(const ElementalShape& a, const ElementalShape& b) {
    if (a.file.empty() || b.file.empty()) return a.file.empty() && b.file.empty() && a.name == b.name;
    std::error_code different;
    return std::filesystem::equivalent(a.file, b.file, different);
}

Result<std::vector<ShapeSettings>> readEach(const ConfigNode& node) {
    std::vector<ShapeSettings> shapes;
    for (const ConfigNode& item : TRY(node.items(1))) {
        ShapeSettings read = TRY(readShape(item));
        for (const ShapeSettings& other : shapes)
            if (areSame(other.shape, read.shape)) return item.error(fmt::format("{} is given twice", read.shape.name));
        shapes.push_back(std::move(read));
    }
    return shapes;
}

Result<PatternSettings> readShapes(const ConfigNode& node, PatternSettings settings) {
    Options& options = settings.search;
    ConfigFields fields(node);
    OptionalFields optional{fields};
    declareShapes(optional, options);
    fields.optional().read("size", options.size, readSize);
    fields.optional().read("each", settings.shapes, readEach);
    TRY(fields.finish());
    TRY(checked(node, options));
    return settings;
}

Result<PatternSettings> readSearch(const ConfigNode& node, PatternSettings settings) {
    ConfigFields fields(node);
    OptionalFields optional{fields};
    declareSearch(optional, settings.search);
    fields.optional().read("seconds", settings.seconds, [](const ConfigNode& at) -> Result<std::optional<double>> {
        return std::optional(TRY(at.number(0.001, 1e6, "seconds")));
    });
    TRY(fields.finish());
    return settings;
}

}  // namespace

Result<PatternSettings> readPatternSettings(const std::filesystem::path& file) {
    PatternSettings settings;
    ConfigFields fields(TRY(ConfigNode::load(file)));
    fields.header("pattern-settings", kVersion);
    fields.optional().choice("guide_transfer", settings.guideTransfer, {name(GuideTransfer::Srgb), name(GuideTransfer::Linear)});
    fields.optional().read("compare", settings.compare, [](const ConfigNode& at) -> Result<std::optional<CompareSpace>> {
        return std::optional(static_cast<CompareSpace>(TRY(at.choice({name(CompareSpace::Light), name(CompareSpace::Stored)}))));
    });
    const auto section = [&](const char* name, auto declare) {
        fields.optional().read(name, settings.search,
                               [&](const ConfigNode& node) { return readSection(node, settings.search, declare); });
    };
    fields.optional().read("search", settings, [&](const ConfigNode& node) { return readSearch(node, settings); });
    section("refined", [](auto& optional, Options& options) { declareRefined(optional, options.refined); });
    section("paper", [](auto& optional, Options& options) { declarePaper(optional, options.paper); });
    fields.optional().read("shapes", settings, [&](const ConfigNode& node) { return readShapes(node, settings); });
    fields.optional().list("colours", settings.search.colours, readColours, 1);
    fields.optional().read("motion", settings.motion, [&](const ConfigNode& node) -> Result<MotionSettings> {
        const MotionSettings motion = TRY(readMotion(node));
        settings.fitMotion = !TRY(setsAmplitude(node));
        return motion;
    });
    TRY(fields.finish());
    return settings;
}

Options::Shape PatternSettings::ownOf(const ElementalShape& shape) const {
    for (const ShapeSettings& named : shapes)
        if (areSame(named.shape, shape)) return named.own;
    return {};
}

}  // namespace fantascope::pattern
