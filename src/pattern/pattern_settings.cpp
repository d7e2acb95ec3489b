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

Result<Options> readSearch(const ConfigNode& node, Options options) {
    ConfigFields fields(node);
    OptionalFields optional{fields};
    declareSearch(optional, options);
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
    fields.optional().read("search", settings.search, [&](const ConfigNode& node) { return readSearch(node, settings.search); });
    fields.optional().read("shapes", settings.search, [&](const ConfigNode& node) { return readShapes(node, settings.search); });
    fields.optional().list("colours", settings.search.colours, readColours, 1);
    fields.optional().read("motion", settings.motion, readMotion);
    TRY(fields.finish());
    return settings;
}

}  // namespace fantascope::pattern
