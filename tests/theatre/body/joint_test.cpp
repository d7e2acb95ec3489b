#include "theatre/body/joint.h"

#include "theatre/random_turns.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::theatre {
namespace {

using glm::dquat;
using glm::dvec3;
using std::numbers::pi;

constexpr dvec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

const dvec3 kSlanted = glm::normalize(dvec3(1, -2, 0.5));

// One of each kind, with axes and centres that no coordinate singles out.
std::vector<JointMotion> motions() {
    const dquat centre = rotationOf({0.4, -0.7, 0.2});
    return {JointMotion::axial(kSlanted, -0.3, 2.5), JointMotion::conic(kSlanted, centre, 0.6),
            JointMotion::conicAxial(kSlanted, centre, 1.9, -0.8, 1.1), JointMotion::spherical(centre, 2.0)};
}

// Numbers beyond the limits as well as within.
std::vector<double> anyNumbers(const JointMotion& motion, Rng& rng) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < motion.size(); ++i) numbers.push_back(rng.uniform(-3, 3));
    return numbers;
}

TEST(RotationVector, turns_by_its_length_about_its_direction) {
    EXPECT_LT(glm::distance(rotationOf(pi / 2 * kZ) * kX, kY), 1e-15);
    EXPECT_LT(glm::distance(rotationOf(2 * pi / 3 * glm::normalize(dvec3(1))) * kX, kY), 1e-15);
}

TEST(RotationVector, comes_back_from_its_rotation_near_none_and_near_a_half_turn) {
    const dvec3 direction = glm::normalize(dvec3(2, -1, 3));
    for (const double angle : {0.0, 1e-13, 1e-9, 0.99e-4, 1.01e-4, 0.5, pi - 1e-3, pi - 1e-9}) {
        EXPECT_LT(glm::distance(vectorOf(rotationOf(angle * direction)), angle * direction), 1e-12 + 1e-9 * angle) << angle;
        EXPECT_NEAR(glm::length(rotationOf(angle * direction)), 1, 1e-14) << angle;
    }
}

TEST(RotationVector, is_no_longer_than_a_half_turn) {
    const dvec3 direction = glm::normalize(dvec3(2, -1, 3));
    EXPECT_LT(glm::distance(vectorOf(rotationOf((pi + 0.5) * direction)), -(pi - 0.5) * direction), 1e-12);
    EXPECT_LT(glm::distance(vectorOf(rotationOf(2 * pi * direction)), dvec3(0)), 1e-12);
}

TEST(RotationVector, has_the_left_jacobian_that_a_change_adds_in_front) {
    Rng rng(1);
    const double step = 1e-6;
    for (const double size : {0.0, 1e-6, 0.9e-4, 1.2e-4, 0.1, 1.0, 2.5}) {
        const dvec3 vector = size * glm::normalize(randomVector(rng, 1)), change = glm::normalize(randomVector(rng, 1));
        const dquat before = rotationOf(vector - step * change), after = rotationOf(vector + step * change);
        const dvec3 added = vectorOf(after * glm::conjugate(before)) / (2 * step);
        EXPECT_LT(glm::distance(leftJacobian(vector, change), added), 1e-8) << size;
    }
}

TEST(JointLimit, measures_what_is_found_by_hand) {
    using Kind = JointLimit::Kind;
    // A third of a turn about y and then, in its frame, half a radian about the axis x.
    const dquat q = rotationOf(1.2 * kY) * rotationOf(0.5 * kX);
    EXPECT_NEAR((JointLimit{Kind::Axial, kX}.measure(q)), 0.5, 1e-12);
    EXPECT_NEAR((JointLimit{Kind::Conic, kX}.measure(q)), 1.2, 1e-12);
    EXPECT_NEAR((JointLimit{Kind::Spherical, kX}.measure(q)), 2 * std::acos(std::cos(0.6) * std::cos(0.25)), 1e-12);
    // From another centre, and turned the other way.
    EXPECT_NEAR((JointLimit{Kind::Axial, kX, rotationOf(0.7 * kX)}.measure(rotationOf(0.5 * kX))), -0.2, 1e-12);
    EXPECT_NEAR((JointLimit{Kind::Conic, kX, rotationOf(0.7 * kY)}.measure(rotationOf(0.5 * kY))), 0.2, 1e-12);
    EXPECT_NEAR((JointLimit{Kind::Spherical, kX, rotationOf(3.0 * kY)}.measure(rotationOf(-3.0 * kY))), 2 * pi - 6, 1e-12);
}

