#include "theatre/distance_field.h"

#include "masks.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::theatre {
namespace {

TEST(SignedDistance, IsToTheNearestPixelOfTheOtherColour) {
    Rng rng(1);
    for (const double white : {0.003, 0.5, 0.997}) {
        const BitMask mask = randomMask(rng, 70, 40, white);
        const GreyImage distance = signedDistance(mask);
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 70; ++x) {
                double least = 1e9;
                for (int v = 0; v < 40; ++v)
                    for (int u = 0; u < 70; ++u)
                        if (mask.at(u, v) != mask.at(x, y)) least = std::min(least, std::hypot(u - x, v - y));
                ASSERT_NEAR(distance.at(x, y), mask.at(x, y) ? least - 0.5 : 0.5 - least, 1e-4) << x << ", " << y;
            }
    }
}

TEST(SignedDistance, IsNoughtBetweenBlackAndWhite) {
    const GreyImage distance = signedDistance(maskOf({"...###"}));
    EXPECT_THAT(distance.pixels(), testing::ElementsAre(-2.5f, -1.5f, -0.5f, 0.5f, 1.5f, 2.5f));
}

}  // namespace
}  // namespace fantascope::theatre
