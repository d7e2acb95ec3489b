#include "theatre/energy/weights_file.h"

#include "core/config/config.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace fantascope::theatre {
namespace {

constexpr std::int64_t kVersion = 1;
constexpr double kMost = 1e6;

struct Weight {
    const char* name;
    double PoseWeights::*value;
};
constexpr std::array kWeights = {
    Weight{"w1", &PoseWeights::w1},   Weight{"w2", &PoseWeights::w2},   Weight{"w3", &PoseWeights::w3},
    Weight{"w4", &PoseWeights::w4},   Weight{"w5", &PoseWeights::w5},   Weight{"w6", &PoseWeights::w6},
    Weight{"w7", &PoseWeights::w7},   Weight{"w8", &PoseWeights::w8},   Weight{"w9", &PoseWeights::w9},
    Weight{"w10", &PoseWeights::w10}, Weight{"w11", &PoseWeights::w11}, Weight{"w12", &PoseWeights::w12},
    Weight{"w13", &PoseWeights::w13}, Weight{"w14", &PoseWeights::w14}, Weight{"w15", &PoseWeights::w15},
    Weight{"w16", &PoseWeights::w16}};

// `base`, overridden by the weights of the node.
Result<PoseWeights> changed(PoseWeights base, const ConfigNode& node) {
    ConfigFields fields(node);
    for (const Weight& weight : kWeights) fields.optional().number(weight.name, base.*weight.value, 0, kMost);
    TRY(fields.finish());
    return base;
}

}  // namespace

Result<PoseWeights> readWeights(const std::filesystem::path& file, std::string_view preset, const PoseWeights& base) {
    const ConfigNode root = TRY(ConfigNode::load(file));
    PoseWeights weights = base;
    std::vector<std::pair<std::string, ConfigNode>> presets;
    ConfigFields fields(root);
    fields.header("pose-weights", kVersion);
    fields.optional().read("common", weights, [&](const ConfigNode& node) { return changed(base, node); });
    fields.optional().read("presets", presets,
                           [](const ConfigNode& node) -> Result<std::vector<std::pair<std::string, ConfigNode>>> {
                               auto entries = TRY(node.entries());
                               // Presets that are not asked for must be valid, too.
                               for (const auto& [name, entry] : entries) TRY(changed({}, entry));
                               return entries;
                           });
    TRY(fields.finish());
    if (preset.empty()) return weights;
    std::vector<std::string> names;
    for (const auto& [name, entry] : presets) {
        if (name == preset) return changed(weights, entry);
        names.push_back(name);
    }
    const std::string nearest = nearestName(preset, names);
    return Error(fmt::format("{}: there is no preset '{}'{}; it has {}", file.string(), preset,
                             nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest),
                             names.empty() ? "none" : listed(names)));
}

}  // namespace fantascope::theatre
