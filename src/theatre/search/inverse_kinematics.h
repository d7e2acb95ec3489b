#pragma once

#include "theatre/body/pose_equations.h"
#include "theatre/stage/continuity.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// Inverse kinematics: a body's pose from the wanted places of its joints, by steps of the damped
// Jacobian pseudo-inverse with a line search (Won & Lee 2016, section 5, Algorithm 1, line 8).
// Thread: thread-bound.
class InverseKinematics {
public:
    // `body` must outlive this object.
    explicit InverseKinematics(const Body& body);

    // Changes `dofs` so that the joints come near to `places` (one for each joint, metres, stage
    // frame). `contacts` weigh so much more that they stay where they are. Stops after `steps`
    // iterations, or when a step brings no improvement. Gives the root mean square distance of the
    // joints, metres.
    double reach(std::span<double> dofs, std::span<const glm::dvec3> places, std::span<const HeldContact> contacts, int steps);
    // Brings the contacts to where they are held, with the smallest change of the rest.
    // False: they cannot be reached to within 0.2 mm.
    bool hold(std::span<double> dofs, std::span<const HeldContact> contacts);

    const PosedBody& posed() const { return posed_; }  // in the resulting degrees of freedom of the last call

private:
    double objective(std::span<const glm::dvec3> places, std::span<const HeldContact> contacts) const;
    void linearise(std::span<const double> dofs, std::span<const glm::dvec3> places, std::span<const HeldContact> contacts);
    // Makes one step; whether the objective fell.
    bool descend(std::span<double> dofs, std::span<const glm::dvec3> places, std::span<const HeldContact> contacts,
                 double damping);

    const Body& body_;
    PosedBody posed_;
    PoseEquations equations_;
    std::vector<double> trial_, best_;
};

}  // namespace fantascope::theatre
