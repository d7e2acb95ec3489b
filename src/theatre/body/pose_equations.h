#pragma once

#include "theatre/body/posed_body.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The normal equations of a least-squares problem over one actor's degrees of freedom: sum over
// residuals e of weight * e^2, each linear in small changes. How a point of a joint moves with the
// degrees of freedom of the joints above it is the product of two spatial vectors (Featherstone
// 2008, chapter 2): what is asked of all points of a joint adds up to a 6 x 6 matrix, and the
// matrices of a chain to those above it.
// Thread: thread-bound.
class PoseEquations {
public:
    explicit PoseEquations(const Body& body);

    // Forgets all residuals; `dofs`: the pose around which they will be linear, `posed` in it.
    void begin(const PosedBody& posed, std::span<const double> dofs);
    // A residual that grows by direction.dx when `point`, fixed to `joint`, moves by dx; stage
    // frame, metres.
    void addPoint(std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction, double residual, double weight);
    // Three: how far `point` is off from where it is to be, along x, y and z.
    void addPlace(std::size_t joint, const glm::dvec3& point, const glm::dvec3& off, double weight);
    // Three: how a joint's segment is turned off from how it is to be in the stage's frame, a
    // rotation vector.
    void addTurn(std::size_t joint, const glm::dvec3& off, double weight);
    // The same of how it is turned against its parent, by the joint's own degrees of freedom alone;
    // `off` in the stage's frame, too.
    void addBend(std::size_t joint, const glm::dvec3& off, double weight);
    // One that depends on two points of the body.
    void addPoints(std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction, std::size_t otherJoint,
                   const glm::dvec3& otherPoint, const glm::dvec3& otherDirection, double residual, double weight);
    // One whose derivative by each degree of freedom is `row`; addMotion() adds to it what one of
    // the points above would.
    void addRow(const Eigen::VectorXd& row, double residual, double weight);
    void addMotion(Eigen::VectorXd& row, std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction) const;

    // Sums up what was added; the step is then to be asked for, with any damping.
    void finish();
    // The step of Levenberg, with the degrees of freedom measured in Body::scaleOf(): damping each
    // by its own diagonal, as Marquardt has it, would make those move most that hardly matter.
    // `damping`: 1 is as stiff as the residuals are on average. `moves`: for each degree of freedom
    // whether it may change; empty: all may.
    const Eigen::VectorXd& step(double damping, std::span<const char> moves);

private:
    using Spatial = Eigen::Matrix<double, 6, 1>;
    using Spatials = Eigen::Matrix<double, 6, 6>;

    static Spatial spatial(const glm::dvec3& point, const glm::dvec3& direction);

    const Body& body_;
    std::vector<std::size_t> jointOf_;  // of each degree of freedom
    std::vector<std::uint64_t> above_;  // of each joint: itself and those above it, as bits
    std::vector<glm::dvec3> axes_;
    std::vector<Spatial> screws_;  // of each degree of freedom: how space moves with it
    std::vector<Spatials> squares_;
    std::vector<Spatial> pulls_;  // of each joint
    Eigen::MatrixXd hessian_, damped_;
    Eigen::VectorXd gradient_, row_, step_;
};

}  // namespace fantascope::theatre
