#pragma once

#include "theatre/body/pose_equations.h"
#include "theatre/energy/scene_energy.h"
#include "theatre/search/inverse_kinematics.h"

#include "media/image.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// Moves actors' limbs so that the outline of their shadow goes to that of the target. Levenberg's
// damped steps (1944) minimise the distance of each point of the shadow's contour from the target's
// contour along its normal, with the analytic derivative of the shadow by the joints. The residuals
// are reweighted at each step, so that their squares add up to the terms of equations 2, 3, 6, 7,
// 8, 10 and 11. A step is kept only if the energy itself falls after held contacts are restored.
// The fit converges only near the target: it refines the result of a global search.
// Thread: thread-bound.
class SilhouetteFit {
public:
    // `problem` must outlive this object.
    explicit SilhouetteFit(const PoseProblem& problem);

    // Lowers the energy of `dofs` (of all actors, within their limits) in at most `steps` steps,
    // kept or not, and gives the energy. `energy` is left posed by the result. `stiffness`: of
    // physics (SceneEnergy::pose()). `moves`: for each degree of freedom whether it may change;
    // empty: all may.
    double run(SceneEnergy& energy, std::span<double> dofs, int steps, double stiffness = 1, std::span<const char> moves = {});

    std::int64_t evaluations() const { return evaluations_; }  // of the energy, so far

private:
    // Builds the equations around `dofs`. `energy` must be posed by `dofs`, with its terms() up to
    // date.
    void linearise(SceneEnergy& energy, std::span<const double> dofs);
    void addContour(const BeamEnergy& beam, const SceneEnergy& energy, const GreyImage& distance);
    void addHints(const SceneEnergy& energy);
    void addIntrusions(const SceneEnergy& energy, std::size_t actor, double weight);
    void addPhysics(SceneEnergy& energy);
    void addContinuity(const SceneEnergy& energy, std::span<const double> dofs);
    void addBalance(const SceneEnergy& energy, std::size_t actor, const PoseWeights& weights);

    const PoseProblem& problem_;
    std::vector<GreyImage> distances_;      // of each beam's target, signedDistance()
    std::vector<PoseEquations> equations_;  // of each actor: a residual depends on his joints alone
    std::vector<InverseKinematics> kinematics_;
    std::vector<std::size_t> first_;  // degree of freedom of each actor
    std::vector<double> trial_;
    std::vector<Intrusion> intrusions_;
    std::vector<SupportTangent> tangents_;
    std::int64_t evaluations_ = 0;
};

}  // namespace fantascope::theatre
