// Light through leaves on an output.

#include "render/output_renderer.h"
#include "render/reference_picture.h"
#include "render/scene.h"
#include "render/source/penumbra.h"

#include "allocations.h"
#include "core/geometry.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{320, 180};
constexpr double kAspect = 16.0 / 9;

std::array<glm::dvec2, 4> upright(glm::ivec2 size) { return rectangleCorners(size.x, size.y); }

// Pixels of an upright output to canvas heights.
double heights(double pixels) { return pixels / kSize.y; }

// A rectangle of canvas points.
pattern::ShapePattern rectangle(glm::dvec2 from, glm::dvec2 to) {
    pattern::ShapePattern pattern = squareAt((from + to) / 2.0, glm::length(to - from) / 2, glm::vec3(1), kAspect);
    const glm::dvec2 half = (to - from) / glm::length(to - from);
    const auto x = static_cast<float>(half.x), y = static_cast<float>(half.y);
    pattern.shapes[0].mesh = {{{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    return pattern;
}

// Leaves all over the canvas, but none over its edge.
pattern::ShapePattern scatteredLeaves() {
    pattern::ShapePattern pattern = smallPattern();
    for (pattern::ShapeInstance& instance : pattern.instances) {
        instance.shape %= 2;  // flat shapes only
        instance.centre = glm::clamp(instance.centre, glm::dvec2(instance.size), glm::dvec2(kAspect, 1) - instance.size);
    }
    return pattern;
}

ShadowLayer leaves(pattern::ShapePattern pattern, double blurPixels) {
    return {resting(std::move(pattern)), {heights(blurPixels), nullptr}};
}

double lightAt(const RgbaImage& image, int x, int y) {
    return double{linearFromSrgb(static_cast<float>(image.at(x, y).g) / 255)};
}

// Fine and coarse grids, and a disc wider than a third of the picture. The expected light of every
// pixel is a sum over the disc in double precision, of leaves drawn point by point, with full light
// all around. Example failures: a blur that darkens or shifts the picture; a border that repeats or
// wraps around; a blur of half the width.
TEST(Foliage, is_what_a_sum_over_the_suns_disc_gives) {
    const pattern::ShapePattern pattern = scatteredLeaves();
    std::vector<pattern::InstancePose> poses;
    pattern::ShapePattern white = pattern;
    for (pattern::ShapeInstance& instance : white.instances) {
        instance.colour = glm::vec3(1);
        poses.push_back({instance.centre, instance.size, instance.rotation});
    }
    const RgbaImage covered = referencePicture(white, poses, Warp::straight(kSize), kSize, 4);
    for (const double diameter : {3.0, 9.5, 16.0, 30.0, 70.0}) {
        DrawnOutput output(kSize, upright(kSize), {FoliageSource{.layers = {leaves(pattern, diameter)}}});
        const RgbaImage& drawn = output.frame({{0, 1}});
        const GreyImage disc = discFilter(diameter);
        double squares = 0, most = 0;
        for (int y = 0; y < kSize.y; ++y)
            for (int x = 0; x < kSize.x; ++x) {
                double wanted = 1;
                for (int v = 0; v < disc.height(); ++v)
                    for (int u = 0; u < disc.width(); ++u) {
                        const int fromX = x + u - disc.width() / 2, fromY = y + v - disc.height() / 2;
                        if (fromX < 0 || fromY < 0 || fromX >= kSize.x || fromY >= kSize.y) continue;
                        wanted -= double{disc.at(u, v)} * lightAt(covered, fromX, fromY);
                    }
                const double apart = std::abs(lightAt(drawn, x, y) - wanted);
                squares += apart * apart;
                most = std::max(most, apart);
            }
        const double rms = std::sqrt(squares / (kSize.x * kSize.y));
        std::printf("diameter %4.1f: rms %.2f, at most %.1f of 255\n", diameter, 255 * rms, 255 * most);
        EXPECT_LT(255 * rms, 2.5) << diameter;
        EXPECT_LT(255 * most, 25) << diameter;
    }
}

// The paper's pinhole camera: a small slit gives a round image of the sun.
TEST(Foliage, shows_a_round_sun_behind_a_slit) {
    constexpr double kRadius = 40;  // pixels
    const glm::dvec2 middle(kAspect / 2, 0.5), half(heights(kRadius / 8), heights(kRadius / 80));
    ShadowLayer slit = leaves(rectangle(middle - half, middle + half), 2 * kRadius);
    slit.holes = true;
    const double share = kRadius / 4 * kRadius / 40 / (std::numbers::pi * kRadius * kRadius);  // of the disc that the slit covers
    DrawnOutput output(kSize, upright(kSize), {FoliageSource{glm::vec3(static_cast<float>(0.5 / share)), glm::vec3(0), {slit}}});
    const RgbaImage& image = output.frame({{0, 1}});
    EXPECT_NEAR(lightAt(image, 160, 90), 0.5, 0.03);
    double least = INFINITY, most = 0;
    for (int degrees = 0; degrees < 360; degrees += 5) {
        const glm::dvec2 along(std::cos(radians(degrees)), std::sin(radians(degrees)));
        double radius = 0;
        while (radius < 80) {
            const glm::ivec2 at(glm::dvec2(160, 90) + radius * along);
            if (lightAt(image, at.x, at.y) < 0.25) break;
            radius += 0.25;
        }
        least = std::min(least, radius);
        most = std::max(most, radius);
    }
    EXPECT_GT(least / most, 0.93);
    EXPECT_NEAR((least + most) / 2, kRadius, 1.5);
}

// An asymmetric filter through the whole renderer, on fine and coarse grids: a hole shows the
// filter's picture neither mirrored nor upside down.
TEST(Foliage, throws_a_filters_picture_upright) {
    GreyImage corner(16, 16);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) corner.at(x, y) = 1;  // its top left quarter
    for (const double width : {12.0, 60.0}) {
        const glm::dvec2 middle(kAspect / 2, 0.5);
        ShadowLayer hole = leaves(rectangle(middle - heights(2), middle + heights(2)), width);
        hole.filter.picture = std::make_shared<const GreyImage>(corner);
        hole.holes = true;
        DrawnOutput output(kSize, upright(kSize), {FoliageSource{glm::vec3(static_cast<float>(width * width / 80)), {}, {hole}}});
        const RgbaImage& image = output.frame({{0, 1}});
        const int off = static_cast<int>(width / 4);
        EXPECT_GT(lightAt(image, 160 - off, 90 - off), 0.15) << width;
        EXPECT_LT(lightAt(image, 160 + off, 90 - off), 0.02) << width;
        EXPECT_LT(lightAt(image, 160 - off, 90 + off), 0.02) << width;
        EXPECT_LT(lightAt(image, 160 + off, 90 + off), 0.02) << width;
    }
}

// Where the edges of two layers cross, a quarter of the light is left, blurred or not. Example
// failure: shadows add, so that two halves leave nothing.
TEST(Foliage, multiplies_the_light_of_its_layers) {
    const pattern::ShapePattern left = rectangle({-0.5, -0.5}, {kAspect / 2, 1.5}),
                                top = rectangle({-0.5, -0.5}, {kAspect + 0.5, 0.5});
    const glm::vec3 light(0.8f), shadow(0.1f);
    DrawnOutput output(kSize, upright(kSize),
                       {FoliageSource{light, shadow, {leaves(left, 24), leaves(top, 40)}},
                        FoliageSource{light, shadow, {leaves(left, 0), leaves(top, 40)}}});
    const RgbaImage both = output.frame({{0, 1}});
    EXPECT_NEAR((lightAt(both, 159, 89) + lightAt(both, 160, 90)) / 2, 0.1 + 0.7 * 0.25, 0.02);
    EXPECT_NEAR((lightAt(both, 159, 170) + lightAt(both, 160, 170)) / 2, 0.1 + 0.7 * 0.5, 0.02);
    EXPECT_NEAR(lightAt(both, 310, 170), 0.8, 0.01);
    EXPECT_NEAR(lightAt(both, 10, 10), 0.1, 0.01);
    const RgbaImage sharp = output.frame({{1, 1}});
    EXPECT_NEAR((lightAt(sharp, 165, 89) + lightAt(sharp, 165, 90)) / 2, 0.1 + 0.7 * 0.5, 0.02);
    EXPECT_NEAR(lightAt(sharp, 155, 170), 0.1, 0.01);
    EXPECT_NEAR(lightAt(sharp, 165, 170), 0.8, 0.01);
}

// A leaf half over the canvas's edge shades the canvas like any other, blurred or not. Example
// failure: a bright border, because the outside was clipped before the blur.
TEST(Foliage, goes_on_beyond_the_canvas) {
    const pattern::ShapePattern all = rectangle({-1, -1}, {kAspect + 1, 2});
    DrawnOutput output(kSize, upright(kSize), {FoliageSource{.layers = {leaves(all, 40)}}});
    for (const Rgba8 pixel : output.frame({{0, 1}}).pixels()) ASSERT_LE(pixel.g, 5);
}

// Sharp and blurred shadows have the same centre, on coarse grids too. Example failure: a shift by
// half a pixel of the coarse grid.
TEST(Foliage, stays_in_place_when_it_is_blurred) {
    const pattern::ShapePattern square = rectangle({0.7, 0.35}, {1.0, 0.6});
    const std::array<glm::dvec2, 4> corners = {{{20.5, 10.25}, {300.25, 10.25}, {300.25, 171.5}, {20.5, 171.5}}};
    const auto centre = [&](double blur) {
        DrawnOutput output(kSize, corners, {FoliageSource{.layers = {leaves(square, blur)}}, SolidSource{}});
        const RgbaImage lit = output.frame({{1, 1}}), shaded = output.frame({{0, 1}});
        glm::dvec2 sum(0);
        double dark = 0;
        for (int y = 0; y < kSize.y; ++y)
            for (int x = 0; x < kSize.x; ++x) {
                const double here = lightAt(lit, x, y) - lightAt(shaded, x, y);
                sum += here * glm::dvec2(x, y);
                dark += here;
            }
        return sum / dark;
    };
    const glm::dvec2 sharp = centre(0);
    for (const double blur : {3.0, 20.0, 40.0}) EXPECT_LT(glm::distance(centre(blur), sharp), 0.1) << blur;
}

TEST(Foliage, fades_and_adds_as_every_layer_does) {
    DrawnOutput output(kSize, upright(kSize),
                       {FoliageSource{glm::vec3(1), glm::vec3(0), {leaves(rectangle({-1, -1}, {0.5, 2}), 20)}},
                        SolidSource{glm::vec3(0.2f)}, resting(rectangle({1, -1}, {3, 2}))});
    const RgbaImage& image = output.frame({{0, 0.5f}, {1, 1}, {2, 0.25f}});
    EXPECT_NEAR(lightAt(image, 20, 90), 0.2, 0.01);
    EXPECT_NEAR(lightAt(image, 150, 90), 0.7, 0.01);
    EXPECT_NEAR(lightAt(image, 300, 90), 0.95, 0.01);
}

// Each output has a context and a warp of its own.
TEST(Foliage, looks_the_same_on_two_outputs_at_once) {
    const FoliageSource source{.layers = {leaves(scatteredLeaves(), 20), leaves(scatteredLeaves(), 0)}};
    DrawnOutput first(kSize, upright(kSize), {source}), second(kSize, upright(kSize), {source});
    const RgbaImage one = first.frame({{0, 1}});
    EXPECT_EQ(second.frame({{0, 1}}), one);
    EXPECT_EQ(first.frame({{0, 1}}), one);
}

// This includes caustics and a mirror ball: everything is a function of show time, and drawing does
// not allocate.
TEST(Foliage, moves_with_show_time_alone_and_allocates_nothing) {
    const ShadowLayer swaying{moving(scatteredLeaves()), {heights(20), nullptr}}, sharp{moving(scatteredLeaves()), {}};
    DrawnOutput output(kSize, keystone(kSize),
                       {FoliageSource{.layers = {swaying, sharp}}, CausticsSource{glm::vec3(0.1f), {5, 3}, 1, 0.6, 0.02, 1},
                        MirrorBallSource{glm::vec3(2), {5, 3}, {0, 0, 2}, 0.25, 0.05, {2, 1, 1}, 0.05, 30}});
    const auto drawn = [&](std::uint32_t source, double at) -> RgbaImage { return output.frame({{source, 1}}, fromSeconds(at)); };
    for (std::uint32_t source = 0; source < 3; ++source) {
        const RgbaImage at1 = drawn(source, 1), at9 = drawn(source, 9);
        EXPECT_GT(difference(at1, at9).rms, 5) << source;
        EXPECT_EQ(drawn(source, 1), at1) << source;
    }
    const show::OutputState all{{{0, 0.4f}, {1, 0.3f}, {2, 0.3f}}};
    output.frame(all);
    const std::int64_t before = allocationsSoFar();
    for (int frame = 0; frame < 5; ++frame) output.frame(all, tickTime(frame, 30));
    EXPECT_EQ(allocationsSoFar() - before, 0);
}

}  // namespace
}  // namespace fantascope::render
