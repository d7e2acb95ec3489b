#include "render/source/penumbra.h"

#include "core/geometry.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::render {
namespace {

struct Moments {
    double sum = 0, x = 0, y = 0, variance = 0;  // about the middle; variance along one axis
};
Moments momentsOf(const GreyImage& filter) {
    Moments moments;
    for (int y = 0; y < filter.height(); ++y)
        for (int x = 0; x < filter.width(); ++x) {
            const double value = filter.at(x, y), right = x + 0.5 - filter.width() / 2.0, down = y + 0.5 - filter.height() / 2.0;
            moments.sum += value;
            moments.x += value * right;
            moments.y += value * down;
            moments.variance += value * (right * right + down * down) / 2;
        }
    return moments;
}

// The sun's distance is 108 times its diameter.
// Example failure: a blur of twice the width, because the paper's formula is taken for the radius.
TEST(Penumbra, is_as_wide_as_the_suns_picture_behind_a_pinhole) {
    EXPECT_NEAR(penumbraWidth(10, radians(0.53)), 10.0 / 108, 0.001);
    EXPECT_EQ(penumbraWidth(0, radians(0.53)), 0);
}

// A disc of diameter D has a variance of D^2 / 16 along each axis; square pixels add 1/12.
TEST(DiscFilter, has_the_size_that_was_asked_for) {
    for (double diameter = 6; diameter < 90; diameter += 0.7) {
        const GreyImage disc = discFilter(diameter);
        const Moments moments = momentsOf(disc);
        ASSERT_EQ(disc.width() % 2, 1);
        ASSERT_NEAR(moments.sum, 1, 1e-5);
        ASSERT_NEAR(moments.x, 0, 1e-4);
        const double wanted = diameter * diameter / 16 + 1.0 / 12;
        ASSERT_NEAR(moments.variance, wanted, 0.02 * wanted) << diameter;
    }
    EXPECT_EQ(discFilter(0), GreyImage(1, 1, 1.0f));
    EXPECT_EQ(discFilter(1), GreyImage(1, 1, 1.0f));
}

TEST(PictureFilter, keeps_the_pictures_middle_its_proportions_and_its_light) {
    GreyImage picture(40, 20);
    picture.at(0, 0) = picture.at(39, 19) = 1;  // two opposite corners
    for (const double width : {0.5, 3.0, 8.4, 40.0, 123.0}) {
        const GreyImage filter = pictureFilter(picture, width);
        const Moments moments = momentsOf(filter);
        EXPECT_NEAR(moments.sum, 1, 1e-5);
        EXPECT_NEAR(moments.x, 0, 1e-4);
        EXPECT_NEAR(moments.y, 0, 1e-4);
        EXPECT_LE(std::abs(filter.height() - width / 2), 2);
        EXPECT_LE(std::abs(filter.width() - width), 2);
        if (width > 8) {
            EXPECT_GT(filter.at(0, 0), filter.at(filter.width() - 1, 0)) << "top left, not top right";
        }
    }
}

// For every blur the grid is fine enough, but not much finer than necessary, which bounds the cost.
TEST(BlurGrid, grows_with_the_blur) {
    constexpr double kAspect = 16.0 / 9, kRows = 360;
    for (double radius = 0.5; radius < 300; radius *= 1.1) {
        const BlurGrid grid = BlurGrid::forFilter({2 * radius / kRows, nullptr}, kAspect, kRows);
        const double onGrid = radius / kRows / grid.pitch;
        EXPECT_LT(onGrid, 4 * BlurGrid::kMinRadius);
        if (grid.pitch > 1.01 / kRows) {
            EXPECT_GE(onGrid, BlurGrid::kMinRadius);
        }
        EXPECT_GE((grid.size.x - 2) * grid.pitch, kAspect - 1e-9);
        EXPECT_GE((grid.size.y - 2) * grid.pitch, 1 - 1e-9);
    }
}

}  // namespace
}  // namespace fantascope::render
