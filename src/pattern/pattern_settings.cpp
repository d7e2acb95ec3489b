#include "pattern/pattern_settings.h"

#include "pattern/motion_file.h"
#include "pattern/search_bounds.h"

#include "core/config.h"

namespace fantascope::pattern {
namespace {

using Options = PatternSearch::Options;

constexpr int kVersion = 1;

// Fields of which each may be absent.
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

// What no single key can break: the order of the thresholds and of the sizes.
Result<Options> checked(const ConfigNode& node, const Options& options) {
    if (const auto good = options.check(); !good) return node.error(good.error().message());
    return options;
}

// One section: the numbers that `declare` declares of it.
template <class Declare>
Result<Options> readSection(const ConfigNode& node, Options options, Declare declare) {
    ConfigFields fields(node);
    OptionalFields optional{fields};
    declare(optional, options);
    TRY(fields.finish());
    return checked(node, options);
}

Result<Options> readShapes(const ConfigNode& node, Options options) {
    ConfigFields fields(node);
    OptionalFields optional{fields};
    declareShapes(optional, options);
    glm::dvec2 size(0.0);
    fields.optional().vector2("size", size, 1e-6, 2, "canvas heights");
    TRY(fields.finish());
    if (size != glm::dvec2(0.0)) options.size = size;
    return checked(node, options);
}

Result<Options::Colours> readColours(const ConfigNode& node) {
    Options::Colours colours;
    ConfigFields fields(node);
    fields.vector3("from", colours.from, 0, 1);
    colours.to = colours.from;
    fields.optional().vector3("to", colours.to, 0, 1);
    TRY(fields.finish());
    return colours;
}

}  // namespace

Result<PatternSettings> readPatternSettings(const std::filesystem::path& file) {
    PatternSettings settings;
    ConfigFields fields(TRY(ConfigNode::load(file)));
    fields.header("pattern-settings", kVersion);
    fields.optional().choice("guide_transfer", settings.guideTransfer, {name(GuideTransfer::Srgb), name(GuideTransfer::Linear)});
    const auto section = [&](const char* name, auto declare) {
        fields.optional().read(name, settings.search,
                               [&](const ConfigNode& node) { return readSection(node, settings.search, declare); });
    };
    section("search", [](auto& optional, Options& options) { declareSearch(optional, options); });
    section("refined", [](auto& optional, Options& options) { declareRefined(optional, options.refined); });
    section("paper", [](auto& optional, Options& options) { declarePaper(optional, options.paper); });
    fields.optional().read("shapes", settings.search, [&](const ConfigNode& node) { return readShapes(node, settings.search); });
    fields.optional().list("colours", settings.search.colours, readColours, 1);
    fields.optional().read("motion", settings.motion, [&](const ConfigNode& node) -> Result<MotionSettings> {
        const MotionSettings motion = TRY(readMotion(node));
        settings.fitMotion = !TRY(namesAmplitude(node));
        return motion;
    });
    TRY(fields.finish());
    return settings;
}

}  // namespace fantascope::pattern
