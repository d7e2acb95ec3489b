#pragma once

#include "theatre/body/posed_body.h"
#include "theatre/stage/stage.h"

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::theatre {

struct PoseTarget;

// An artist's hint about a target (Won & Lee 2016, strategy 2): a point of the target, and the body
// parts, or the point of a prop, whose shadow may come there.
struct PoseHint {
    std::string name;               // of the point, for messages
    glm::dvec2 place{0};            // on the first beam's flat screen, metres
    std::vector<BodyPart> parts{};  // of any actor; the nearest is drawn to `place`
    // Instead of `parts`, a point of a held prop: `local` is from the holding part's point, in the
    // axes of the T-pose, metres.
    struct Held {
        Prop::Holder holder;
        glm::dvec3 local{0};
    };
    std::optional<Held> held{};
};

// The candidate on one body whose shadow is nearest to a hint.
struct HintMatch {
    std::optional<Body::Point> point{};  // none: no candidate throws a shadow
    glm::dvec2 away{0};                  // from the hint to its shadow, mask pixels
    double square = 0;                   // squared length of `away`
};

// The minimum of equation 7 over the candidates of one actor (from 0), for each hint. Candidates
// are Body::parts or the point of a prop. A candidate throws no shadow if it is not nearer to the
// screen than the light, or if this actor does not hold the prop. It then counts as farther away
// than any that does. Thread: reentrant.
void matchHints(std::span<const PoseHint> hints, const ScreenFrame& frame, std::size_t actor, const Body& body,
                const PosedBody& posed, std::vector<HintMatch>& matches);

// Reads *.hints.yaml, docs/hints-format.md, for a target on a stage. Error: names file, line, the
// hint and what to do; for instance two hints of one name, an unknown part or none, a prop that
// nobody holds, a point outside the picture, or one that is farther than kFarFromTarget of the
// target's height from the white.
Result<std::vector<PoseHint>> readHints(const std::filesystem::path& file, const PoseTarget& target, const Stage& stage);
constexpr double kFarFromTarget = 0.05;

}  // namespace fantascope::theatre
