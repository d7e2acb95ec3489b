#include "show/site/projection_changes.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace fantascope::show {
namespace {

constexpr std::string_view kFlipNames[] = {"none", "horizontal", "vertical"};

ConfigValue valueOf(const Mask& mask) {
    if (mask.polygon.empty()) return ConfigValue::Map{{"image", mask.imageFile}};
    ConfigValue::Map map{{"polygon", mask.polygon}};
    if (mask.hidesOutside) map.emplace_back("hides", "outside");
    if (mask.feather > 0) map.emplace_back("feather", mask.feather);
    return map;
}

// Calls set(differs, path, value) for each step that turns the list of masks `then` into `now`.
// Different masks are written at their places; surplus ones are erased behind those, from the end.
template <class Set>
void maskChanges(const std::vector<Mask>& then, const std::vector<Mask>& now, const Set& set) {
    if (now.empty()) return set(!then.empty(), {"masks"}, std::nullopt);
    std::size_t behind = 0;  // equal masks at the end: they move up unchanged, with their comments in the file
    while (now.size() < then.size() && behind < now.size() && now[now.size() - 1 - behind] == then[then.size() - 1 - behind])
        ++behind;
    const std::size_t written = now.size() - behind;
    for (std::size_t i = 0; i < written; ++i) {
        if (i >= then.size() || then[i].polygon.empty() || now[i].polygon.empty()) {
            set(i >= then.size() || now[i] != then[i], {"masks", i}, valueOf(now[i]));
            continue;
        }
        set(now[i].polygon != then[i].polygon, {"masks", i, "polygon"}, now[i].polygon);
        set(now[i].hidesOutside != then[i].hidesOutside, {"masks", i, "hides"}, now[i].hidesOutside ? "outside" : "inside");
        set(now[i].feather != then[i].feather, {"masks", i, "feather"}, now[i].feather);
    }
    for (std::size_t i = written + then.size() - std::min(then.size(), now.size()); i-- > written;)
        set(true, {"masks", i}, std::nullopt);
}

}  // namespace

std::vector<SiteChange> projectionChanges(const Projection& then, const Projection& now, std::size_t output) {
    std::vector<SiteChange> changes;
    const WarpShape &warp = now.warp.shape(), &before = then.warp.shape();
    const auto set = [&](bool differs, ConfigPath path, std::optional<ConfigValue> value) {
        if (!differs) return;
        path.insert(path.begin(), {"outputs", output});
        changes.push_back({std::move(path), std::move(value)});
    };
    set(warp.part != before.part, {"part"},
        std::vector<double>{warp.part.low.x, warp.part.low.y, warp.part.high.x, warp.part.high.y});
    set(warp.orientation.flip != before.orientation.flip, {"flip"},
        std::string(kFlipNames[static_cast<std::size_t>(warp.orientation.flip)]));
    set(warp.orientation.quarterTurns != before.orientation.quarterTurns, {"turn"}, 90.0 * warp.orientation.quarterTurns);
    set(warp.corners != before.corners, {"corners"}, warp.corners);
    if (warp.mesh != before.mesh) {
        std::optional<ConfigValue> mesh;
        if (!warp.mesh.offsets.empty())
            mesh = ConfigValue::Map{{"points", glm::dvec2(warp.mesh.points)},
                                    {"between", warp.mesh.between == WarpMesh::Between::Smooth ? "smooth" : "straight"},
                                    {"offsets", warp.mesh.offsets}};
        set(true, {"mesh"}, std::move(mesh));
    }
    maskChanges(then.masks, now.masks, set);
    std::optional<ConfigValue> gamma = now.light.gamma ? ConfigValue(*now.light.gamma) : ConfigValue("srgb");
    set(now.light.gamma != then.light.gamma, {"light", "gamma"}, std::move(gamma));
    set(now.light.blackLevel != then.light.blackLevel, {"light", "black_level"}, now.light.blackLevel);
    set(now.light.white != then.light.white, {"light", "white"}, now.light.white);
    set(now.light.brightness != then.light.brightness, {"light", "brightness"}, now.light.brightness);
    return changes;
}

Result<void> applyChanges(ConfigDocument& document, const Site& site, const std::vector<SiteChange>& changes) {
    for (const SiteChange& change : changes) {
        const std::string& name = site.outputs[*change.path[1].index()].name;
        const auto place = document.itemNamed("outputs", name);
        if (!place) return Error(fmt::format("{}: there is no output '{}' any more", site.file.string(), name));
        ConfigPath there{"outputs", *place};
        there.insert(there.end(), change.path.begin() + 2, change.path.end());
        TRY(change.value ? document.set(there, *change.value) : document.erase(there));
    }
    return {};
}

}  // namespace fantascope::show
