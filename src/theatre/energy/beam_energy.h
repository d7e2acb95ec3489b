#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/stage/capsule_shadow.h"
#include "theatre/stage/mesh_shadow.h"
#include "theatre/stage/stage_set.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// What one beam makes of the actors' poses: their shadows on its screen, and how these differ from
// the target there (Won & Lee 2016, equations 2 to 4). Shadows are kept until who throws them
// moves, and what the contour is like where the shadow is as it was.
// Thread: thread-bound.
class BeamEnergy {
public:
    // `problem` must live on; `standing`: its stage's props that nobody holds.
    BeamEnergy(const PoseProblem& problem, std::size_t beam, std::span<const PlacedProp> standing);

    // Poses one actor. `skin`: his vertices; empty for a problem without skins.
    void pose(std::size_t actor, const PosedBody& body, std::span<const glm::vec3> skin, std::span<const PlacedProp> held);
    // Adds contour, coverage and coherence of the poses last given.
    void addTo(EnergyTerms& terms);

    const PoseTarget& target() const { return target_; }
    const BitMask& shadow() const { return shadow_; }  // of all; after addTo()
    const BitMask& shadow(std::size_t actor) const { return actors_[actor].shadow; }
    // How much of people's shadows falls beside the target's masks or above them, pixels, about;
    // nothing where a projector's picture ends before.
    double beyond() const;
    BitMask propShadow() const;                                   // of platforms and props, in the poses last given
    const BitMask& contour() const { return contour_.pixels(); }  // of the shadow of all; after addTo()
    // Of each of the target's contour points: the nearest point of the shadow's contour and the
    // actor whose it is, or kNobody; after addTo().
    std::span<const ContourPoint> nearest() const { return nearest_; }
    std::span<const int> owners() const { return owners_; }

private:
    struct Actor {
        BitMask shadow, held;  // held: of props, sized once he holds any
        double beyond = 0;
    };
    void compareContours(EnergyTerms& terms);
    bool isAsBefore(std::size_t point) const;

    const PoseProblem& problem_;
    const PoseTarget& target_;
    ContourDisc disc_;
    std::vector<Actor> actors_;
    CapsuleShadow capsuleShadow_;
    MeshShadow meshShadow_;
    BitMask standingShadow_;
    BitMask shadow_, shadowBefore_;  // shadowBefore_: what nearest_ was found in
    Changes changes_;                // between the two
    Contour contour_;
    bool hasNearest_ = false;
    std::vector<ContourPoint> nearest_;
    std::vector<int> owners_;
};

}  // namespace fantascope::theatre
