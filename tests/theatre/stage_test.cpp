#include "theatre/stage.h"

#include <gmock/gmock.h>

namespace fantascope::theatre {
namespace {

class OfAStage : public testing::Test {
protected:
    const Stage stage{{0.5, 1, 7}};
    // 2 cm a pixel; the picture's top left corner at (-1, 3).
    const ScreenFrame frame{stage, -1, 3, 0.02, 200, 150};
};

TEST_F(OfAStage, PixelsAndMetresOfTheScreen) {
    EXPECT_LT(glm::distance(frame.pixelAt(-1, 3), glm::dvec2(0, 0)), 1e-9);
    EXPECT_LT(glm::distance(frame.pixelAt(0, 2.5), glm::dvec2(50, 25)), 1e-9);
    EXPECT_LT(glm::distance(frame.metresAt({50, 25}), glm::dvec2(0, 2.5)), 1e-12);
}

TEST_F(OfAStage, WhatIsOnTheScreenIsItsOwnShadow) {
    EXPECT_LT(glm::distance(frame.shadow({0.3, 1.7, 0}), frame.pixelAt(0.3, 1.7)), 1e-9);
}

// Halfway to the light everything is twice as far from the light's foot.
TEST_F(OfAStage, ShadowsGrowTowardsTheLight) {
    EXPECT_LT(glm::distance(frame.shadow({0.7, 1.3, 3.5}), frame.pixelAt(0.9, 1.6)), 1e-9);
    EXPECT_LT(glm::distance(frame.shadow({0.5, 1, 3}), frame.pixelAt(0.5, 1)), 1e-9);
}

TEST_F(OfAStage, IsAPinholeCamera) {
    const glm::dvec3 point(1.1, 0.2, 2), d = frame.fromLight(point);
    EXPECT_LT(glm::distance(d, glm::dvec3(0.6, 0.8, 5)), 1e-12);
    EXPECT_LT(glm::distance(frame.foot(), frame.pixelAt(0.5, 1)), 1e-9);
    EXPECT_DOUBLE_EQ(frame.focus(), 350);
    EXPECT_LT(glm::distance(frame.foot() + frame.focus() / d.z * glm::dvec2(d), frame.shadow(point)), 1e-9);
}

}  // namespace
}  // namespace fantascope::theatre
