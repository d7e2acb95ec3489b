#pragma once

#include "theatre/body/pose_equations.h"
#include "theatre/stage/continuity.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// A body's pose from where its joints are to be: steps of the damped Jacobian pseudo-inverse, each
// as long as a line minimisation finds best (Won & Lee 2016, section 5, Algorithm 1, line 8).
// Thread: thread-bound.
class InverseKinematics {
public:
    // `body` must live on.
    explicit InverseKinematics(const Body& body);

    // Moves `dofs` so that the joints come near to `places` (of each joint, metres, stage frame),
    // while `contacts` weigh so much more that they stay where they are. Ends after `steps`, or
    // when a step brings nothing. Gives the root mean square of the joints' distances, metres.
    double reach(std::span<double> dofs, std::span<const glm::dvec3> places, std::span<const HeldContact> contacts, int steps);
    // Brings the contacts to where they are held by as small a change of all else as it takes.
    // False: they cannot be reached within a fifth of a millimetre.
    bool hold(std::span<double> dofs, std::span<const HeldContact> contacts);

    const PosedBody& posed() const { return posed_; }  // in the degrees of freedom last given, as they were left

private:
    double objective(std::span<const glm::dvec3> places, std::span<const HeldContact> contacts) const;
    void linearise(std::span<const double> dofs, std::span<const glm::dvec3> places, std::span<const HeldContact> contacts);
    // Whether it went down.
    bool descend(std::span<double> dofs, std::span<const glm::dvec3> places, std::span<const HeldContact> contacts,
                 double damping);

    const Body& body_;
    PosedBody posed_;
    PoseEquations equations_;
    std::vector<double> trial_, best_;
};

}  // namespace fantascope::theatre
