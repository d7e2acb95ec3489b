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

// The degrees of freedom of a joint, of all that hang on it, and of the one that it hangs on; not
// the root's.
std::vector<std::size_t> limb(const Body& body, std::size_t joint);

// CMA-ES over some of the degrees of freedom of a scene while the others are held: of one limb, of
// one actor, or all of them. Each actor's are a block of the covariance matrix, unless it is to be
// full.
// Thread: thread-bound.
class DofSearch {
public:
    struct Settings {
        double sigma = 0.5;  // in Body::scaleOf()
        int population = 40, generations = 100;
        double converged = 0;         // ends when the energies of the last generations differ by no more; 0: never
        bool fullCovariance = false;  // between actors too
        // Of physics (SceneEnergy::pose()) at the first generation. It grows by the same factor
        // each generation, so that it would be the last after `generations`.
        double stiffness = 1;
        std::optional<double> lastStiffness{};  // none: it does not change
        double stiffnessAt(int generation) const;
    };

    // `problem` must live on.
    explicit DofSearch(const PoseProblem& problem);

    // Searches from `dofs` over those with a number in `which` (ascending, of all actors' degrees
    // of freedom; of a joint all, since its limits are theirs together) and leaves the best
    // candidate of the last generation there; gives its energy. Candidates are brought within the
    // limits, and what is held to where it is held, by whatever degrees of freedom it takes. The
    // search ends when `goesOn`, asked before each generation, gives false.
    double run(SceneEnergy& energy, std::span<double> dofs, std::span<const std::size_t> which, const Settings& settings,
               Rng& rng, const std::function<bool()>& goesOn = {});

    // How a local search leaves where it is: one actor is searched anew, or one of his limbs, or he
    // makes a step in the dark.
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
