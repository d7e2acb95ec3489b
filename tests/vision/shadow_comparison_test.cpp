// Drawn photographs of a wall on which a shadow is thrown, by the projected wall.

#include "vision/compare/shadow_comparison.h"

#include "vision/projected_wall.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace fantascope::vision {
namespace {

constexpr glm::ivec2 kShown{800, 450};
constexpr glm::dvec3 kWhite{1};

// A figure with a round head, a body and two legs; coordinates in canvas heights from the middle.
bool isFigure(double x, double y) {
    const bool head = std::hypot(x, y + 0.22) < 0.1, body = std::hypot(x / 0.16, (y + 0.02) / 0.2) < 1;
    const bool legs = std::abs(std::abs(x) - 0.09) < 0.045 && y > 0.05 && y < 0.36;
    return head || body || legs;
}
bool isBar(double x, double y) { return std::abs(y - 0.25) < 0.08 && std::abs(x) < 0.6; }

// 1 where there is shadow. `aside`: canvas heights by which it is shifted.
GreyImage shadowOf(bool (*shape)(double, double), double aside = 0) {
    GreyImage mask(kShown.x, kShown.y);
    for (int y = 0; y < kShown.y; ++y)
        for (int x = 0; x < kShown.x; ++x)
            mask.at(x, y) = shape((x + 0.5 - 0.5 * kShown.x) / kShown.y - aside, (y + 0.5) / kShown.y - 0.5);
    return mask;
}

double overlapOf(const GreyImage& one, const GreyImage& other) {
    double both = 0, either = 0;
    for (int y = 0; y < one.height(); ++y)
        for (int x = 0; x < one.width(); ++x) {
            both += std::min(one.at(x, y), other.at(x, y));
            either += std::max(one.at(x, y), other.at(x, y));
        }
    return both / either;
}

NominalView viewOf(const ProjectedWall& wall) {
    NominalView view;
    view.camera = wall.camera, view.projector = wall.projector;
    view.canvasAspect = static_cast<double>(kShown.x) / kShown.y;
    view.warp = Warp::straight(kShown);
    return view;
}

// The camera's frame while the projector shows a shadow. `softness`: standard deviation of the
// penumbra, projector pixels.
RgbaImage photographed(ProjectedWall wall, const GreyImage& shadow, double softness = 0,
                       const std::function<double(int row)>& lamp = {}) {
    const GreyImage soft = softness > 0 ? blurred(shadow, softness) : shadow;
    RgbaImage shown(kShown.x, kShown.y);
    for (int y = 0; y < kShown.y; ++y)
        for (int x = 0; x < kShown.x; ++x) {
            const auto stored = static_cast<std::uint8_t>(std::lround(255 * std::pow(1 - soft.at(x, y), 1 / wall.gamma)));
            shown.at(x, y) = {stored, stored, stored, 255};
        }
    Rng rng(7);
    const GreyImage light = wall.seen(shown, rng, lamp);
    RgbaImage frame(light.width(), light.height());
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width(); ++x) {
            const auto stored = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(light.at(x, y))));
            frame.at(x, y) = {stored, stored, stored, 255};
        }
    return frame;
}

ShadowComparison comparisonOf(const ProjectedWall& wall, glm::dvec3 difference = kWhite) {
    return {viewOf(wall), difference, GreyImage(1, 1, 1)};
}

// Negative: none.
double scoreOf(const ProjectedWall& wall, const RgbaImage& frame, const GreyImage& wanted) {
    return comparisonOf(wall).compare(frame, wanted).value_or(-1);
}

// The light on each place of the wall becomes that of its projector's place.
ProjectedWall fallingOff(ProjectedWall wall) {
    const CameraModel projector = wall.projector;
    const auto lightAt = [projector](double x, double y) { return projector.pixelsPerArea({x, y, 0}, {0, 0, 1}); };
    double strongest = 0;
    for (const double x : {0.0, 1.0})
        for (const double y : {0.0, 1.0}) {
            const glm::dvec3 at = wall.hit(projector.rayThrough(glm::dvec2(x, y) * glm::dvec2(kShown)));
            strongest = std::max(strongest, lightAt(at.x, at.y));
        }
    wall.reflectance = [lightAt, strongest](double x, double y) { return 0.6 * std::min(1.0, lightAt(x, y) / strongest); };
    return wall;
}

// What a night adds: a brighter sky, a lens that blurs, noise, and a lamp from below that is as
// bright as the projector.
ProjectedWall atNight() {
    ProjectedWall wall = fallingOff(slantedWall());
    wall.strength = 0.5;
    wall.ambient = 0.15;
    wall.blur = 0.8;
    wall.noise = 5 / 255.0;
    return wall;
}
double lampFromBelow(int row) { return 0.5 * std::pow(row / 270.0, 2); }

TEST(ShadowComparison, gives_the_right_shadow_nearly_one) {
    const GreyImage figure = shadowOf(isFigure);
    const ProjectedWall clear = fallingOff(slantedWall()), night = atNight();
    EXPECT_NEAR(scoreOf(clear, photographed(clear, figure), figure), 1, 0.03);
    EXPECT_NEAR(scoreOf(night, photographed(night, figure, 0, lampFromBelow), figure), 1, 0.03);
    EXPECT_NEAR(scoreOf(night, photographed(night, figure, 4, lampFromBelow), figure), 1, 0.03) << "a soft lamp";
}

