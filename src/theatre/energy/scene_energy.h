#pragma once

#include "theatre/body/balance.h"
#include "theatre/energy/beam_energy.h"
#include "theatre/energy/pose_problem.h"
#include "theatre/stage/stage_set.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::theatre {

// The energy of the actors' poses (Won & Lee 2016, equation 1), with equations 2 to 4 summed over
// the beams. Terms that depend on one actor (pose, shadows, balance, sight) or on two are cached
// until one of them moves, so that moving one actor costs the work for one.
// Thread: thread-bound.
class SceneEnergy {
public:
    // `problem` must outlive this object.
    explicit SceneEnergy(const PoseProblem& problem);

    // Poses all actors by their degrees of freedom, one actor after the other. `stiffness`
    // (EnergyTerms::physics()) holds until all are posed again.
    void pose(std::span<const double> dofs, double stiffness = 1);
    // Poses one actor.
    void pose(std::size_t actor, std::span<const double> dofs);
    // The terms of the current poses.
    const EnergyTerms& terms();
    double energy() { return terms().total(problem_.weights, stiffness_); }
    double lastEnergy() const { return terms_.total(problem_.weights, stiffness_); }  // of the last result of terms()
    double stiffness() const { return stiffness_; }
    // The fall-off height `bearing` for findBearings(), metres. It grows as the stiffness falls:
    // with weak physics even a foot far above the ground bears a little.
    double bearingDepth() const { return bearingDepth_; }

    std::size_t beams() const { return beams_.size(); }
    const BeamEnergy& beam(std::size_t index) const { return beams_[index]; }  // its results are valid after terms()
    // The results of the first beam.
    const BitMask& shadow() const { return beams_[0].shadow(); }
    const BitMask& shadow(std::size_t actor) const { return beams_[0].shadow(actor); }
    std::span<const ContourPoint> nearest() const { return beams_[0].nearest(); }
    std::span<const int> owners() const { return beams_[0].owners(); }
    // Platforms and props in the current poses, metres, stage frame.
    struct Thing {
        std::string name;
        TriangleMesh mesh;
    };
    std::vector<Thing> things() const;
    const PosedBody& posed(std::size_t actor) const { return actors_[actor].body; }
    // The skin's vertices, metres, stage frame. Empty for a problem without skins.
    std::span<const glm::vec3> skin(std::size_t actor) const { return actors_[actor].skin; }
    // The contacts for the energy: findBearings() of the skin's vertices, or else of the spheres.
    const Contacts& bearings(std::size_t actor) const { return actors_[actor].contacts; }
    double margin(std::size_t actor) const { return actors_[actor].margin; }  // of balance on the bearings, metres

    // For a hint, the actor with the nearest candidate, and that candidate.
    struct HintOwner {
        std::size_t actor = 0;
        HintMatch match;
    };
    HintOwner hintOwner(std::size_t hint) const;
    // An actor's spheres, or the vertices of his skin, with heights measured from the ground under
    // them.
    std::span<const PlacedSphere> aboveGround(std::size_t actor) const {
        return problem_.stage.platforms.empty() ? actors_[actor].body.spheres() : actors_[actor].aboveGround;
    }
    std::span<const glm::vec3> skinAboveGround(std::size_t actor) const {
        return problem_.stage.platforms.empty() ? skin(actor) : actors_[actor].skinAboveGround;
    }
    double outside(std::size_t actor) const { return actors_[actor].outside; }  // distance outside the standing area, metres
    // Intrusions of an actor into platforms and props, and of the props that he holds into the
    // stage set.
    std::span<const Intrusion> intrusions(std::size_t actor) const { return actors_[actor].intrusions; }
    std::span<const PlacedProp> held(std::size_t actor) const { return actors_[actor].held; }

private:
    struct Actor {
        PosedBody body;
        std::vector<glm::vec3> skin;
        bool hasMoved = true;  // since the last call of terms()
        Contacts contacts;
        double margin = 0;
        EnergyTerms own;                 // the terms that depend on this actor alone
        std::vector<HintMatch> matches;  // of each hint
        double outside = 0;
        std::vector<PlacedSphere> aboveGround;
        std::vector<glm::vec3> skinAboveGround;
        std::vector<PlacedProp> held;
        std::vector<Intrusion> intrusions;
    };
    double unseenScreen(const Body& body, const PosedBody& posed) const;
    void findDepthsInOthers();

    static constexpr double kBearingDepth = 0.005;  // at stiffness 1

    const PoseProblem& problem_;
    std::vector<Actor> actors_;
    std::vector<PlacedProp> standing_;
    std::vector<BeamEnergy> beams_;
    std::vector<Intrusion> inOthersProps_;
    std::vector<double> depthsInOthers_;  // of each actor in each later one
    EnergyTerms terms_;
    double stiffness_ = 1, bearingDepth_ = kBearingDepth;
};

}  // namespace fantascope::theatre
