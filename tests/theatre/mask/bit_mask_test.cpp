#include "theatre/mask/bit_mask.h"

#include "theatre/masks.h"

#include "core/random.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

int countByPixel(const BitMask& mask) {
    int count = 0;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x) count += mask.at(x, y);
    return count;
}

TEST(BitMask, fills_from_to_across_word_edges) {
    for (const int width : {1, 63, 64, 65, 127, 128, 129, 200})
        for (const int from : {-5, 0, 1, 62, 63, 64, 65, 126, 127, 128, 190})
            for (const int to : {-1, 0, 1, 63, 64, 65, 127, 128, 129, 200, 300}) {
                BitMask mask(width, 3);
                mask.fill(1, from, to);
                for (int x = -2; x < width + 2; ++x)
                    ASSERT_EQ(mask.at(x, 1), x >= 0 && x < width && x >= from && x < to)
                        << width << ": " << from << ", " << to << ", " << x;
                EXPECT_EQ(mask.count(), std::max(0, std::min(to, width) - std::max(from, 0)));
                EXPECT_EQ(countByPixel(mask), mask.count());
            }
}

TEST(BitMask, fills_pixels_whose_centres_lie_between) {
    Rng rng(1);
    BitMask mask(130, 300);
    std::vector<float> from, to;
    for (int y = 0; y < 300; ++y) {
        from.push_back(static_cast<float>(rng.uniform(-40, 140)));
        to.push_back(static_cast<float>(rng.uniform(-40, 170)));
    }
    mask.fill(0, from, to);
    for (int y = 0; y < 300; ++y)
        for (int x = 0; x < 130; ++x) {
            const auto row = static_cast<std::size_t>(y);
            ASSERT_EQ(mask.at(x, y), from[row] <= static_cast<float>(x) + 0.5f && static_cast<float>(x) + 0.5f <= to[row]);
        }
}

TEST(BitMask, clears_adds_compares_and_knows_its_rows) {
    BitMask a(100, 50), b(100, 50);
    EXPECT_GE(a.rowsFrom(), a.rowsTo());
    a.fill(10, 5, 90);
    a.fill(20, 60, 70);
    b.fill(20, 65, 75);
    b.fill(30, 0, 100);
    EXPECT_EQ(a.rowsFrom(), 10);
    EXPECT_EQ(a.rowsTo(), 21);
    EXPECT_EQ(differing(a, b), 85 + 5 + 5 + 100);
    EXPECT_EQ(differing(a, a), 0);
    EXPECT_EQ(shared(a, b), 5);
    EXPECT_DOUBLE_EQ(intersectionOverUnion(a, b), 5.0 / (95 + 110 - 5));
    EXPECT_EQ(intersectionOverUnion(a, a), 1);
    a.add(b);
    EXPECT_EQ(a.count(), 85 + 15 + 100);
    EXPECT_EQ(a.rowsFrom(), 10);
    EXPECT_EQ(a.rowsTo(), 31);
    a.add(BitMask(100, 50));
    EXPECT_EQ(a.count(), 200);
    a.clear();
    EXPECT_EQ(a.count(), 0);
    EXPECT_EQ(a, BitMask(100, 50));
    EXPECT_FALSE(a == b);
    EXPECT_GE(a.rowsFrom(), a.rowsTo());
}

// Twice the area of a b p, positive if p is on the right of a -> b as seen, with y down.
double side(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); }

void expectFilled(const std::vector<glm::vec2>& polygon, int width, int height) {
    // Wherever the polygon begins.
    for (std::size_t first = 0; first < polygon.size(); ++first) {
        std::vector<glm::vec2> turned(polygon.begin() + static_cast<std::ptrdiff_t>(first), polygon.end());
        turned.insert(turned.end(), polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(first));
        BitMask mask(width, height);
        ConvexFiller().fill(turned, mask);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                double least = 1e9;
                for (std::size_t i = 0; i < polygon.size(); ++i) {
                    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
                    if (a == b) continue;
                    least = std::min(least, side(a, b, {x + 0.5, y + 0.5}) / std::hypot(b.x - a.x, b.y - a.y));
                }
                if (std::abs(least) > 1e-3) {
                    ASSERT_EQ(mask.at(x, y), least > 0) << x << ", " << y << ", from point " << first;
                }
            }
        EXPECT_EQ(countByPixel(mask), mask.count());
    }
}

TEST(ConvexFiller, fills_random_polygons_like_a_test_of_every_pixel) {
    Rng rng(2);
    for (int trial = 0; trial < 60; ++trial) {
        const double x = rng.uniform(-20, 150), y = rng.uniform(-20, 100), a = rng.uniform(0.5, 80), b = rng.uniform(0.5, 50);
        const int points = 3 + static_cast<int>(rng.below(8));
        std::vector<glm::vec2> polygon;
        for (int i = 0; i < points; ++i) {
            const double angle = 2 * std::numbers::pi * (i + rng.uniform(0, 0.9)) / points;
            polygon.emplace_back(x + a * std::cos(angle), y + b * std::sin(angle));
        }
        expectFilled(polygon, 130, 80);
    }
}

