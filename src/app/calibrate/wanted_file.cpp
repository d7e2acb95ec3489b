#include "app/calibrate/wanted_file.h"

#include "core/config/config.h"
#include "core/geometry.h"

#include <optional>

namespace fantascope::app {
namespace {

constexpr int kVersion = 1;
constexpr double kMaxPixel = 32768;

Result<std::array<glm::dvec2, 4>> readCorners(const ConfigNode& node) {
    const auto items = TRY(node.items());
    if (items.size() != 4) return node.error("four corners are needed, clockwise from the canvas's top left: [[x, y], ...]");
    std::array<glm::dvec2, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = TRY(items[i].vector2(-kMaxPixel, kMaxPixel, "px"));
    if (const auto why = whyNotConvex(corners)) return node.error(*why);
    return corners;
}

Result<std::array<glm::dvec2, 4>> readOutput(const ConfigNode& node) {
    std::array<glm::dvec2, 4> corners;
    ConfigFields fields(node);
    fields.read("camera", corners, readCorners);
    TRY(fields.finish());
    return corners;
}

}  // namespace

Result<WantedCorners> readWanted(const std::filesystem::path& file) {
    WantedCorners wanted;
    ConfigFields fields(TRY(ConfigNode::load(file)));
    fields.header("wanted", kVersion);
    fields.read("outputs", wanted, [](const ConfigNode& node) -> Result<WantedCorners> {
        WantedCorners read;
        for (const auto& [name, value] : TRY(node.entries())) read[name] = TRY(readOutput(value));
        return read;
    });
    TRY(fields.finish());
    return wanted;
}

}  // namespace fantascope::app
