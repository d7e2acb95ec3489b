#include "theatre/body/pose_equations.h"

#include <Eigen/Cholesky>
#include <glm/geometric.hpp>

namespace fantascope::theatre {
namespace {

double square(double x) { return x * x; }
double scaleOf(Eigen::Index dof) { return Body::scaleOf(static_cast<std::size_t>(dof)); }

}  // namespace

PoseEquations::PoseEquations(const Body& body)
    : body_(body),
      jointOf_(body.dofs, 0),
      above_(body.joints.size(), 1),
      axes_(body.dofs),
      screws_(body.dofs),
      squares_(body.joints.size()),
      pulls_(body.joints.size()) {
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        for (std::size_t k = 0; k < body.joints[i].motion.size(); ++k) jointOf_[body.joints[i].first + k] = i;
        above_[i] = above_[body.joints[i].parent] | std::uint64_t{1} << i;
    }
    const auto size = static_cast<Eigen::Index>(body.dofs);
    hessian_.resize(size, size);
    damped_.resize(size, size);
    for (Eigen::VectorXd* vector : {&gradient_, &row_, &step_}) vector->resize(size);
}

void PoseEquations::begin(const PosedBody& posed, std::span<const double> dofs) {
    posed.axes(body_, dofs, axes_);
    for (std::size_t k = 0; k < screws_.size(); ++k) {
        const glm::dvec3 turn = k < 3 ? glm::dvec3(0) : axes_[k];
        const glm::dvec3 shift = k < 3 ? axes_[k] : glm::cross(posed.place(jointOf_[k]), axes_[k]);
        screws_[k] << shift.x, shift.y, shift.z, turn.x, turn.y, turn.z;
    }
    for (Spatials& square : squares_) square.setZero();
    for (Spatial& pull : pulls_) pull.setZero();
    hessian_.setZero();
    gradient_.setZero();
}

PoseEquations::Spatial PoseEquations::spatial(const glm::dvec3& point, const glm::dvec3& direction) {
    const glm::dvec3 moment = glm::cross(point, direction);
    return (Spatial() << direction.x, direction.y, direction.z, moment.x, moment.y, moment.z).finished();
}

void PoseEquations::addPoint(std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction, double residual,
                             double weight) {
    const Spatial asked = spatial(point, direction);
    squares_[joint].noalias() += weight * asked * asked.transpose();
    pulls_[joint] += weight * residual * asked;
}

void PoseEquations::addPlace(std::size_t joint, const glm::dvec3& point, const glm::dvec3& off, double weight) {
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 unit(0);
        unit[axis] = 1;
        addPoint(joint, point, unit, off[axis], weight);
    }
}

// A rotation is the moment part of a spatial vector. The rotation vector's Jacobian is taken as the
// identity. The gradient stays exact, since only rotation about the vector itself changes its
// length.
void PoseEquations::addTurn(std::size_t joint, const glm::dvec3& off, double weight) {
    for (int axis = 0; axis < 3; ++axis) {
        squares_[joint](3 + axis, 3 + axis) += weight;
        pulls_[joint][3 + axis] += weight * off[axis];
    }
}

void PoseEquations::addBend(std::size_t joint, const glm::dvec3& off, double weight) {
    const std::size_t first = joint == 0 ? 3 : body_.joints[joint].first;
    const std::size_t count = joint == 0 ? 3 : body_.joints[joint].motion.size();
    for (std::size_t k = first; k < first + count; ++k) {
        gradient_[static_cast<Eigen::Index>(k)] += weight * glm::dot(axes_[k], off);
        for (std::size_t l = first; l <= k; ++l)
            hessian_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) += weight * glm::dot(axes_[k], axes_[l]);
    }
}

void PoseEquations::addMotion(Eigen::VectorXd& row, std::size_t joint, const glm::dvec3& point,
                              const glm::dvec3& direction) const {
    const Spatial asked = spatial(point, direction);
    for (std::size_t k = 0; k < screws_.size(); ++k)
        if ((above_[joint] >> jointOf_[k] & 1) != 0) row[static_cast<Eigen::Index>(k)] += screws_[k].dot(asked);
}

void PoseEquations::addPoints(std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction, std::size_t otherJoint,
                              const glm::dvec3& otherPoint, const glm::dvec3& otherDirection, double residual, double weight) {
    row_.setZero();
    addMotion(row_, joint, point, direction);
    addMotion(row_, otherJoint, otherPoint, otherDirection);
    addRow(row_, residual, weight);
}

void PoseEquations::addRow(const Eigen::VectorXd& row, double residual, double weight) {
    hessian_.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    gradient_ += weight * residual * row;
}

void PoseEquations::finish() {
    for (std::size_t i = body_.joints.size() - 1; i > 0; --i) {
        squares_[body_.joints[i].parent] += squares_[i];
        pulls_[body_.joints[i].parent] += pulls_[i];
    }
    // Two degrees of freedom are coupled only if one joint is above the other: both move everything
    // that hangs on the lower one.
    for (std::size_t k = 0; k < screws_.size(); ++k) {
        const std::size_t joint = jointOf_[k];
        const Spatial asked = squares_[joint] * screws_[k];
        gradient_[static_cast<Eigen::Index>(k)] += screws_[k].dot(pulls_[joint]);
        for (std::size_t l = 0; l <= k; ++l)
            if ((above_[joint] >> jointOf_[l] & 1) != 0)
                hessian_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) += screws_[l].dot(asked);
    }
}

const Eigen::VectorXd& PoseEquations::step(double damping, std::span<const char> moves) {
    damped_ = hessian_;
    step_ = -gradient_;
    double stiffness = 0;
    for (Eigen::Index k = 0; k < step_.size(); ++k) stiffness += hessian_(k, k) * square(scaleOf(k)) / double(step_.size());
    for (Eigen::Index k = 0; k < step_.size(); ++k) damped_(k, k) += damping * stiffness / square(scaleOf(k)) + 1e-9;
    for (std::size_t i = 0; i < moves.size(); ++i) {
        if (moves[i] != 0) continue;
        const auto k = static_cast<Eigen::Index>(i);
        damped_.row(k).setZero();
        damped_.col(k).setZero();
        damped_(k, k) = 1;
        step_[k] = 0;
    }
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factors(damped_);  // in place
    if (factors.info() == Eigen::Success)
        factors.solveInPlace(step_);
    else
        step_.setZero();  // rounding made the matrix indefinite; the caller will ask for more damping
    return step_;
}

}  // namespace fantascope::theatre
