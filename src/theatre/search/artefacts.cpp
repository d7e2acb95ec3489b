#include "theatre/search/artefacts.h"

#include "theatre/mask/distance_field.h"
#include "theatre/stage/capsule_shadow.h"

#include <algorithm>
#include <set>

namespace fantascope::theatre {
namespace {

constexpr double kBeside = 3;  // distance from an artefact that counts as beside it, pixels of a target 256 high

// The shadow of each joint's capsules on a beam's screen.
std::vector<BitMask> partShadows(const PoseProblem& problem, const SceneEnergy& energy, std::size_t actor, std::size_t beam) {
    const Body& body = problem.actors[actor];
    const PoseTarget& target = problem.targets[beam];
    const BitMask& mask = target.mask;
    std::vector<BitMask> shadows(body.joints.size(), BitMask(mask.width(), mask.height()));
    CapsuleShadow shadow;
    for (std::size_t i = 0; i < body.capsules.size(); ++i)
        shadow.add(target.frame, energy.posed(actor).capsule(i), shadows[body.capsules[i].joint]);
    for (BitMask& part : shadows) target.cut(problem.stage, part);
    return shadows;
}

}  // namespace

BitMask visibleArtefacts(const PoseTarget& target, const BitMask& shadow) {
    const double radius = 0.5 * kVisibleArtefact / target.refPixelsPerPixel;
    const BitMask middles = deeperThan(signedDistance(difference(target.mask, shadow)), radius - 0.5);
    return middles.count() == 0 ? middles : deeperThan(signedDistance(middles), -radius);
}

std::vector<BitMask> visibleArtefacts(const SceneEnergy& energy) {
    std::vector<BitMask> artefacts;
    for (std::size_t i = 0; i < energy.beams(); ++i)
        artefacts.push_back(visibleArtefacts(energy.beam(i).target(), energy.beam(i).shadow()));
    return artefacts;
}

std::vector<Dofs> occludedChains(const PoseProblem& problem, const SceneEnergy& energy) {
    // The shadows of each part and of the props on a beam's screen.
    struct OnScreen {
        std::vector<std::vector<BitMask>> parts;  // of each actor
        BitMask props;
    };
    std::vector<OnScreen> screens(energy.beams());
    for (std::size_t i = 0; i < screens.size(); ++i) {
        screens[i].props = energy.beam(i).propShadow();
        for (std::size_t a = 0; a < problem.actors.size(); ++a) screens[i].parts.push_back(partShadows(problem, energy, a, i));
    }
    std::vector<std::vector<char>> isFree;
    for (const Body& body : problem.actors) isFree.emplace_back(body.joints.size(), 0);

    // Whether the shadow of an actor's free parts is hidden by that of everything not free.
    const auto isHidden = [&](std::size_t actor) {
        return std::all_of(screens.begin(), screens.end(), [&](const OnScreen& screen) {
            BitMask free(screen.props.width(), screen.props.height()), rest = screen.props;
            for (std::size_t a = 0; a < screen.parts.size(); ++a)
                for (std::size_t i = 0; i < screen.parts[a].size(); ++i)
                    if (isFree[a][i] == 0)
                        rest.add(screen.parts[a][i]);
                    else if (a == actor)
                        free.add(screen.parts[a][i]);
            return isWithin(free, rest);
        });
    };
    std::vector<Dofs> chains;
    for (std::size_t a = 0; a < problem.actors.size(); ++a) {
        const Body& body = problem.actors[a];
        std::vector<char> isEnd(body.joints.size(), 1);
        for (std::size_t i = 1; i < body.joints.size(); ++i) isEnd[body.joints[i].parent] = 0;
        const std::size_t first = problem.firstDof(a);
        for (std::size_t end = 1; end < body.joints.size(); ++end) {
            if (isEnd[end] == 0) continue;
            Dofs chain;
            for (std::size_t joint = end; joint != 0; joint = body.joints[joint].parent) {
                // A joint that carries more than this chain is not part of it.
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

Dofs dofsBeside(const PoseProblem& problem, const SceneEnergy& energy, std::span<const BitMask> artefacts) {
    std::set<std::size_t> chosen;
    for (std::size_t beam = 0; beam < artefacts.size(); ++beam) {
        if (artefacts[beam].count() == 0) continue;
        const BitMask around = deeperThan(signedDistance(artefacts[beam]), -kBeside / problem.targets[beam].refPixelsPerPixel);
        for (std::size_t a = 0; a < problem.actors.size(); ++a) {
            const Body& body = problem.actors[a];
            const std::size_t first = problem.firstDof(a);
            const auto choose = [&](std::size_t joint) {
                const std::size_t count = joint == 0 ? Body::kRootDofs : body.joints[joint].motion.size();
                for (std::size_t k = 0; k < count; ++k) chosen.insert(first + body.joints[joint].first + k);
            };
            const std::vector<BitMask> parts = partShadows(problem, energy, a, beam);
            for (std::size_t joint = 0; joint < parts.size(); ++joint) {
                if (!meet(parts[joint], around)) continue;
                choose(joint);
                if (joint != 0 && body.joints[joint].parent != 0) choose(body.joints[joint].parent);
            }
        }
    }
    return {chosen.begin(), chosen.end()};
}

}  // namespace fantascope::theatre
