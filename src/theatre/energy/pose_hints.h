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

// What an artist knows of a target (Won & Lee 2016, strategy 2): a point of it, and the parts of a
// body, or the point of a prop, whose shadow may come there.
struct PoseHint {
    std::string name;               // of the point, for messages
    glm::dvec2 place{0};            // on the first beam's flat screen, metres
    std::vector<BodyPart> parts{};  // of any actor; whichever is nearest is drawn to the place
    // Instead of them a point of what somebody holds, from the part's point, in the axes of the
    // T-pose, metres.
    struct Held {
        Prop::Holder holder;
        glm::dvec3 local{0};
    };
    std::optional<Held> held{};
};

// The candidate of one body that is nearest to a hint.
struct HintMatch {
    std::optional<Body::Point> point{};  // none: there is no such shadow
    glm::dvec2 away{0};                  // of its shadow from the hint, mask pixels
    double square = 0;                   // of its length
};

// Equation 7's minimum over the candidates of one actor (from 0), for each hint: Body::parts, or
// what he holds. One that is not nearer to the screen than the light, or that he does not hold,
// throws no shadow and counts as farther away than any that does. Thread: reentrant.
void matchHints(std::span<const PoseHint> hints, const ScreenFrame& frame, std::size_t actor, const Body& body,
                const PosedBody& posed, std::vector<HintMatch>& matches);

// *.hints.yaml, docs/hints-format.md, for a target on a stage. Error: names file, line, the hint
// and what to do: two of one name, an unknown part or none, a prop that nobody holds, a point
// outside the picture, or one that is farther than kFarFromTarget of the target's height from the
// white.
Result<std::vector<PoseHint>> readHints(const std::filesystem::path& file, const PoseTarget& target, const Stage& stage);
constexpr double kFarFromTarget = 0.05;

}  // namespace fantascope::theatre
