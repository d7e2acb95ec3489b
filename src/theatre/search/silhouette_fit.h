#pragma once

#include "theatre/body/pose_equations.h"
#include "theatre/energy/scene_energy.h"
#include "theatre/search/inverse_kinematics.h"

#include "media/image.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// Moves actors' limbs so that the outline of their shadow goes where the target's is: Levenberg's
// damped steps (1944) on how far each point of the shadow's contour is from the target's along its
// normal, with the analytic derivative of the shadow by the joints. The residuals are reweighted at
// each step so that their squares add up to what equations 2, 3, 6, 7, 8, 10 and 11 charge; a step
// is kept only if the energy itself falls, once what is held has been put back. From poses that are
// far from the target it finds nothing: it finishes what a global search has begun.
// Thread: thread-bound.
class SilhouetteFit {
public:
    // `problem` must live on.
    explicit SilhouetteFit(const PoseProblem& problem);

    // Lowers the energy of `dofs` (of all actors, within their limits) by no more than `steps`
    // steps that were kept or not; gives the energy. `energy` is left posed so. `stiffness`: of
    // physics (SceneEnergy::pose()). `moves`: for each degree of freedom whether it may change;
    // empty: all may.
    double run(SceneEnergy& energy, std::span<double> dofs, int steps, double stiffness = 1, std::span<const char> moves = {});

    std::int64_t evaluations() const { return evaluations_; }  // of the energy, so far

private:
    // Of `energy` posed by `dofs`, its terms asked for.
    void linearise(SceneEnergy& energy, std::span<const double> dofs);
    void addContour(const BeamEnergy& beam, const SceneEnergy& energy, const GreyImage& distance);
    void addHints(const SceneEnergy& energy);
    void addIntrusions(const SceneEnergy& energy, std::size_t actor, double weight);
    void addPhysics(SceneEnergy& energy);
    void addContinuity(const SceneEnergy& energy, std::span<const double> dofs);
    void addBalance(const SceneEnergy& energy, std::size_t actor, const PoseWeights& weights);

    const PoseProblem& problem_;
    std::vector<GreyImage> distances_;      // of each beam's target, signedDistance()
    std::vector<PoseEquations> equations_;  // of each actor: a residual moves with his joints alone
    std::vector<InverseKinematics> kinematics_;
    std::vector<std::size_t> first_;  // degree of freedom of each actor
    std::vector<double> trial_;
    std::vector<Intrusion> intrusions_;
    std::vector<SupportTangent> tangents_;
    std::int64_t evaluations_ = 0;
};

}  // namespace fantascope::theatre
