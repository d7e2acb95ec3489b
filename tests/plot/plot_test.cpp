#include "pattern/motion/excitation.h"
#include "pattern/shape/elemental_shape.h"

#include "core/file.h"
#include "plot/chart.h"
#include "plot/figures.h"
#include "plot/page.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::plot {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

// A square over the left half of a canvas of 80 x 40. It extends beyond the canvas's left edge.
pattern::ShapePattern leftHalf() {
    pattern::ShapePattern pattern;
    pattern.guide = "half.png";
    pattern.width = 80, pattern.height = 40;
    pattern.seed = 9;
    pattern.motion.frames = 600;
    pattern.shapes.push_back(pattern::loadShape("square").value());
    pattern::ShapeInstance instance;
    instance.centre = {0, 0.5};
    instance.size = std::numbers::sqrt2;
    pattern.instances.push_back(instance);
    return pattern;
}

// White in the lower half.
GreyImage lowerHalf() {
    GreyImage guide(80, 40);
    for (int y = 20; y < 40; ++y)
        for (int x = 0; x < 80; ++x) guide.at(x, y) = 1;
    return guide;
}

bool isBlue(Rgba8 colour) { return colour.b > 100 && colour.r < 60; }
bool isRed(Rgba8 colour) { return colour.r > 100 && colour.b < 60; }
bool isWhite(Rgba8 colour) { return colour == Rgba8{255, 255, 255, 255}; }

// "Blue denotes pixels covered only by the guide image, red those covered only by the candidate
// shape pattern."
TEST(DifferencePicture, is_blue_where_the_guide_alone_is_and_red_where_the_pattern_alone_is) {
    const RgbaImage picture = differencePicture(leftHalf(), lowerHalf());
    ASSERT_EQ(picture.width(), 80);
    EXPECT_TRUE(isRed(picture.at(10, 5)));
    EXPECT_TRUE(isWhite(picture.at(10, 35)));
    EXPECT_TRUE(isWhite(picture.at(70, 5)));
    EXPECT_TRUE(isBlue(picture.at(70, 35)));
}

TEST(DifferencePicture, is_the_paler_the_less_they_differ) {
    const GreyImage grey(80, 40, 0.2f);
    const RgbaImage picture = differencePicture(leftHalf(), grey);
    EXPECT_GT(picture.at(70, 5).r, 150);  // only guide, 0.2
    EXPECT_LT(picture.at(10, 5).b, 90);   // only pattern, 0.8
}

TEST(DifferenceFigure, shows_the_picture_with_its_cells_upright) {
    pattern::ShapePattern pattern = leftHalf();
    pattern.instances.push_back(pattern.instances[0]);
    pattern.instances[1].id = 1, pattern.instances[1].centre = {1.5, 0.25}, pattern.instances[1].size = 0.1;
    const ScratchFolder folder;
    ASSERT_TRUE(differenceFigure(pattern, lowerHalf()).write(folder / "d.png"));
    const RgbaImage page = readRgba(folder / "d.png").value();
    // The picture's four quarters are found on the page by their colours, in the same arrangement.
    EXPECT_TRUE(isRed(page.at(page.width() / 8, 60)));
    EXPECT_TRUE(isBlue(page.at(page.width() * 7 / 8, 500)));
    const auto has = [&](auto fits) { return std::any_of(page.pixels().begin(), page.pixels().end(), fits); };
    EXPECT_TRUE(has([](Rgba8 p) { return p.r > 220 && p.g > 160 && p.g < 200 && p.b < 20; })) << "no yellow instance cell";
}

TEST(Page, is_written_as_png_and_as_svg_the_same_each_time) {
    const ScratchFolder folder;
    Page page(200, 100);
    page.text("z over iterations", {100, 50}, 12, Anchor::Middle);
    page.line({0, 0}, {200, 100}, {});
    for (const char* name : {"a.png", "b.png", "a.svg", "b.svg"}) ASSERT_TRUE(page.write(folder / name));
    EXPECT_EQ(readRgba(folder / "a.png")->width(), 200);
    EXPECT_EQ(readFile(folder / "a.png").value(), readFile(folder / "b.png").value());
    EXPECT_EQ(readFile(folder / "a.svg").value().size(), readFile(folder / "b.svg").value().size());
    EXPECT_THAT(readFile(folder / "a.svg").value(), HasSubstr("<svg"));
    EXPECT_THAT(page.write(folder / "a.jpg").error().message(), HasSubstr("must end in .png or .svg"));
}

// Example failure: a line begins where the text before it ends.
TEST(Page, a_line_begins_where_it_is_told) {
    const ScratchFolder folder;
    Page page(200, 100);
    page.text("text", {10, 10}, 12, Anchor::Left);
    page.line({150, 90}, {190, 90}, {{0, 0, 0}, 2});
    ASSERT_TRUE(page.write(folder / "a.png"));
    const RgbaImage drawn = readRgba(folder / "a.png").value();
    EXPECT_FALSE(isWhite(drawn.at(170, 90)));
    for (int x = 40; x < 140; ++x)
        for (int y = 0; y < 100; ++y) ASSERT_TRUE(isWhite(drawn.at(x, y))) << x << ", " << y;
}

