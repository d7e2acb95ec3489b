#include "theatre/search/inverse_kinematics.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

// Weights relative to the joints' squared metres: of a contact's place; and of its rotation,
// measured a foot's length away.
constexpr double kHeldPlace = 1000, kHeldTurn = 20;
constexpr double kReachDamping = 0.02, kHoldDamping = 1e-4, kMostDamping = 10;
constexpr double kHeld = 0.0002;   // metres, and radians a tenth of a metre away
constexpr double kSettled = 1e-5;  // the least relative decrease of the objective by a step
constexpr int kHoldSteps = 12;
constexpr double kLever = 0.1;  // metres

}  // namespace

InverseKinematics::InverseKinematics(const Body& body) : body_(body), equations_(body) {}

double InverseKinematics::reach(std::span<double> dofs, std::span<const glm::dvec3> places, std::span<const HeldContact> contacts,
                                int steps) {
    posed_.pose(body_, dofs);
    double damping = kReachDamping;
    for (int i = 0; i < steps && damping <= kMostDamping; ++i)
        damping = descend(dofs, places, contacts, damping) ? std::max(kHoldDamping, damping / 2) : 10 * damping;
    double sum = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 off = posed_.place(i) - places[i];
        sum += glm::dot(off, off);
    }
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, places.size())));
}

bool InverseKinematics::hold(std::span<double> dofs, std::span<const HeldContact> contacts) {
    posed_.pose(body_, dofs);
    const auto isHeld = [&] {
        return std::all_of(contacts.begin(), contacts.end(), [&](const HeldContact& contact) {
            return glm::distance(posed_.place(contact.joint), contact.place) <= kHeld &&
                   glm::length(turnBetween(contact.turn, posed_.turn(contact.joint))) <= kHeld / kLever;
        });
    };
    for (int i = 0; i < kHoldSteps && !isHeld() && descend(dofs, {}, contacts, kHoldDamping); ++i) {
    }
    return isHeld();
}

double InverseKinematics::objective(std::span<const glm::dvec3> places, std::span<const HeldContact> contacts) const {
    double sum = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 off = posed_.place(i) - places[i];
        sum += glm::dot(off, off);
    }
    for (const HeldContact& contact : contacts) {
        const glm::dvec3 off = posed_.place(contact.joint) - contact.place;
        const glm::dvec3 turned = turnBetween(contact.turn, posed_.turn(contact.joint));
        sum += kHeldPlace * glm::dot(off, off) + kHeldTurn * glm::dot(turned, turned);
    }
    return sum;
}

void InverseKinematics::linearise(std::span<const double> dofs, std::span<const glm::dvec3> places,
                                  std::span<const HeldContact> contacts) {
    equations_.begin(posed_, dofs);
    for (std::size_t i = 0; i < places.size(); ++i) equations_.addPlace(i, posed_.place(i), posed_.place(i) - places[i], 1);
    for (const HeldContact& contact : contacts) {
        const glm::dvec3& place = posed_.place(contact.joint);
        equations_.addPlace(contact.joint, place, place - contact.place, kHeldPlace);
        equations_.addTurn(contact.joint, turnBetween(contact.turn, posed_.turn(contact.joint)), kHeldTurn);
    }
    equations_.finish();
}

bool InverseKinematics::descend(std::span<double> dofs, std::span<const glm::dvec3> places, std::span<const HeldContact> contacts,
                                double damping) {
    const double before = objective(places, contacts);
    linearise(dofs, places, contacts);
    const Eigen::VectorXd& step = equations_.step(damping, {});
    best_.assign(dofs.begin(), dofs.end());
    double least = before;
    // The joint limits make the objective along the line non-smooth, so it is sampled at a few
    // lengths rather than fitted.
    for (const double length : {1.5, 1.0, 0.6, 0.3, 0.1, 0.02}) {
        trial_.assign(dofs.begin(), dofs.end());
        for (std::size_t k = 0; k < trial_.size(); ++k) trial_[k] += length * step[static_cast<Eigen::Index>(k)];
        body_.limit(trial_);
        posed_.pose(body_, trial_);
        if (const double now = objective(places, contacts); now < least)
            least = now, std::swap(best_, trial_);
        else if (least < before)
            break;  // past the minimum
    }
    std::copy(best_.begin(), best_.end(), dofs.begin());
    posed_.pose(body_, dofs);
    return least < (1 - kSettled) * before;
}

}  // namespace fantascope::theatre
