#include "theatre/energy/pose_hints.h"

#include "theatre/energy/pose_problem.h"
#include "theatre/mask/distance_field.h"

#include "core/config/config.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kVersion = 1;
constexpr std::size_t kMostHints = 100;
constexpr double kFarthest = 20;  // metres: no prop is larger

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

// A prop by its name; somebody must hold it.
Result<const Prop*> readProp(const ConfigNode& node, const std::string& hint, const Stage& stage) {
    const std::string name = TRY(node.text());
    std::vector<std::string> held;
    for (const Prop& prop : stage.props) {
        if (prop.name != name) {
            if (prop.holder) held.push_back(prop.name);
            continue;
        }
        if (!prop.holder)
            return node.error(fmt::format(
                "hint '{}': the prop '{}' stands, and no search moves it; put it there in the stage file", hint, name));
        return &prop;
    }
    return node.error(fmt::format(
        "hint '{}': nobody on the stage holds '{}'; {}", hint, name,
        held.empty() ? "its stage file, of --stage, has no prop with held_by" : fmt::format("held are: {}", listed(held))));
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
        return node.error(fmt::format("hint '{}' is where no light reaches the curved screen; move it to the silhouette", hint));
    const glm::dvec2 place = *flat;
    // The picture may be larger than the mask and is black beyond it. There the distance is that to
    // the mask's edge plus the one read at the edge.
    const ScreenFrame& frame = target.frame;
    const glm::dvec2 pixel = frame.pixelAt(place.x, place.y);
    const glm::dvec2 inMask = glm::clamp(pixel, glm::dvec2(0), glm::dvec2(frame.width(), frame.height()) - 1e-9);
    const double outside =
        std::max(0.0, -double(inWhite.at(static_cast<int>(inMask.x), static_cast<int>(inMask.y)))) + glm::distance(pixel, inMask);
    const double share256 = outside * target.refPixelsPerPixel / 256;
    if (share256 > kFarFromTarget)
        return node.error(
            fmt::format("hint '{}' is {:.0f} % of the silhouette's height away from the white, and no shadow may fall "
                        "there; up to {:.0f} % is allowed: move it to the outline, or within",
                        hint, 100 * share256, 100 * kFarFromTarget));
    return place;
}

}  // namespace

void matchHints(std::span<const PoseHint> hints, const ScreenFrame& frame, std::size_t actor, const Body& body,
                const PosedBody& posed, std::vector<HintMatch>& matches) {
    matches.resize(hints.size());
    const double far = 2.0 * (frame.width() + frame.height());
    const auto partOf = [&](BodyPart part) -> const Body::Point& { return body.parts[static_cast<std::size_t>(part)]; };
    for (std::size_t i = 0; i < hints.size(); ++i) {
        const PoseHint& hint = hints[i];
        const glm::dvec2 wanted = frame.pixelAt(hint.place.x, hint.place.y);
        HintMatch& best = matches[i] = {{}, {0, 0}, far * far};
        const auto offer = [&](const Body::Point& candidate) {
            const glm::dvec3 point = posed.point(candidate);
            if (frame.fromLight(point).z <= 0) return;
            const glm::dvec2 away = frame.shadow(point) - wanted;
            if (const double square = glm::dot(away, away); square < best.square) best = {candidate, away, square};
        };
        for (const BodyPart part : hint.parts) offer(partOf(part));
        if (hint.held && hint.held->holder.actor == actor) {
            const Body::Point& part = partOf(hint.held->holder.part);
            offer({part.joint, part.local + hint.held->local});
        }
    }
}

Result<std::vector<PoseHint>> readHints(const fs::path& file, const PoseTarget& target, const Stage& stage) {
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
            const Prop* prop = nullptr;
            glm::dvec3 point(0);
            own.optional().read("parts", hint.parts, [&](const ConfigNode& at) { return readParts(at, hint.name); });
            own.optional().read("prop", prop, [&](const ConfigNode& at) { return readProp(at, hint.name, stage); });
            own.optional().vector3("point", point, -kFarthest, kFarthest, "m");
            TRY(own.finish());
            if (hint.parts.empty() == (prop == nullptr))
                return node.error(
                    fmt::format("hint '{}' has {}: say which 'parts' of a body may come to its point, or which 'prop'", hint.name,
                                prop == nullptr ? "neither parts nor a prop" : "both parts and a prop"));
            if (prop != nullptr) hint.held = {*prop->holder, prop->place + prop->turn * point};
            return hint;
        },
        0, kMostHints);
    TRY(fields.finish());
    return hints;
}

}  // namespace fantascope::theatre
