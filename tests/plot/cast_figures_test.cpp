#include "plot/cast_figures.h"

#include "plot/cast_picture.h"
#include "plot/mask_outline.h"
#include "plot/palette.h"
#include "scratch_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::plot {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

using theatre::BitMask;

BitMask rectangle(int left, int top, int right, int bottom) {
    BitMask mask(64, 64);
    for (int y = top; y < bottom; ++y) mask.fill(y, left, right);
    return mask;
}

RgbaImage drawn(const Page& page) {
    const ScratchFolder folder;
    EXPECT_TRUE(page.write(folder / "page.png"));
    return readRgba(folder / "page.png").value();
}

Rgba8 stored(const glm::dvec3& colour) {
    const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(255 * value)); };
    return {byte(colour.r), byte(colour.g), byte(colour.b)};
}

std::size_t count(const RgbaImage& picture, Rgba8 colour) {
    return static_cast<std::size_t>(std::count(picture.pixels().begin(), picture.pixels().end(), colour));
}

const Rgba8 kFirst = stored(actorColour(0)), kSecond = stored(actorColour(1));
bool isHatch(Rgba8 p) { return p.r > 200 && p.g < 110 && p.b < 110; }

// The target fills the lower three quarters of the mask, so that figures are not cropped. One actor
// covers its left half, the other its right half without the last quarter; they overlap in the
// middle.
struct Halves {
    BitMask target = rectangle(0, 16, 64, 64);
    std::vector<ActorShadow> actors{{rectangle(0, 16, 36, 64), "1.75 m", {"note of the first"}},
                                    {rectangle(28, 0, 48, 64), "1.60 m", {"note of the second"}}};
};

// The colour of a point in a figure's picture, which is at the page's top left inside the margin:
// the mean of a square of pixels.
Rgba8 inFigure(const RgbaImage& page, double x, double y) {
    return page.at(static_cast<int>(24 + 600 * x / 64), static_cast<int>(24 + 600 * y / 64));
}

TEST(ShadowFigure, has_each_actor_in_his_colour_and_a_darker_one_where_several_are) {
    const Halves halves;
    const RgbaImage page = drawn(shadowFigure(halves.actors, halves.target, {}));
    EXPECT_EQ(inFigure(page, 10, 40), kFirst);
    EXPECT_EQ(inFigure(page, 42, 40), kSecond);
    const Rgba8 both = inFigure(page, 32, 40);
    EXPECT_LT(both.r + both.g + both.b, std::min(kFirst.r + kFirst.g + kFirst.b, kSecond.r + kSecond.g + kSecond.b));
    EXPECT_GT(inFigure(page, 10, 5).r, 240);  // the page
}

TEST(ShadowFigure, hatches_in_red_what_is_missed_and_in_dark_what_sticks_out) {
    const Halves halves;
    const RgbaImage page = drawn(shadowFigure(halves.actors, halves.target, {}));
    int missedRed = 0, missed = 0, outDark = 0, out = 0;
    for (double x = 49; x < 63; x += 0.1, ++missed) missedRed += isHatch(inFigure(page, x, 40));
    for (double x = 29; x < 47; x += 0.1, ++out) outDark += inFigure(page, x, 8).b < 100;
    EXPECT_GT(missedRed, missed / 10);
    EXPECT_LT(missedRed, missed / 2);
    EXPECT_GT(outDark, out / 10);
    EXPECT_LT(outDark, out / 2);
    // Nothing is hatched if the target is not missed.
    const std::vector<ActorShadow> whole{{halves.target, "1.75 m", {}}};
    const RgbaImage matched = drawn(shadowFigure(whole, halves.target, {}));
    for (double x = 1; x < 63; x += 0.1) ASSERT_EQ(inFigure(matched, x, 40), kFirst);
}

TEST(ShadowFigure, has_the_targets_outline_above_all) {
    const Halves halves;
    const RgbaImage page = drawn(shadowFigure(halves.actors, halves.target, {}));
    for (const double x : {10.0, 32.0, 42.0, 55.0}) EXPECT_LT(inFigure(page, x, 16).r, 60) << x;
}

