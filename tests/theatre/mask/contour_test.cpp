#include "theatre/mask/contour.h"

#include "theatre/masks.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::theatre {
namespace {

using glm::ivec2;

bool isOnContour(const BitMask& mask, int x, int y) {
    return mask.at(x, y) && !(mask.at(x - 1, y) && mask.at(x + 1, y) && mask.at(x, y - 1) && mask.at(x, y + 1));
}
int squareBetween(ivec2 a, ivec2 b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

TEST(Contour, is_the_white_with_a_black_neighbour) {
    Rng rng(1);
    for (const int width : {63, 64, 65, 130}) {
        const BitMask mask = randomMask(rng, width, 30, 0.8);
        Contour contour;
        contour.find(randomMask(rng, width, 30, 0.5));  // and what was before is gone
        contour.find(mask);
        for (int y = 0; y < 30; ++y)
            for (int x = 0; x < width; ++x) ASSERT_EQ(contour.pixels().at(x, y), isOnContour(mask, x, y)) << x << ", " << y;
    }
}

TEST(Contour, nearest_is_the_nearest_of_all) {
    Rng rng(2);
    for (const double white : {0.001, 0.01, 0.3})
        for (int trial = 0; trial < 10; ++trial) {
            const BitMask mask = randomMask(rng, 150, 90, white);
            Contour contour;
            contour.find(mask);
            std::vector<ivec2> all;
            for (int y = 0; y < 90; ++y)
                for (int x = 0; x < 150; ++x)
                    if (isOnContour(mask, x, y)) all.emplace_back(x, y);
            if (all.empty()) continue;
            for (int i = 0; i < 100; ++i) {
                const ivec2 pixel(static_cast<int>(rng.below(200)) - 25, static_cast<int>(rng.below(130)) - 20);
                int least = 1 << 30;
                for (const ivec2 other : all) least = std::min(least, squareBetween(pixel, other));
                const auto nearest = contour.nearest(pixel);
                ASSERT_TRUE(nearest);
                EXPECT_TRUE(isOnContour(mask, nearest->x, nearest->y));
                ASSERT_EQ(squareBetween(pixel, *nearest), least);
                // What is known beforehand changes nothing, not even among equals.
                const ivec2 hint = all[rng.below(static_cast<std::uint32_t>(all.size()))];
                ASSERT_EQ(contour.nearest(pixel, hint), nearest);
            }
        }
}

TEST(Contour, of_several_nearest_the_one_in_the_row_then_above_then_left) {
    Contour contour;
    contour.find(maskOf({"..#..", ".....", "#...#", ".....", "..#.."}));
    EXPECT_EQ(contour.nearest({2, 2}), ivec2(0, 2));
    contour.find(maskOf({"..#..", ".....", "....#", ".....", "..#.."}));
    EXPECT_EQ(contour.nearest({2, 2}), ivec2(4, 2));
    contour.find(maskOf({"..#..", ".....", ".....", ".....", "..#.."}));
    EXPECT_EQ(contour.nearest({2, 2}), ivec2(2, 0));
}

TEST(Contour, of_nothing_there_is_no_nearest) {
    Contour contour;
    contour.find(BitMask(100, 50));
    EXPECT_EQ(contour.nearest({20, 20}), std::nullopt);
}

TEST(OuterContour, of_a_square_is_its_rim_clockwise) {
    const std::vector<ivec2> rim = outerContour(maskOf({".....", ".###.", ".###.", ".###.", "....."}));
    EXPECT_THAT(rim, testing::ElementsAre(ivec2(1, 1), ivec2(2, 1), ivec2(3, 1), ivec2(3, 2), ivec2(3, 3), ivec2(2, 3),
                                          ivec2(1, 3), ivec2(1, 2)));
}

TEST(OuterContour, of_a_ring_has_nothing_of_the_hole) {
    const BitMask ring = drawn(60, 60, [](int x, int y) {
        const double r = std::hypot(x - 30, y - 30);
        return r < 25 && r > 10;
    });
    const std::vector<ivec2> contour = outerContour(ring);
    EXPECT_GT(contour.size(), 120u);
    for (const ivec2 p : contour) EXPECT_GT(std::hypot(p.x - 30, p.y - 30), 23);
    // And of one whose wall is a pixel.
    EXPECT_EQ(outerContour(maskOf({"####", "#..#", "#..#", "####"})).size(), 12u);
}

TEST(OuterContour, of_two_islands_is_the_larger) {
    for (const int large : {0, 1}) {
        const BitMask mask = drawn(100, 40, [&](int x, int y) {
            return std::hypot(x - 20, y - 20) < (large == 0 ? 15 : 10) || std::hypot(x - 70, y - 20) < (large == 1 ? 15 : 10);
        });
        for (const ivec2 p : outerContour(mask)) EXPECT_EQ(p.x > 45, large == 1);
    }
    // One in the hole of the other.
    const BitMask target = drawn(100, 100, [](int x, int y) {
        const double r = std::hypot(x - 50, y - 50);
        return r < 8 || (r > 20 && r < 40);
    });
    for (const ivec2 p : outerContour(target)) EXPECT_GT(std::hypot(p.x - 50, p.y - 50), 38);
}

TEST(OuterContour, of_a_few_pixels_goes_around_them) {
    EXPECT_TRUE(outerContour(BitMask(20, 20)).empty());
    EXPECT_THAT(outerContour(maskOf({"...", ".#.", "..."})), testing::ElementsAre(ivec2(1, 1)));
    // Lines are walked there and back, at the picture's edge too.
    EXPECT_THAT(outerContour(maskOf({"####"})),
                testing::ElementsAre(ivec2(0, 0), ivec2(1, 0), ivec2(2, 0), ivec2(3, 0), ivec2(2, 0), ivec2(1, 0)));
    EXPECT_EQ(outerContour(maskOf({"#..", ".#.", "..#"})).size(), 4u);
}

// A chain of neighbours all around, through every pixel of a shape without holes that the outside
// touches.
TEST(OuterContour, is_a_closed_chain_through_the_whole_rim) {
    Rng rng(3);
    for (int trial = 0; trial < 20; ++trial) {
        const double a = rng.uniform(0.2, 0.5), b = rng.uniform(0, 6);
        const BitMask mask = drawn(90, 90, [&](int x, int y) {
            return std::hypot(x - 45, y - 45) < 28 * (1 + a * std::sin(5 * std::atan2(y - 45, x - 45) + b));
        });
        const std::vector<ivec2> chain = outerContour(mask);
        BitMask walked(90, 90);
        for (std::size_t i = 0; i < chain.size(); ++i) {
            const ivec2 step = chain[(i + 1) % chain.size()] - chain[i];
            EXPECT_EQ(std::max(std::abs(step.x), std::abs(step.y)), 1);
            EXPECT_TRUE(mask.at(chain[i].x, chain[i].y));
            walked.fill(chain[i].y, chain[i].x, chain[i].x + 1);
        }
        Contour rim;
        rim.find(mask);
        EXPECT_EQ(differing(walked, rim.pixels()), 0);
    }
}

TEST(Sampled, is_evenly_spaced_in_length_not_in_pixels) {
    // Along the sides of a square on its tip a step is sqrt 2 long, along its cut top 1.
    const BitMask mask = drawn(200, 200, [](int x, int y) { return std::abs(x - 100) + std::abs(y - 100) < 80 && y > 60; });
    const std::vector<ivec2> contour = outerContour(mask);
    double length = 0;
    for (std::size_t i = 0; i < contour.size(); ++i)
        length += glm::distance(glm::dvec2(contour[i]), glm::dvec2(contour[(i + 1) % contour.size()]));
    const std::vector<ivec2> samples = sampled(contour, 50);
    ASSERT_EQ(samples.size(), 50u);
    EXPECT_EQ(samples[0], contour[0]);
    std::size_t index = 0;
    for (std::size_t i = 0; i + 1 < 50; ++i) {
        double between = 0;
        for (; contour[index] != samples[i + 1]; ++index) {
            ASSERT_LT(index + 1, contour.size());
            between += glm::distance(glm::dvec2(contour[index]), glm::dvec2(contour[index + 1]));
        }
        EXPECT_NEAR(between, length / 50, 1.5);
    }
    EXPECT_TRUE(sampled({}, 10).empty());
    EXPECT_THAT(sampled({{3, 4}}, 3), testing::Each(ivec2(3, 4)));
}

TEST(ContourDisc, of_a_straight_edge_is_not_curved) {
    for (const double radius : {3.0, 6.0, 12.0}) {
        const ContourDisc disc(radius);
        const BitMask below = drawn(130, 130, [](int, int y) { return y >= 64; }),
                      right = drawn(130, 130, [](int x, int) { return x >= 64; });
        const ContourPoint top = disc.at(below, {63, 64}), left = disc.at(right, {64, 63});
        EXPECT_NEAR(top.curvature, 0, 1e-9);
        EXPECT_LT(glm::distance(top.normal, glm::dvec2(0, -1)), 1e-12);
        EXPECT_NEAR(left.curvature, 0, 1e-9);
        EXPECT_LT(glm::distance(left.normal, glm::dvec2(-1, 0)), 1e-12);
    }
}

// Measures all around a circle, or around a hole of that radius.
struct Round {
    double curvature = 0, worstNormal = 0;
};
Round around(double radius, bool isHole, double discRadius) {
    const ContourDisc disc(discRadius);
    const BitMask mask = drawn(200, 200, [&](int x, int y) { return (std::hypot(x - 99.7, y - 100.2) < radius) != isHole; });
    Contour contour;
    contour.find(mask);
    Round round;
    int count = 0;
    for (int y = 20; y < 180; ++y)
        for (int x = 20; x < 180; ++x)
            if (contour.pixels().at(x, y)) {
                const ContourPoint point = disc.at(mask, {x, y});
                EXPECT_EQ(point.pixel, ivec2(x, y));
                round.curvature += point.curvature;
                ++count;
                const glm::dvec2 outward = (isHole ? -1.0 : 1.0) * glm::normalize(glm::dvec2(x - 99.7, y - 100.2));
                round.worstNormal = std::max(round.worstNormal, glm::distance(point.normal, outward));
            }
    round.curvature /= count;
    return round;
}

TEST(ContourDisc, of_a_circle_has_its_curvature_and_normals) {
    for (const double radius : {20.0, 30.0, 60.0}) {
        const Round circle = around(radius, false, 6), hole = around(radius, true, 6);
        EXPECT_NEAR(circle.curvature, 6 / radius, 0.12);
        EXPECT_NEAR(hole.curvature, -6 / radius, 0.12);
        EXPECT_GT(circle.curvature, 0);
        EXPECT_LT(hole.curvature, 0);
        EXPECT_LT(circle.worstNormal, 0.15);
        EXPECT_LT(hole.worstNormal, 0.15);
    }
}

TEST(ContourDisc, beyond_the_picture_is_black) {
    const ContourDisc disc(6);
    const BitMask white = drawn(130, 70, [](int, int) { return true; });
    BitMask framed = drawn(190, 130, [](int x, int y) { return x >= 30 && x < 160 && y >= 30 && y < 100; });
    for (const ivec2 pixel : {ivec2(0, 0), {129, 0}, {129, 69}, {0, 69}, {0, 35}, {64, 0}, {127, 69}}) {
        const ContourPoint got = disc.at(white, pixel), wanted = disc.at(framed, pixel + 30);
        EXPECT_EQ(got.normal, wanted.normal);
        EXPECT_EQ(got.curvature, wanted.curvature);
    }
    // A quarter of the disc at a corner: 3 pi (1/2 - 1/4).
    EXPECT_NEAR(disc.at(white, {0, 0}).curvature, 3 * 3.14159 / 4, 0.5);
}

TEST(ContourDisc, of_a_single_pixel_has_no_normal) {
    EXPECT_EQ(ContourDisc(6).at(maskOf({"...", ".#.", "..."}), {1, 1}).normal, glm::dvec2(0));
}

}  // namespace
}  // namespace fantascope::theatre
