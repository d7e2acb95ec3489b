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
// the beams. What an actor alone decides (pose, shadows, balance, sight), and what two do, is kept
// until one of them moves; so one who moves costs no more than one.
// Thread: thread-bound.
class SceneEnergy {
public:
    // `problem` must live on.
    explicit SceneEnergy(const PoseProblem& problem);

    // Poses all actors: their degrees of freedom, one actor after the other. `stiffness` of physics
    // (EnergyTerms::physics()) holds until all are posed again.
    void pose(std::span<const double> dofs, double stiffness = 1);
    // Poses one actor.
    void pose(std::size_t actor, std::span<const double> dofs);
    // Of the poses last given.
    const EnergyTerms& terms();
    double energy() { return terms().total(problem_.weights, stiffness_); }
    double lastEnergy() const { return terms_.total(problem_.weights, stiffness_); }  // of the terms last asked for
    double stiffness() const { return stiffness_; }
    // How gradually what is higher bears less, for findBearings(), metres. Weak physics is not
    // sharp either: a foot far above the ground bears a little.
    double bearingDepth() const { return bearingDepth_; }

    std::size_t beams() const { return beams_.size(); }
    const BeamEnergy& beam(std::size_t index) const { return beams_[index]; }  // its sums after terms()
    // Of the first beam.
    const BitMask& shadow() const { return beams_[0].shadow(); }
    const BitMask& shadow(std::size_t actor) const { return beams_[0].shadow(actor); }
    std::span<const ContourPoint> nearest() const { return beams_[0].nearest(); }
    std::span<const int> owners() const { return beams_[0].owners(); }
    // Platforms and props in those poses, metres, stage frame.
    struct Thing {
        std::string name;
        TriangleMesh mesh;
    };
    std::vector<Thing> things() const;
    const PosedBody& posed(std::size_t actor) const { return actors_[actor].body; }
    // The skin's vertices, metres; none for a problem without skins.
    std::span<const glm::vec3> skin(std::size_t actor) const { return actors_[actor].skin; }
    // What bears, for the energy: findBearings() of the skin's vertices or else of the spheres.
    const Contacts& bearings(std::size_t actor) const { return actors_[actor].contacts; }
    double margin(std::size_t actor) const { return actors_[actor].margin; }  // on them, metres

    // Of each hint: the actor whose candidate is nearest, and which that is.
    struct HintOwner {
        std::size_t actor = 0;
        HintMatch match;
    };
    HintOwner hintOwner(std::size_t hint) const;
    // An actor's spheres, or the vertices of his skin, as if what is under them were the floor.
    std::span<const PlacedSphere> aboveGround(std::size_t actor) const {
        return problem_.stage.platforms.empty() ? actors_[actor].body.spheres() : actors_[actor].aboveGround;
    }
    std::span<const glm::vec3> skinAboveGround(std::size_t actor) const {
        return problem_.stage.platforms.empty() ? skin(actor) : actors_[actor].skinAboveGround;
    }
    double outside(std::size_t actor) const { return actors_[actor].outside; }  // how far he stands outside where he may, metres
    // Where an actor is in platforms and props, and what he holds in anything.
    std::span<const Intrusion> intrusions(std::size_t actor) const { return actors_[actor].intrusions; }
    std::span<const PlacedProp> held(std::size_t actor) const { return actors_[actor].held; }

private:
    struct Actor {
        PosedBody body;
        std::vector<glm::vec3> skin;
        bool hasMoved = true;  // since terms() were last asked for
        Contacts contacts;
        double margin = 0;
        EnergyTerms own;                 // what depends on this actor alone
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
    std::vector<double> depthsInOthers_;  // of each actor in each that comes after him
    EnergyTerms terms_;
    double stiffness_ = 1, bearingDepth_ = kBearingDepth;
};

}  // namespace fantascope::theatre