TEST(JointLimit, measures_a_cone_by_the_angle_by_which_the_axis_tips) {
    Rng rng(2);
    for (int i = 0; i < 200; ++i) {
        const dquat q = randomTurn(rng), centre = randomTurn(rng);
        const JointLimit limit{JointLimit::Kind::Conic, kSlanted, centre};
        EXPECT_NEAR(limit.measure(q), std::acos(glm::dot(q * kSlanted, centre * kSlanted)), 1e-7);
    }
}

TEST(JointLimit, measures_the_same_of_both_quaternions_of_an_orientation) {
    Rng rng(3);
    for (int i = 0; i < 200; ++i) {
        const dquat q = randomTurn(rng), centre = randomTurn(rng);
        for (const auto kind : {JointLimit::Kind::Axial, JointLimit::Kind::Conic, JointLimit::Kind::Spherical}) {
            const JointLimit limit{kind, kSlanted, centre};
            EXPECT_NEAR(limit.measure(q), limit.measure(-q), 1e-12);
            EXPECT_LE(std::abs(limit.measure(q)), pi);
        }
    }
}

TEST(JointMotion, is_within_the_measures_if_it_is_within_the_numbers) {
    Rng rng(4);
    for (const JointMotion& motion : motions())
        for (int i = 0; i < 200; ++i) {
            std::vector<double> numbers = anyNumbers(motion, rng);
            motion.limit(numbers);
            for (const JointLimit& limit : motion.limits()) {
                const double measure = limit.measure(motion.orientation(numbers));
                EXPECT_GE(measure, limit.low - 1e-9);
                EXPECT_LE(measure, limit.high + 1e-9);
            }
        }
}

TEST(JointMotion, limits_reach_their_bounds_and_leave_what_is_within) {
    for (const JointMotion& motion : motions()) {
        std::vector<double> far(motion.size(), 30.0), near(motion.size(), 0.01);
        motion.limit(far);
        double most = 0;
        for (const JointLimit& limit : motion.limits())
            if (limit.high > 0) most = std::max(most, limit.measure(motion.orientation(far)) / limit.high);
        EXPECT_NEAR(most, 1, 1e-9);
        const std::vector<double> before = near;
        motion.limit(near);
        EXPECT_EQ(near, before);
    }
}

TEST(JointMotion, numbers_come_back_from_their_orientation) {
    Rng rng(5);
    for (const JointMotion& motion : motions())
        for (int i = 0; i < 200; ++i) {
            std::vector<double> wanted = anyNumbers(motion, rng), got(motion.size());
            motion.limit(wanted);
            for (const double sign : {1.0, -1.0}) {
                motion.numbers(sign * motion.orientation(wanted), got);
                EXPECT_THAT(got, testing::Pointwise(testing::DoubleNear(1e-9), wanted));
            }
        }
}

TEST(JointMotion, numbers_of_any_orientation_are_within_the_limits) {
    Rng rng(6);
    for (const JointMotion& motion : motions())
        for (int i = 0; i < 200; ++i) {
            std::vector<double> numbers(motion.size());
            motion.numbers(randomTurn(rng), numbers);
            std::vector<double> limited = numbers;
            motion.limit(limited);
            EXPECT_THAT(limited, testing::Pointwise(testing::DoubleNear(1e-12), numbers));
        }
}

TEST(JointMotion, axes_are_what_a_number_turns_about) {
    Rng rng(7);
    const double step = 1e-6;
    for (const JointMotion& motion : motions())
        for (int i = 0; i < 50; ++i) {
            std::vector<double> numbers = anyNumbers(motion, rng);
            motion.limit(numbers);
            std::vector<dvec3> axes(motion.size());
            motion.axes(numbers, axes);
            for (std::size_t k = 0; k < motion.size(); ++k) {
                std::vector<double> before = numbers, after = numbers;
                before[k] -= step, after[k] += step;
                const dvec3 turned =
                    vectorOf(motion.orientation(after) * glm::conjugate(motion.orientation(before))) / (2 * step);
                EXPECT_LT(glm::distance(axes[k], turned), 1e-8);
            }
        }
}

}  // namespace
}  // namespace fantascope::theatre