TEST(ShadowComparison, gives_a_shifted_shadow_the_overlap_of_its_shift) {
    const GreyImage figure = shadowOf(isFigure);
    const ProjectedWall wall = atNight();
    for (const double aside : {-0.1, -0.03, 0.02, 0.06, 0.2}) {
        const GreyImage shifted = shadowOf(isFigure, aside);
        EXPECT_NEAR(scoreOf(wall, photographed(wall, shifted, 2, lampFromBelow), figure), overlapOf(shifted, figure), 0.03)
            << aside;
    }
}

TEST(ShadowComparison, gives_a_shadow_of_another_shape_little) {
    const GreyImage figure = shadowOf(isFigure), bar = shadowOf(isBar);
    const ProjectedWall wall = atNight();
    EXPECT_NEAR(scoreOf(wall, photographed(wall, bar, 2, lampFromBelow), figure), overlapOf(bar, figure), 0.03);
    EXPECT_LT(overlapOf(bar, figure), 0.3) << "the test's shapes";
}

// A large shadow leaves less light than dark.
TEST(ShadowComparison, knows_a_shadow_that_covers_most_of_the_canvas) {
    const auto shape = [](double x, double y) { return std::abs(x) < 0.75 && std::abs(y) < 0.4; };
    const GreyImage large = shadowOf(shape);
    const ProjectedWall wall = slantedWall();
    EXPECT_NEAR(scoreOf(wall, photographed(wall, large), large), 1, 0.03);
}

TEST(ShadowComparison, says_nothing_without_contrast) {
    const GreyImage figure = shadowOf(isFigure), none(kShown.x, kShown.y);
    ProjectedWall wall = atNight();
    EXPECT_LT(scoreOf(wall, photographed(wall, none, 0, lampFromBelow), figure), 0) << "no shadow";
    EXPECT_LT(scoreOf(wall, photographed(wall, GreyImage(kShown.x, kShown.y, 1), 0, lampFromBelow), figure), 0) << "no light";
    wall.strength = 0.01;
    EXPECT_LT(scoreOf(wall, photographed(wall, figure, 0, lampFromBelow), figure), 0) << "a faint one";
    EXPECT_LT(scoreOf(wall, RgbaImage(wall.camera.size.x, wall.camera.size.y), figure), 0) << "a covered lens";
    EXPECT_LT(scoreOf(wall, RgbaImage(100, 100), figure), 0) << "a frame of another size";
}

TEST(ShadowComparison, says_nothing_of_stains_without_a_shadow) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = [](double x, double y) { return 0.4 + 0.2 * std::sin(5 * x) * std::sin(6 * y); };
    const GreyImage figure = shadowOf(isFigure), none(kShown.x, kShown.y);
    EXPECT_LT(scoreOf(wall, photographed(wall, none), figure), 0);
}

// At the far edge of a grazing picture the light is a ninth of that at the near edge.
TEST(ShadowComparison, allows_for_the_projectors_fall_off) {
    ProjectedWall wall = slantedWall();
    wall.projector = CameraModel::fromThrowRatio(*Pose::lookingAt({-3, 1.7, 1.8}, {-0.3, 1.5, 0}), kShown, 2.2, {0, 0});
    wall = fallingOff(wall);
    for (const double aside : {-0.4, 0.0, 0.4}) {
        const GreyImage figure = shadowOf(isFigure, aside);
        EXPECT_NEAR(scoreOf(wall, photographed(wall, figure), figure), 1, 0.05) << aside;
    }
}

TEST(ShadowComparison, says_nothing_when_the_camera_looks_elsewhere) {
    const GreyImage figure = shadowOf(isFigure);
    ProjectedWall wall = slantedWall();
    wall.camera.pose = *Pose::lookingAt({7, 1.7, 7}, {6, 1.5, 0});
    EXPECT_LT(scoreOf(wall, photographed(wall, figure), figure), 0);
}

// Only the channels in which the shadow differs are looked at, and a shadow may be the brighter
// one.
TEST(ShadowComparison, knows_which_colour_the_shadow_takes) {
    const GreyImage figure = shadowOf(isFigure), bar = shadowOf(isBar);
    const ProjectedWall wall = slantedWall();
    const RgbaImage red = photographed(wall, figure), green = photographed(wall, bar),
                    blue = photographed(wall, inverted(figure));
    RgbaImage frame = red;
    for (int y = 0; y < frame.height(); ++y)
        for (int x = 0; x < frame.width(); ++x) frame.at(x, y) = {red.at(x, y).r, green.at(x, y).g, blue.at(x, y).b, 255};
    const auto score = [&](glm::dvec3 difference, const GreyImage& wanted) {
        return comparisonOf(wall, difference).compare(frame, wanted).value_or(-1);
    };
    EXPECT_GT(score({1, 0, 0}, figure), 0.97);
    EXPECT_GT(score({0, 0.5, 0}, bar), 0.97);
    EXPECT_GT(score({0.5, 0, -0.5}, figure), 0.97);
}

// A part that does not count, because the searches for poses do not look there either.
TEST(ShadowComparison, leaves_out_what_does_not_count) {
    const GreyImage figure = shadowOf(isFigure);
    const ProjectedWall wall = slantedWall();
    GreyImage counted(kShown.x, kShown.y, 1), dirty = figure;
    for (int y = 0; y < kShown.y; ++y)
        for (int x = 0; x < 200; ++x) counted.at(x, y) = 0, dirty.at(x, y) = 1;
    const RgbaImage frame = photographed(wall, dirty);
    EXPECT_GT(ShadowComparison(viewOf(wall), kWhite, counted).compare(frame, figure).value_or(-1), 0.97);
    EXPECT_LT(scoreOf(wall, frame, figure), 0.5);
}

}  // namespace
}  // namespace fantascope::vision
