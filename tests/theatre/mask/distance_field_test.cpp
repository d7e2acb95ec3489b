#include "theatre/mask/distance_field.h"

#include "theatre/masks.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::theatre {
namespace {

TEST(SignedDistance, is_to_the_nearest_pixel_of_the_other_colour) {
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

TEST(SignedDistance, is_nought_between_black_and_white) {
    const GreyImage distance = signedDistance(maskOf({"...###"}));
    EXPECT_THAT(distance.pixels(), testing::ElementsAre(-2.5f, -1.5f, -0.5f, 0.5f, 1.5f, 2.5f));
}

TEST(DeeperThan, shrinks_and_grows) {
    const BitMask block = drawn(60, 50, [](int x, int y) { return x >= 20 && x < 40 && y >= 15 && y < 35; });
    const GreyImage distance = signedDistance(block);
    EXPECT_EQ(deeperThan(distance, 0), block);
    EXPECT_EQ(deeperThan(distance, 3), drawn(60, 50, [](int x, int y) { return x >= 23 && x < 37 && y >= 18 && y < 32; }));
    const BitMask grown = deeperThan(distance, -3);
    EXPECT_TRUE(grown.at(17, 25) && grown.at(30, 12));
    EXPECT_FALSE(grown.at(16, 25) || grown.at(17, 12)) << "round at the corners";
}

}  // namespace
}  // namespace fantascope::theatre
