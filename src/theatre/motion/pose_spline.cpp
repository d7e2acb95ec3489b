#include "theatre/motion/pose_spline.h"

#include "theatre/body/balance.h"

#include "core/check.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

constexpr double kOnePlace = 0.02;  // metres: a contact that moves no farther between two frames has not taken a step

// The logarithm of a unit quaternion: half its rotation vector. The side of the double cover is
// kept.
glm::dvec3 halfVector(const glm::dquat& q) {
    const glm::dvec3 vector(q.x, q.y, q.z);
    const double sine = glm::length(vector);
    return sine < 1e-12 ? glm::dvec3(0) : std::atan2(sine, q.w) / sine * vector;
}

// Spherical interpolation (slerp). The side of the double cover is kept.
glm::dquat arc(const glm::dquat& from, const glm::dquat& to, double t) {
    return from * rotationOf(2 * t * halfVector(glm::conjugate(from) * to));
}

glm::dquat near(const glm::dquat& turn, const glm::dquat& to) { return glm::dot(turn, to) < 0 ? -turn : turn; }

}  // namespace

PoseSpline::PoseSpline(const Body& body, const Stage& stage, std::vector<ActorPose> frames, bool loops)
    : body_(body), frames_(std::move(frames)), loops_(loops), kinematics_(body) {
    FANTASCOPE_CHECK(!frames_.empty(), "a motion has a frame");
    for (std::size_t i = 1; i < frames_.size(); ++i)
        for (std::size_t k = 0; k < frames_[i].turns.size(); ++k)
            frames_[i].turns[k] = near(frames_[i].turns[k], frames_[i - 1].turns[k]);
    PosedBody posed;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
        const ActorPose& here = frames_[i];
        std::vector<glm::dquat>& tangents = tangents_.emplace_back();
        for (std::size_t k = 0; k < here.turns.size(); ++k) {
            const glm::dquat turn = here.turns[k], back = glm::conjugate(turn);
            const glm::dvec3 on = halfVector(back * near(frames_[next(i)].turns[k], turn));
            const glm::dvec3 from = halfVector(back * near(frames_[before(i)].turns[k], turn));
            tangents.push_back(turn * rotationOf(-0.5 * (on + from)));
        }
        posed.pose(body, dofsOf(body, here));
        bearing_.push_back(bearingParts(body, stage, posed));
    }
}

std::size_t PoseSpline::next(std::size_t frame) const { return frame + 1 < frames_.size() ? frame + 1 : loops_ ? 0 : frame; }

std::size_t PoseSpline::before(std::size_t frame) const { return frame > 0 ? frame - 1 : loops_ ? frames_.size() - 1 : 0; }

const std::vector<double>& PoseSpline::at(double frame) {
    const auto count = static_cast<double>(frames_.size());
    frame = loops_ ? frame - count * std::floor(frame / count) : std::clamp(frame, 0.0, count - 1);
    const auto i = std::min(static_cast<std::size_t>(frame), frames_.size() - 1);
    const double t = frame - static_cast<double>(i);
    const std::size_t j = next(i);
    const ActorPose &here = frames_[i], &there = frames_[j];
    const glm::dvec3 leaving = 0.5 * (there.root - frames_[before(i)].root), arriving = 0.5 * (frames_[next(j)].root - here.root);
    const double u = 1 - t;
    pose_.root = u * u * (1 + 2 * t) * here.root + t * t * (3 - 2 * t) * there.root + t * u * (u * leaving - t * arriving);
    pose_.turns.clear();
    for (std::size_t k = 0; k < here.turns.size(); ++k) {
        const glm::dquat turn = near(there.turns[k], here.turns[k]);
        const glm::dquat inner = turn == there.turns[k] ? tangents_[j][k] : -tangents_[j][k];
        pose_.turns.push_back(arc(arc(here.turns[k], turn, t), arc(tangents_[i][k], inner, t), 2 * t * u));
    }
    dofsOf(body_, pose_, dofs_);
    held_.clear();
    for (const HeldContact& from : bearing_[i])
        for (const HeldContact& to : bearing_[j])
            if (from.joint == to.joint && glm::distance(from.place, to.place) <= kOnePlace)
                held_.push_back({from.joint, glm::mix(from.place, to.place, t), arc(from.turn, near(to.turn, from.turn), t)});
    if (t > 0) kinematics_.hold(dofs_, held_);
    return dofs_;
}

}  // namespace fantascope::theatre