TEST(Ticks, are_round_numbers_on_the_axis) {
    EXPECT_THAT(ticks({0, 1, ""}, 5), ElementsAre(0, DoubleEq(0.2), DoubleEq(0.4), DoubleEq(0.6), DoubleEq(0.8), DoubleEq(1)));
    EXPECT_THAT(ticks({-30, 30, ""}, 3), ElementsAre(-20, 0, 20));
    EXPECT_THAT(ticks({0.02, 15, "", true}, 10), ElementsAre(DoubleEq(0.1), 1, 10));
    for (const double mark : ticks({-1, 1, ""}, 4)) EXPECT_FALSE(mark == 0 && std::signbit(mark));
}

TEST(AxisAround, holds_zero_and_every_value) {
    const Axis axis = axisAround(std::vector{-0.2, 3.0}, "");
    EXPECT_LT(axis.from, -0.2);
    EXPECT_GT(axis.to, 3);
    EXPECT_EQ(axisAround(std::vector{1.0, 2.0}, "").from, 0);
    EXPECT_LT(axisAround({}, "").from, axisAround({}, "").to);
}

TEST(PowerSpectrum, of_a_wave_is_one_bin) {
    std::vector<double> wave(64);
    for (std::size_t i = 0; i < wave.size(); ++i) wave[i] = 3 * std::cos(2 * std::numbers::pi * 5 * static_cast<double>(i) / 64);
    const std::vector<double> power = powerSpectrum(wave);
    ASSERT_EQ(power.size(), 33u);
    for (std::size_t bin = 0; bin < power.size(); ++bin) EXPECT_NEAR(power[bin], bin == 5 ? 96 * 96 : 0, 1e-9);
}

// The figure's dashed line agrees with the excitation.
TEST(PowerSpectrum, of_an_excitation_falls_by_two_beta) {
    Rng rng(1);
    const std::vector<double> power = powerSpectrum(pattern::Excitation(1, 2000, 30, 0).draw(rng));
    EXPECT_NEAR(std::log(power[900] / power[9]) / std::log(100), -2, 1e-6);
}

// Patterns with the same seed and settings move alike, so figures name seed, group and instance.
// Example failure: the figures of two patterns are the same bytes and cannot be told apart.
TEST(Figures, a_spectrum_names_what_it_is_of) {
    const ScratchFolder folder;
    const auto drawnAs = [&](std::uint64_t seed, std::uint32_t id, std::uint32_t group) {
        pattern::ShapePattern pattern = leftHalf();
        pattern.seed = seed;
        pattern.instances[0].id = id;
        pattern.instances[0].group = group;
        pattern.groups = 3;
        EXPECT_TRUE(spectrumFigure(pattern).write(folder / "s.png"));
        return readFile(folder / "s.png").value();
    };
    const std::string one = drawnAs(1, 0, 0);
    EXPECT_EQ(drawnAs(1, 0, 0), one);
    EXPECT_NE(drawnAs(2, 0, 0), one);
    EXPECT_NE(drawnAs(1, 7, 0), one);
    EXPECT_NE(drawnAs(1, 0, 2), one);
}

TEST(Figures, of_any_pattern_and_search_can_be_drawn) {
    const ScratchFolder folder;
    pattern::ShapePattern none = leftHalf();
    none.instances.clear();
    for (const pattern::ShapePattern& pattern : {leftHalf(), none}) {
        EXPECT_TRUE(differenceFigure(pattern, lowerHalf()).write(folder / "d.svg"));
        EXPECT_TRUE(trajectoriesFigure(pattern).write(folder / "t.svg"));
        EXPECT_TRUE(spectrumFigure(pattern).write(folder / "s.svg"));
    }
    EXPECT_TRUE(searchFigure({}).write(folder / "z.svg"));
    EXPECT_TRUE(searchFigure({"paper", {0.5, 0.4}, {0.6, 0.5}, {true, false}, 0.1}).write(folder / "z.png"));
    const RgbaImage page = readRgba(folder / "z.png").value();
    const auto has = [&](auto fits) { return std::any_of(page.pixels().begin(), page.pixels().end(), fits); };
    EXPECT_TRUE(has([](Rgba8 p) { return p.r > 230 && p.g > 120 && p.g < 160 && p.b < 60; })) << "the highest z is orange";
    EXPECT_TRUE(has([](Rgba8 p) { return p.b > 190 && p.r < 60; })) << "the lowest z is blue";
    EXPECT_TRUE(has([](Rgba8 p) { return p.r > 200 && p.g < 60 && p.b < 60; })) << "a rejected iteration is red";
}

}  // namespace
}  // namespace fantascope::plot
