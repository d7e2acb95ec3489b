#include "theatre/artefacts.h"

#include "theatre/capsule_shadow.h"
#include "theatre/distance_field.h"

#include <algorithm>
#include <set>

namespace fantascope::theatre {
namespace {

constexpr double kBeside = 3;  // from an artefact, pixels of a target 256 high

// The shadow of each joint's capsules.
std::vector<BitMask> partShadows(const PoseProblem& problem, const SceneEnergy& energy, std::size_t actor) {
    const Body& body = problem.actors[actor];
    const BitMask& mask = problem.target.mask;
    std::vector<BitMask> shadows(body.joints.size(), BitMask(mask.width(), mask.height()));
    CapsuleShadow shadow;
    for (std::size_t i = 0; i < body.capsules.size(); ++i)
        shadow.add(problem.target.frame, energy.posed(actor).capsule(i), shadows[body.capsules[i].joint]);
    for (BitMask& part : shadows) cutToLit(problem.stage, problem.target.frame, part);
    return shadows;
}

}  // namespace

BitMask visibleArtefacts(const PoseTarget& target, const BitMask& shadow) {
    const double radius = 0.5 * kVisibleArtefact / target.pixelsOf256;
    const BitMask middles = deeperThan(signedDistance(difference(target.mask, shadow)), radius - 0.5);
    return middles.count() == 0 ? middles : deeperThan(signedDistance(middles), -radius);
}

std::vector<Freedoms> occludedChains(const PoseProblem& problem, const SceneEnergy& energy) {
    std::vector<std::vector<BitMask>> parts;
    for (std::size_t a = 0; a < problem.actors.size(); ++a) parts.push_back(partShadows(problem, energy, a));
    std::vector<std::vector<char>> isFree;
    for (const auto& actor : parts) isFree.emplace_back(actor.size(), 0);
    const BitMask props = energy.propShadow();

    // Whether what is free of an actor is hidden by all that is not.
    const auto isHidden = [&](std::size_t actor) {
        BitMask free(props.width(), props.height()), rest = props;
        for (std::size_t a = 0; a < parts.size(); ++a)
            for (std::size_t i = 0; i < parts[a].size(); ++i)
                if (isFree[a][i] == 0)
                    rest.add(parts[a][i]);
                else if (a == actor)
                    free.add(parts[a][i]);
        return isWithin(free, rest);
    };
    std::vector<Freedoms> chains;
    for (std::size_t a = 0; a < parts.size(); ++a) {
        const Body& body = problem.actors[a];
        std::vector<char> isEnd(body.joints.size(), 1);
        for (std::size_t i = 1; i < body.joints.size(); ++i) isEnd[body.joints[i].parent] = 0;
        const std::size_t first = problem.firstFreedom(a);
        for (std::size_t end = 1; end < body.joints.size(); ++end) {
            if (isEnd[end] == 0) continue;
            Freedoms chain;
            for (std::size_t joint = end; joint != 0; joint = body.joints[joint].parent) {
                // What carries more than this chain is not free with it.
                const bool carriesOther = std::any_of(body.joints.begin() + 1, body.joints.end(), [&](const Body::Joint& other) {
                    return other.parent == joint && isFree[a][static_cast<std::size_t>(&other - body.joints.data())] == 0;
                });
                if (carriesOther) break;
                isFree[a][joint] = 1;
                if (!isHidden(a)) {
                    isFree[a][joint] = 0;
                    break;
                }
                for (std::size_t k = 0; k < body.joints[joint].motion.size(); ++k)
                    chain.push_back(first + body.joints[joint].first + k);
            }
            std::sort(chain.begin(), chain.end());
            if (!chain.empty()) chains.push_back(std::move(chain));
        }
    }
    return chains;
}

Freedoms freedomsBeside(const PoseProblem& problem, const SceneEnergy& energy, const BitMask& artefacts) {
    if (artefacts.count() == 0) return {};
    const BitMask around = deeperThan(signedDistance(artefacts), -kBeside / problem.target.pixelsOf256);
    std::set<std::size_t> chosen;
    for (std::size_t a = 0; a < problem.actors.size(); ++a) {
        const Body& body = problem.actors[a];
        const std::size_t first = problem.firstFreedom(a);
        const auto choose = [&](std::size_t joint) {
            const std::size_t count = joint == 0 ? Body::kRootFreedoms : body.joints[joint].motion.size();
            for (std::size_t k = 0; k < count; ++k) chosen.insert(first + body.joints[joint].first + k);
        };
        const std::vector<BitMask> parts = partShadows(problem, energy, a);
        for (std::size_t joint = 0; joint < parts.size(); ++joint) {
            if (!meet(parts[joint], around)) continue;
            choose(joint);
            if (joint != 0 && body.joints[joint].parent != 0) choose(body.joints[joint].parent);
        }
    }
    return {chosen.begin(), chosen.end()};
}

}  // namespace fantascope::theatre
