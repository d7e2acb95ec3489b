#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/stage/capsule_shadow.h"
#include "theatre/stage/mesh_shadow.h"
#include "theatre/stage/stage_set.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// The energy terms of one beam: the actors' shadows on its screen, and their difference from the
// target there (Won & Lee 2016, equations 2 to 4). An actor's shadow is cached until the actor
// moves. Nearest contour points are cached where the shadow has not changed.
// Thread: thread-bound.
class BeamEnergy {
public:
    // `problem` must outlive this object. `standing`: the stage's props that nobody holds.
    BeamEnergy(const PoseProblem& problem, std::size_t beam, std::span<const PlacedProp> standing);

    // Poses one actor. `skin`: his skin's vertices; empty for a problem without skins.
    void pose(std::size_t actor, const PosedBody& body, std::span<const glm::vec3> skin, std::span<const PlacedProp> held);
    // Adds the contour, coverage and coherence terms of the current poses.
    void addTo(EnergyTerms& terms);

    const PoseTarget& target() const { return target_; }
    const BitMask& shadow() const { return shadow_; }  // of everything; valid after addTo()
    const BitMask& shadow(std::size_t actor) const { return actors_[actor].shadow; }
    // The approximate area of people's shadows beside or above the masks, in pixels. 0 if a
    // projector's picture ends within them.
    double beyond() const;
    BitMask propShadow() const;                                   // of platforms and props, in the current poses
    const BitMask& contour() const { return contour_.pixels(); }  // of shadow(); valid after addTo()
    // For each contour point of the target: the nearest point of the shadow's contour, and the
    // actor who throws it, or kNobody. Valid after addTo().
    std::span<const ContourPoint> nearest() const { return nearest_; }
    std::span<const int> owners() const { return owners_; }

private:
    struct Actor {
        BitMask shadow, held;  // held: the shadow of held props; empty until he holds one
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
    BitMask shadow_, shadowBefore_;  // shadowBefore_: the shadow for which nearest_ was found
    Changes changes_;                // between the two
    Contour contour_;
    bool hasNearest_ = false;
    std::vector<ContourPoint> nearest_;
    std::vector<int> owners_;
};

}  // namespace fantascope::theatre