// A picture has the same size at any resolution of the masks, and empty rows and columns are
// cropped.
TEST(ShadowFigure, magnifies_small_masks_and_leaves_out_what_is_empty) {
    const std::vector<ActorShadow> small{{rectangle(20, 20, 30, 30), "", {}}};
    const RgbaImage page = drawn(shadowFigure(small, rectangle(20, 20, 30, 30), {}));
    EXPECT_GE(page.height(), 640);
    EXPECT_GT(count(page, kFirst), 200'000u);
}

TEST(ActorsFigure, shows_each_alone_before_the_others_in_grey) {
    const Halves halves;
    const RgbaImage page = drawn(actorsFigure(halves.actors, halves.target));
    // Two cells beside each other with pictures of 300 x 300 points, 58 points below the top.
    const auto inCell = [&](int cell, double x, double y) {
        return page.at(static_cast<int>(24 + cell * (page.width() - 24) / 2 + 300 * x / 64), static_cast<int>(58 + 300 * y / 64));
    };
    EXPECT_EQ(inCell(0, 10, 40), kFirst);
    EXPECT_EQ(inCell(0, 32, 40), kFirst);
    EXPECT_EQ(inCell(1, 32, 40), kSecond);
    const Rgba8 other = inCell(0, 42, 40);
    EXPECT_TRUE(other.r == other.g && other.g == other.b && other.r > 190 && other.r < 230);
    EXPECT_EQ(inCell(1, 10, 40), other);
    EXPECT_LT(inCell(0, 42, 16).r, 70) << "the outline";
}

TEST(SolutionsFigure, has_a_view_and_a_shadow_for_each) {
    const Halves halves;
    std::vector<SolutionCell> cells;
    for (int i = 0; i < 5; ++i)
        cells.push_back({RgbaImage(kCellView.x, kCellView.y, Rgba8{0, 0, static_cast<std::uint8_t>(200 + i)}),
                         halves.actors,
                         {"solution", "seed", "file"}});
    const RgbaImage page = drawn(solutionsFigure(cells, halves.target));
    for (int i = 0; i < 5; ++i)
        EXPECT_GT(count(page, {0, 0, static_cast<std::uint8_t>(200 + i)}), static_cast<std::size_t>(350 * 230)) << i;
    EXPECT_GT(count(page, kFirst), 5u * 18'000);
    EXPECT_GT(drawn(solutionsFigure({}, halves.target)).width(), 0);
}

TEST(Stacked, puts_pages_below_each_other) {
    std::vector<Page> pages;
    pages.emplace_back(30, 20), pages.emplace_back(50, 10);
    pages[0].box({0, 0}, {30, 20}, {1, 0, 0});
    pages[1].box({0, 0}, {50, 10}, {0, 0, 1});
    const RgbaImage all = drawn(stacked(pages));
    ASSERT_EQ(all.width(), 50);
    ASSERT_EQ(all.height(), 30);
    EXPECT_EQ(all.at(29, 19), (Rgba8{255, 0, 0}));
    EXPECT_EQ(all.at(40, 5), (Rgba8{255, 255, 255}));
    EXPECT_EQ(all.at(49, 20), (Rgba8{0, 0, 255}));
}

TEST(Palette, has_eight_colours_that_are_far_from_each_other_and_comes_again) {
    for (std::size_t i = 0; i < 8; ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_GT(glm::distance(actorColour(i), actorColour(j)), 0.25) << i << ", " << j;
    EXPECT_EQ(actorColour(8), actorColour(0));
}

// The expectation for a block of 2 x 1 is computed by hand.
TEST(MaskOutline, runs_through_the_middles_of_the_sides) {
    BitMask mask(5, 4);
    mask.fill(1, 1, 3);
    using P = glm::dvec2;
    EXPECT_THAT(maskOutline(mask),
                ElementsAre(ElementsAre(P(1.5, 1), P(2.5, 1), P(3, 1.5), P(2.5, 2), P(1.5, 2), P(1, 1.5), P(1.5, 1))));
}

double area(const std::vector<glm::dvec2>& ring) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < ring.size(); ++i) sum += 0.5 * (ring[i].x * ring[i + 1].y - ring[i].y * ring[i + 1].x);
    return sum;
}

// Rings are closed along the mask's edge. Pixels that touch at a corner are two rings. A hole's
// ring runs the other way around.
TEST(MaskOutline, finds_every_island_and_every_hole) {
    EXPECT_THAT(maskOutline(BitMask(6, 6)), SizeIs(0));
    BitMask full(6, 6);
    for (int y = 0; y < 6; ++y) full.fill(y, 0, 6);
    EXPECT_THAT(maskOutline(full), ElementsAre(testing::ResultOf(area, 35.5)));  // rings cut the corners
    BitMask diagonal(4, 4);
    diagonal.fill(1, 1, 2), diagonal.fill(2, 2, 3);
    EXPECT_THAT(maskOutline(diagonal), ElementsAre(testing::ResultOf(area, 0.5), testing::ResultOf(area, 0.5)));
    BitMask ring(7, 7);
    for (int y = 1; y < 6; ++y) ring.fill(y, 1, 6);
    for (int y = 2; y < 5; ++y) {
        ring.row(y)[0] = 0;
        ring.fill(y, 1, 2), ring.fill(y, 5, 6);
    }
    EXPECT_THAT(maskOutline(ring), ElementsAre(testing::ResultOf(area, 24.5), testing::ResultOf(area, testing::Lt(-8))));
}

// An actor hovers in a T-pose: his shadow is on the screen, and his notes say what is wrong.
TEST(CastPicture, shows_who_throws_what_and_says_who_cannot_stand) {
    const theatre::Stage stage;
    GreyImage silhouette(80, 80);
    for (int y = 10; y < 70; ++y)
        for (int x = 10; x < 70; ++x) silhouette.at(x, y) = 1;
    theatre::PoseProblem problem{stage, {theatre::PoseTarget::from(silhouette, stage, 1.8, 128).value()}, {}, {}};
    problem.actors = {theatre::humanBody(1.75), theatre::humanBody(1.5)};
    problem.buildSkins();
    std::vector<double> dofs;
    for (std::size_t i = 0; i < 2; ++i) {
        const theatre::Body& body = problem.actors[i];
        const double height = body.joints[0].offset.y + (i == 0 ? 0 : 0.5);
        const std::vector<double> rest = body.restPose({i == 0 ? -0.5 : 0.5, height, 1.5}, {1, 0, 0, 0});
        dofs.insert(dofs.end(), rest.begin(), rest.end());
    }
    const CastPicture picture = castPicture(problem, dofs);
    ASSERT_THAT(picture.images[0].actors, SizeIs(2));
    BitMask both = picture.images[0].actors[0].mask;
    both.add(picture.images[0].actors[1].mask);
    EXPECT_EQ(both, picture.view.images[0].shadow);
    const glm::dvec2 chest = problem.targets[0].frame.shadow({-0.5, 1.2, 1.5});
    EXPECT_TRUE(picture.images[0].actors[0].mask.at(static_cast<int>(chest.x), static_cast<int>(chest.y)));
    EXPECT_FALSE(picture.images[0].actors[1].mask.at(static_cast<int>(chest.x), static_cast<int>(chest.y)));
    EXPECT_EQ(picture.images[0].actors[1].name, "actor 2, 1.50 m");
    EXPECT_THAT(picture.images[0].actors[1].notes, Contains("does not touch the floor"));
    EXPECT_THAT(picture.images[0].lines, Contains(HasSubstr("cannot stand so:")));
    EXPECT_THAT(picture.images[0].lines, Contains(HasSubstr(" 2")));

    // A second screen at the side has another shadow of the same people.
    theatre::PoseProblem corner = problem;
    corner.stage.screens.push_back({{2.5, 1.5}, -std::numbers::pi / 2});
    corner.stage.beams.push_back({{-5, 0, 1.5}, 1});
    corner.targets.push_back(theatre::PoseTarget::from(silhouette, corner.stage, 1.8, 128, {1}).value());
    const CastPicture two = castPicture(corner, dofs);
    ASSERT_THAT(two.images, SizeIs(2));
    EXPECT_EQ(two.images[0].actors[0].mask, picture.images[0].actors[0].mask);
    const glm::dvec2 side = corner.targets[1].frame.shadow({-0.5, 1.2, 1.5});
    EXPECT_TRUE(two.images[1].actors[0].mask.at(static_cast<int>(side.x), static_cast<int>(side.y)));
    EXPECT_THAT(two.images[1].lines, Contains("beam 2"));
    EXPECT_THAT(picture.images[0].lines, testing::Not(Contains("beam 1")));
    EXPECT_GT(two.shadows().height(), 1.5 * picture.shadows().height());
    EXPECT_GT(two.each().height(), 1.5 * picture.each().height());

    // Each actor's number in the view is a badge in his colour.
    const RgbaImage stageView = drawn(stageFigure(picture.view, picture.view.overview(kStageAspect)));
    EXPECT_GT(count(stageView, kFirst), 30u);
    EXPECT_GT(count(stageView, kSecond), 30u);
}

}  // namespace
}  // namespace fantascope::plot
