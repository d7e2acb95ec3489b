#pragma once

#include "theatre/body/posed_body.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The normal equations of a least-squares problem over one actor's degrees of freedom: sum over
// residuals e of weight * e^2, each linear in small changes. The derivative of a point by a degree
// of freedom above it is the product of two spatial vectors (Featherstone 2008, chapter 2). So the
// residuals of all points of a joint add up to one 6 x 6 matrix, and the matrices along a chain add
// up towards the root.
// Thread: thread-bound.
class PoseEquations {
public:
    explicit PoseEquations(const Body& body);

    // Discards all residuals. `dofs`: the pose around which residuals are linearised; `posed` is
    // the body in that pose.
    void begin(const PosedBody& posed, std::span<const double> dofs);
    // Adds a residual that grows by direction.dx when `point`, fixed to `joint`, moves by dx. Stage
    // frame, metres.
    void addPoint(std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction, double residual, double weight);
    // Adds three residuals: the offset of `point` from its wanted place, along x, y and z.
    void addPlace(std::size_t joint, const glm::dvec3& point, const glm::dvec3& off, double weight);
    // Adds three residuals: the rotation vector from a segment's wanted rotation to its own, in the
    // stage's frame.
    void addTurn(std::size_t joint, const glm::dvec3& off, double weight);
    // The same for the rotation relative to its parent: only the joint's own degrees of freedom
    // count. `off` is in the stage's frame, too.
    void addBend(std::size_t joint, const glm::dvec3& off, double weight);
    // Adds a residual that depends on two points of the body.
    void addPoints(std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction, std::size_t otherJoint,
                   const glm::dvec3& otherPoint, const glm::dvec3& otherDirection, double residual, double weight);
    // Adds a residual whose derivative by each degree of freedom is `row`. addMotion() adds to
    // `row` the derivative of a point's movement along `direction`.
    void addRow(const Eigen::VectorXd& row, double residual, double weight);
    void addMotion(Eigen::VectorXd& row, std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction) const;

    // Sums up the residuals. After it, step() may be called with any damping.
    void finish();
    // Levenberg's step, with the degrees of freedom in units of Body::scaleOf(). Marquardt's
    // damping by the diagonal would move those most that hardly matter. `damping`: 1 is the mean
    // stiffness of the residuals. `moves`: for each degree of freedom whether it may change; empty:
    // all may.
    const Eigen::VectorXd& step(double damping, std::span<const char> moves);

private:
    using Spatial = Eigen::Matrix<double, 6, 1>;
    using Spatials = Eigen::Matrix<double, 6, 6>;

    static Spatial spatial(const glm::dvec3& point, const glm::dvec3& direction);

    const Body& body_;
    std::vector<std::size_t> jointOf_;  // of each degree of freedom
    std::vector<std::uint64_t> above_;  // of each joint: itself and its ancestors, as bits
    std::vector<glm::dvec3> axes_;
    std::vector<Spatial> screws_;  // of each degree of freedom: its spatial velocity
    std::vector<Spatials> squares_;
    std::vector<Spatial> pulls_;  // of each joint
    Eigen::MatrixXd hessian_, damped_;
    Eigen::VectorXd gradient_, row_, step_;
};

}  // namespace fantascope::theatre