// Level edges exactly in a row of centres divide by no height.
TEST(ConvexFiller, fills_rectangles_with_edges_through_centres) {
    for (const float edge : {10.0f, 10.25f, 10.5f}) {
        const std::vector<glm::vec2> rectangle = {{edge, edge}, {edge + 55, edge}, {edge + 55, edge + 20}, {edge, edge + 20}};
        expectFilled(rectangle, 130, 80);
        BitMask mask(130, 80);
        ConvexFiller().fill(rectangle, mask);
        EXPECT_GE(mask.count(), 55 * 20);
        EXPECT_LE(mask.count(), 56 * 21);
    }
}

TEST(ConvexFiller, draws_nothing_for_what_is_outside_or_has_no_area) {
    for (const glm::vec2 shift : {glm::vec2(0, -50), {0, 90}, {-70, 0}, {140, 0}}) {
        std::vector<glm::vec2> polygon = {{5, 5}, {60, 5}, {30, 40}};
        for (glm::vec2& point : polygon) point += shift;
        BitMask mask(130, 80);
        ConvexFiller().fill(polygon, mask);
        EXPECT_EQ(mask.count(), 0);
    }
    BitMask mask(130, 80);
    ConvexFiller().fill(std::vector<glm::vec2>{{5, 10.2f}, {60, 10.2f}, {30, 10.2f}}, mask);
    EXPECT_EQ(mask.count(), 0);
}

TEST(BitMask, keeps_a_rectangle) {
    Rng rng(8);
    for (int trial = 0; trial < 40; ++trial) {
        BitMask mask = randomMask(rng, 150, 20, 0.5);
        const BitMask before = mask;
        const int left = static_cast<int>(rng.below(170)) - 10, right = static_cast<int>(rng.below(170)) - 10,
                  top = static_cast<int>(rng.below(24)) - 2, bottom = static_cast<int>(rng.below(24)) - 2;
        mask.keep(left, top, right, bottom);
        EXPECT_EQ(mask, drawn(150, 20,
                              [&](int x, int y) { return before.at(x, y) && x >= left && x < right && y >= top && y < bottom; }));
    }
}

TEST(BitMask, is_compared_pixel_by_pixel) {
    Rng rng(8);
    for (int trial = 0; trial < 20; ++trial) {
        const BitMask a = randomMask(rng, 70 + trial, 9, 0.3), b = randomMask(rng, 70 + trial, 9, 0.3);
        const BitMask different = difference(a, b);
        BitMask both(a.width(), a.height()), either = a;
        either.add(b);
        for (int y = 0; y < a.height(); ++y)
            for (int x = 0; x < a.width(); ++x) {
                EXPECT_EQ(different.at(x, y), a.at(x, y) != b.at(x, y));
                if (a.at(x, y) && b.at(x, y)) both.fill(y, x, x + 1);
            }
        EXPECT_EQ(different.count(), differing(a, b));
        EXPECT_EQ(meet(a, b), both.count() > 0);
        EXPECT_FALSE(meet(different, both));
        EXPECT_TRUE(isWithin(a, either) && isWithin(both, a) && isWithin(both, b) && isWithin(BitMask(a.width(), 9), both));
        EXPECT_EQ(isWithin(a, b), both == a);
    }
}

// Example failure: a change beyond a word's or a band's edge goes unseen.
TEST(Changes, are_seen_wherever_they_are) {
    Rng rng(9);
    Changes changes;
    const BitMask before = randomMask(rng, 150, 37, 0.5);
    changes.find(before, before);
    EXPECT_FALSE(changes.isAny());
    EXPECT_FALSE(changes.mayReach({75, 18}, 100));
    int unseen = 0, wrong = 0;
    for (int trial = 0; trial < 500; ++trial) {
        BitMask after = before;
        const glm::ivec2 changed(rng.below(150), rng.below(37)), asked(rng.below(150), rng.below(37));
        after.row(changed.y)[static_cast<std::size_t>(changed.x / BitMask::kBits)] ^= std::uint64_t{1}
                                                                                      << (changed.x % BitMask::kBits);
        changes.find(before, after);
        ASSERT_TRUE(changes.isAny());
        const int far = std::max(std::abs(changed.x - asked.x), std::abs(changed.y - asked.y));
        ASSERT_TRUE(changes.mayReach(asked, far));
        for (int within = 0; within < std::min(far, 32); ++within) (changes.mayReach(asked, within) ? wrong : unseen) += 1;
        if (far >= 8 && far < 40) {
            EXPECT_FALSE(changes.mayReach(asked, far - 8)) << "coarser than a band";
        }
    }
    EXPECT_GT(unseen, 5 * wrong);
}

TEST(BitMask, keeps_what_another_has_and_says_how_much_they_share) {
    BitMask left(130, 4), right(130, 4);
    for (int y = 0; y < 4; ++y) left.fill(y, 0, 90), right.fill(y, 60, 130);
    EXPECT_DOUBLE_EQ(intersectionOverUnion(left, right), 30.0 / 130);
    left.keep(right);
    EXPECT_EQ(left.count(), 4 * 30);
    EXPECT_TRUE(left.at(60, 2) && left.at(89, 0) && !left.at(59, 1) && !left.at(90, 3));
}

}  // namespace
}  // namespace fantascope::theatre
