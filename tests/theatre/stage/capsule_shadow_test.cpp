#include "theatre/stage/capsule_shadow.h"

#include "theatre/a_stage.h"
#include "theatre/mask/contour.h"
#include "theatre/random_turns.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

// The light 7 m in front of a screen of 6 m x 4 m, of which a pixel is 1 cm.
const Stage kStage = aStage({0, 0, 7});
ScreenFrame frameOf() { return ScreenFrame(kStage, -3, 4, 0.01, 600, 400); }

PlacedCapsule capsule(dvec3 from, double fromRadius, dvec3 to, double toRadius) { return {{from, fromRadius}, {to, toRadius}}; }
BitMask shadowOf(const PlacedCapsule& capsule) {
    BitMask mask(600, 400);
    EXPECT_TRUE(CapsuleShadow().add(frameOf(), capsule, mask));
    return mask;
}

// The pixels whose ray from the light meets one of the spheres along the capsule: how far it passes
// by them is convex along the axis.
BitMask rayTraced(const PlacedCapsule& c) {
    const ScreenFrame frame = frameOf();
    BitMask mask(600, 400);
    for (int y = 0; y < 400; ++y)
        for (int x = 0; x < 600; ++x) {
            const dvec3 ray = glm::normalize(dvec3(frame.metresAt({x + 0.5, y + 0.5}), 0) - kStage.beams[0].light);
            const auto passesBy = [&](double t) {
                const dvec3 fromLight = glm::mix(c.from, c.to, t) - kStage.beams[0].light;
                return glm::length(glm::cross(fromLight, ray)) - std::lerp(c.fromRadius, c.toRadius, t);
            };
            double low = 0, high = 1;
            for (int i = 0; i < 40; ++i) {
                const double third = (high - low) / 3;
                if (passesBy(low + third) < passesBy(high - third))
                    high -= third;
                else
                    low += third;
            }
            if (passesBy(0.5 * (low + high)) <= 0) mask.fill(y, x, x + 1);
        }
    return mask;
}
// But for pixels whose centres the outline just misses.
void expectLikeRays(const PlacedCapsule& c) {
    const BitMask got = shadowOf(c), wanted = rayTraced(c);
    Contour outline;
    outline.find(wanted);
    EXPECT_LE(differing(got, wanted), outline.pixels().count() / 50 + 2);
}

struct Extent {
    double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
};
Extent extentOf(const BitMask& mask) {
    Extent e;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (mask.at(x, y))
                e.left = std::min(e.left, x + 0.0), e.right = std::max(e.right, x + 1.0), e.top = std::min(e.top, y + 0.0),
                e.bottom = std::max(e.bottom, y + 1.0);
    return e;
}

// A ball in the light's axis throws a circle of radius L r / sqrt(d^2 - r^2), more than L r / d.
TEST(CapsuleShadow, of_a_ball_before_the_foot_is_a_circle) {
    const Stage stage = aStage({0, 2, 7});
    const ScreenFrame frame(stage, -3, 4, 0.01, 600, 400);
    BitMask mask(600, 400);
    const double r = 0.5, d = 2;
    ASSERT_TRUE(CapsuleShadow().add(frame, capsule({0, 2, 7 - d}, r, {0, 2, 7 - d}, r), mask));
    const double radius = 700 * r / std::sqrt(d * d - r * r);
    const Extent e = extentOf(mask);
    EXPECT_NEAR(e.left, 300 - radius, 1.5);
    EXPECT_NEAR(e.right, 300 + radius, 1.5);
    EXPECT_NEAR(e.top, 200 - radius, 1.5);
    EXPECT_NEAR(e.bottom, 200 + radius, 1.5);
    EXPECT_NEAR(static_cast<double>(mask.count()), std::numbers::pi * radius * radius, 0.002 * radius * radius);
}

// Off the axis it is an ellipse, stretched away from the foot: its ends along y are at L tan(a +-
// b), with sin b = r / distance.
TEST(CapsuleShadow, of_a_ball_above_the_foot_is_an_ellipse) {
    const double y = 1.5, d = 4, r = 0.4, a = std::atan2(y, d), b = std::asin(r / std::hypot(y, d));
    const BitMask mask = shadowOf(capsule({0, y, 7 - d}, r, {0, y, 7 - d}, r));
    const Extent e = extentOf(mask);
    EXPECT_NEAR(400 - e.bottom, 700 * std::tan(a - b), 1.5);
    EXPECT_NEAR(400 - e.top, 700 * std::tan(a + b), 1.5);
    EXPECT_NEAR(e.left + e.right, 600, 1);
    // Half the width across: r L / sqrt(d^2 - r^2).
    EXPECT_NEAR(0.5 * (e.right - e.left), 700 * r / std::sqrt(d * d - r * r), 1.5);
}

TEST(CapsuleShadow, is_what_rays_meet) {
    expectLikeRays(capsule({0.3, 1.2, 2}, 0.3, {0.3, 1.2, 2}, 0.3));
    expectLikeRays(capsule({-0.5, 0.5, 1}, 0.05, {0.7, 1.5, 3.5}, 0.25));
    // Towards the light, one end hiding the other.
    expectLikeRays(capsule({0.2, 0.6, 1}, 0.3, {0.2, 0.8, 3}, 0.1));
    // Partly beyond each edge of the picture.
    expectLikeRays(capsule({1.2, 0.2, 2}, 0.2, {2.5, -0.3, 3}, 0.3));
    expectLikeRays(capsule({-2, 1.8, 3}, 0.2, {-1, 2.8, 3}, 0.1));
    Rng rng(1);
    for (int i = 0; i < 4; ++i)
        expectLikeRays(capsule(dvec3(0, 1.2, 2) + randomVector(rng, 1), rng.uniform(0.03, 0.3),
                               dvec3(0, 1.2, 2) + randomVector(rng, 1), rng.uniform(0.03, 0.3)));
}

TEST(CapsuleShadow, is_the_same_from_either_end) {
    const dvec3 from(-0.5, 0.5, 1), to(0.7, 1.5, 3.5);
    EXPECT_EQ(shadowOf(capsule(from, 0.05, to, 0.25)), shadowOf(capsule(to, 0.25, from, 0.05)));
}

TEST(CapsuleShadow, reaching_the_light_it_throws_none) {
    BitMask mask(600, 400);
    for (const double z : {6.8, 7.0, 9.0})
        for (const bool isSwapped : {false, true}) {
            const dvec3 far(0, 1, 2), near(0, 1, z);
            EXPECT_FALSE(
                CapsuleShadow().add(frameOf(), isSwapped ? capsule(near, 0.2, far, 0.2) : capsule(far, 0.2, near, 0.2), mask));
        }
    EXPECT_EQ(mask.count(), 0);
}

TEST(CapsuleShadow, outside_the_picture_nothing_is_added) {
    for (const dvec3 place : {dvec3(8, 1, 2), {-8, 1, 2}, {0, 9, 2}, {0, -9, 2}})
        EXPECT_EQ(shadowOf(capsule(place, 0.2, place, 0.2)).count(), 0);
}

TEST(CapsuleShadow, adds_to_what_is_there) {
    BitMask mask(600, 400);
    mask.fill(5, 0, 600);
    ASSERT_TRUE(CapsuleShadow().add(frameOf(), capsule({0, 1, 2}, 0.2, {0, 1, 2}, 0.2), mask));
    EXPECT_EQ(mask.count(), 600 + shadowOf(capsule({0, 1, 2}, 0.2, {0, 1, 2}, 0.2)).count());
}

}  // namespace
}  // namespace fantascope::theatre
