#pragma once

#include "theatre/energy/scene_energy.h"
#include "theatre/search/inverse_kinematics.h"

#include "core/random.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The degrees of freedom of a joint, of all joints below it, and of its parent; not the root's.
std::vector<std::size_t> limb(const Body& body, std::size_t joint);

// CMA-ES over some or all degrees of freedom of a scene, for instance those of one limb or one
// actor; the others stay fixed. Each actor's are a block of the covariance matrix, unless
// Settings::fullCovariance is set.
// Thread: thread-bound.
class DofSearch {
public:
    struct Settings {
        double sigma = 0.5;  // in units of Body::scaleOf()
        int population = 40, generations = 100;
        double converged = 0;         // stops when the energies of the last generations differ by no more than this; 0: never
        bool fullCovariance = false;  // between actors too
        // The stiffness of physics (SceneEnergy::pose()) at the first generation. It changes by a
        // constant factor each generation and would reach `lastStiffness` after `generations`.
        double stiffness = 1;
        std::optional<double> lastStiffness{};  // none: the stiffness is constant
        double stiffnessAt(int generation) const;
    };

    // `problem` must outlive this object.
    explicit DofSearch(const PoseProblem& problem);

    // Searches from `dofs` over the degrees of freedom in `which`: ascending indices among those of
    // all actors. It must have all or none of a joint's, since they share limits. `dofs` becomes
    // the best candidate of the last generation; the result is its energy. Candidates are clamped
    // to the limits, and held contacts are restored, for which any degree of freedom may move. The
    // search stops when `goesOn`, asked before each generation, gives false.
    double run(SceneEnergy& energy, std::span<double> dofs, std::span<const std::size_t> which, const Settings& settings,
               Rng& rng, const std::function<bool()>& goesOn = {});

    // The perturbation of a local search. For a random actor, it searches all his degrees of
    // freedom or one limb anew, or makes a random step.
    void disturb(SceneEnergy& energy, std::span<double> dofs, Rng& rng, double stiffness = 1);

    std::int64_t evaluations() const { return evaluations_; }

private:
    struct Part;
    std::vector<Part> partsOf(std::span<const std::size_t> which) const;
    double evaluate(SceneEnergy& energy, std::span<const Part> parts, std::span<const std::size_t> which, std::span<double> own);
    std::span<const double> held(std::size_t actor, std::span<const double> pose);

    const PoseProblem& problem_;
    std::vector<double> candidate_, values_, held_;
    std::vector<InverseKinematics> kinematics_;  // of each actor
    std::int64_t evaluations_ = 0;
};

}  // namespace fantascope::theatre
