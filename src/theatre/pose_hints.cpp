#include "theatre/pose_hints.h"

#include "theatre/distance_field.h"
#include "theatre/pose_problem.h"

#include "core/config.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kVersion = 1;
constexpr std::size_t kMostHints = 100;

Result<std::vector<BodyPart>> readParts(const ConfigNode& node, const std::string& hint) {
    const std::vector<ConfigNode> words = TRY(node.items());
    if (words.empty())
        return node.error(
            fmt::format("hint '{}' has no body part; name those that may come to its point, of: {}", hint, listed(partWords())));
    std::vector<BodyPart> parts;
    for (const ConfigNode& at : words) {
        const std::string word = TRY(at.text());
        const std::vector<BodyPart> named = partsOf(word);
        if (named.empty()) {
            const std::string nearest = nearestName(word, partWords());
            return at.error(fmt::format("hint '{}': there is no body part '{}'{}; known are: {}", hint, word,
                                        nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest),
                                        listed(partWords())));
        }
        for (const BodyPart part : named)
            if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
    }
    return parts;
}

Result<glm::dvec2> readPlace(const ConfigNode& node, const std::string& hint, const PoseTarget& target,
                             const GreyImage& inWhite) {
    const std::vector<ConfigNode> numbers = TRY(node.items(2, 2));
    constexpr double kAny = 1e9;
    const glm::dvec2 share(TRY(numbers[0].number(-kAny, kAny)), TRY(numbers[1].number(-kAny, kAny)));
    if (std::min(share.x, share.y) < 0 || std::max(share.x, share.y) > 1)
        return node.error(
            fmt::format("hint '{}' is at [{}, {}], outside the picture; both are shares of the picture, from 0 (left, top) "
                        "to 1 (right, bottom): divide the point's pixels by the picture's width and height",
                        hint, share.x, share.y));
    const auto flat = target.flatFromGiven(share * glm::dvec2(target.given.width(), target.given.height()));
    if (!flat)
        return node.error(
            fmt::format("hint '{}' is where the light does not come on the curved screen; move it to the silhouette", hint));
    const glm::dvec2 place = *flat;
    // Where the picture is larger than the mask all is black: as far as its edge is, and the way to it.
    const ScreenFrame& frame = target.frame;
    const glm::dvec2 pixel = frame.pixelAt(place.x, place.y);
    const glm::dvec2 inMask = glm::clamp(pixel, glm::dvec2(0), glm::dvec2(frame.width(), frame.height()) - 1e-9);
    const double outside =
        std::max(0.0, -double(inWhite.at(static_cast<int>(inMask.x), static_cast<int>(inMask.y)))) + glm::distance(pixel, inMask);
    const double share256 = outside * target.pixelsOf256 / 256;
    if (share256 > kFarFromTarget)
        return node.error(
            fmt::format("hint '{}' is {:.0f} % of the silhouette's height away from the white, and no shadow may fall "
                        "there; up to {:.0f} % is allowed: move it to the outline, or within",
                        hint, 100 * share256, 100 * kFarFromTarget));
    return place;
}

}  // namespace

void matchHints(std::span<const PoseHint> hints, const ScreenFrame& frame, const Body& body, const PosedBody& posed,
                std::vector<HintMatch>& matches) {
    matches.resize(hints.size());
    const double far = 2.0 * (frame.width() + frame.height());
    for (std::size_t i = 0; i < hints.size(); ++i) {
        const glm::dvec2 wanted = frame.pixelAt(hints[i].place.x, hints[i].place.y);
        HintMatch& best = matches[i] = {hints[i].parts[0], {0, 0}, far * far};
        for (const BodyPart part : hints[i].parts) {
            const glm::dvec3 point = posed.point(body.parts[static_cast<std::size_t>(part)]);
            if (frame.fromLight(point).z <= 0) continue;
            const glm::dvec2 away = frame.shadow(point) - wanted;
            if (const double square = glm::dot(away, away); square < best.square) best = {part, away, square};
        }
    }
}

Result<std::vector<PoseHint>> readHints(const fs::path& file, const PoseTarget& target) {
    const GreyImage inWhite = signedDistance(target.mask);
    std::vector<PoseHint> hints;
    ConfigFields fields(TRY(ConfigNode::load(file)));
    fields.header("hints", kVersion);
    fields.list(
        "hints", hints,
        [&, names = std::vector<std::string>()](const ConfigNode& node) mutable -> Result<PoseHint> {
            PoseHint hint;
            ConfigFields own(node);
            own.read("name", hint.name, [&](const ConfigNode& at) -> Result<std::string> {
                const std::string name = TRY(at.text());
                if (std::find(names.begin(), names.end(), name) != names.end())
                    return at.error(fmt::format("two hints are called '{}'; give each a name of its own", name));
                names.push_back(name);
                return name;
            });
            own.read("at", hint.place, [&](const ConfigNode& at) { return readPlace(at, hint.name, target, inWhite); });
            own.read("parts", hint.parts, [&](const ConfigNode& at) { return readParts(at, hint.name); });
            TRY(own.finish());
            return hint;
        },
        0, kMostHints);
    TRY(fields.finish());
    return hints;
}

}  // namespace fantascope::theatre
