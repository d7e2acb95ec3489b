#include "vision/warp_fit.h"

#include "vision/structured_light.h"

#include "tests/vision/projected_wall.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::vision {
namespace {

using testing::HasSubstr;

ProjectorMap mapOf(ProjectedWall& wall, Rng& rng) {
    const StructuredLight light(wall.projector.size, 32);
    LightDecoder decoder(light, wall.camera.size);
    for (std::size_t pair : {0, 0})
        decoder.take(pair, wall.seen(light.picture(pair, false, wall.gamma), rng),
                     wall.seen(light.picture(pair, true, wall.gamma), rng));
    for (std::size_t pair = 0; pair < light.pairs().size(); ++pair)
        decoder.take(pair, wall.seen(light.picture(pair, false, wall.gamma), rng),
                     wall.seen(light.picture(pair, true, wall.gamma), rng));
    return decoder.map();
}

WarpShape wholeCanvas(glm::ivec2 size) {
    WarpShape shape;
    shape.corners = rectangleCorners(size.x, size.y);
    return shape;
}

// A rectangle of the wall as the camera sees its corners.
WantedPlace rectangleOnTheWall(const ProjectedWall& wall, glm::dvec2 low, glm::dvec2 high) {
    WantedPlace wanted{wall.camera, {}};
    const std::array<glm::dvec2, 4> corners{{{low.x, high.y}, {high.x, high.y}, {high.x, low.y}, {low.x, low.y}}};
    for (std::size_t i = 0; i < 4; ++i)
        wanted.corners[i] = *wall.camera.pixelFromWorld({corners[i], wall.relief(corners[i].x, corners[i].y)});
    return wanted;
}

// Distances between where the warp sends places of the canvas and where the camera wants them, in
// projector pixels: the truth, which no fit sees.
std::pair<double, double> errorsOf(const WarpFit& fit, const WantedPlace& wanted, const ProjectedWall& wall) {
    const Warp warp = *Warp::of(fit.shape);
    std::array<glm::dvec2, 4> view;
    CameraModel lens = wall.camera;
    lens.pose = Pose{};
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec3 ray = lens.rayThrough(wanted.corners[i]).direction;
        view[i] = glm::dvec2(ray) / ray.z;
    }
    const Homography viewFromCanvas = *Homography::fromCorners(rectangleCorners(1, 1), view);
    double sum = 0, max = 0;
    constexpr int kSide = 40;
    for (int i = 0; i < kSide * kSide; ++i) {
        const glm::dvec2 canvas((i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide);
        const glm::dvec2 pixel = *lens.pixelFromWorld(glm::dvec3(viewFromCanvas(canvas), 1));
        const double error = glm::distance(warp.projectorFromCanvas(canvas), wall.projectorAt(pixel));
        sum += error * error;
        max = std::max(max, error);
    }
    return {std::sqrt(sum / (kSide * kSide)), max};
}

TEST(WarpFit, puts_the_canvas_on_a_flat_wall_of_bricks_by_a_keystone) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = bricks;
    Rng rng(1);
    const WantedPlace wanted = rectangleOnTheWall(wall, {-1.2, 0.8}, {1.3, 2.2});
    const auto fit = fitWarp(sharedPoints(mapOf(wall, rng)), wanted, wholeCanvas(wall.projector.size));
    ASSERT_TRUE(fit) << fit.error().message();
    EXPECT_TRUE(fit->flat);
    EXPECT_EQ(fit->shape.mesh.points, glm::ivec2(0));
    EXPECT_GT(fit->points, 400u);
    EXPECT_LT(fit->rms, 0.3);
    EXPECT_EQ(fit->rms, fit->keystoneRms);
    const auto [rms, max] = errorsOf(*fit, wanted, wall);
    EXPECT_LT(rms, 0.1);
    EXPECT_LT(max, 0.2);
}

// Behind a lens that blurs, a pixel sees more of the brighter brick beside it. Example failure: the
// wall counts as uneven, and its bricks bend the picture.
TEST(WarpFit, takes_a_blurred_wall_of_bricks_for_a_flat_one) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = bricks;
    wall.blur = 1.1;
    Rng rng(6);
    const WantedPlace wanted = rectangleOnTheWall(wall, {-1.2, 0.8}, {1.3, 2.2});
    const auto fit = fitWarp(sharedPoints(mapOf(wall, rng)), wanted, wholeCanvas(wall.projector.size));
    ASSERT_TRUE(fit) << fit.error().message();
    EXPECT_TRUE(fit->flat);
    const auto [rms, max] = errorsOf(*fit, wanted, wall);
    EXPECT_LT(rms, 0.1);
    EXPECT_LT(max, 0.3);
}

// A part of the canvas, upside down: its corners are those of the turned picture.
TEST(WarpFit, keeps_the_part_and_the_turn_of_the_output) {
    ProjectedWall wall = slantedWall();
    Rng rng(2);
    const WantedPlace wanted = rectangleOnTheWall(wall, {-1.2, 0.8}, {3.8, 2.2});
    WarpShape now = wholeCanvas(wall.projector.size);
    now.part = {{0, 0}, {0.5, 1}};
    now.orientation.quarterTurns = 2;
    const auto fit = fitWarp(sharedPoints(mapOf(wall, rng)), wanted, now);
    ASSERT_TRUE(fit) << fit.error().message();
    EXPECT_EQ(fit->shape.part, now.part);
    EXPECT_EQ(fit->shape.orientation, now.orientation);
    const Warp warp = *Warp::of(fit->shape);
    EXPECT_NEAR(glm::distance(warp.projectorFromCanvas({0, 0}), wall.projectorAt(wanted.corners[0])), 0, 0.3);
    EXPECT_NEAR(glm::distance(warp.projectorFromCanvas({0, 1}), wall.projectorAt(wanted.corners[3])), 0, 0.3);
}

// Bumps of five hundredths of the distance.
TEST(WarpFit, bends_the_canvas_over_uneven_ground_by_a_mesh) {
    ProjectedWall wall = slantedWall();
    wall.relief = [](double x, double y) { return 0.3 * std::sin(2.1 * x + 0.4) * std::sin(1.8 * y); };
    wall.reflectance = bricks;
    Rng rng(3);
    const WantedPlace wanted = rectangleOnTheWall(wall, {-1.0, 0.9}, {1.1, 2.1});
    const auto fit = fitWarp(sharedPoints(mapOf(wall, rng)), wanted, wholeCanvas(wall.projector.size));
    ASSERT_TRUE(fit) << fit.error().message();
    EXPECT_FALSE(fit->flat);
    EXPECT_GT(fit->keystoneRms, 3) << "a keystone alone is not enough, and it says so";
    EXPECT_LT(fit->rms, 0.5);
    const auto [rms, max] = errorsOf(*fit, wanted, wall);
    EXPECT_LT(rms, 0.7);
    EXPECT_LT(max, 3);
}

// A sculpture stands before a fifth of the wall: the picture stays straight, and the share is told.
TEST(WarpFit, leaves_out_what_stands_before_a_flat_wall) {
    ProjectedWall wall = slantedWall();
    wall.relief = [](double x, double y) { return std::abs(x - 0.1) < 0.25 && y < 2.1 ? 0.8 : 0.0; };
    Rng rng(4);
    ProjectedWall bare = slantedWall();
    const WantedPlace wanted = rectangleOnTheWall(bare, {-1.2, 0.8}, {1.3, 2.2});
    const auto fit = fitWarp(sharedPoints(mapOf(wall, rng)), wanted, wholeCanvas(wall.projector.size));
    ASSERT_TRUE(fit) << fit.error().message();
    EXPECT_TRUE(fit->flat);
    EXPECT_GT(fit->leftOut, 0.1);
    const auto [rms, max] = errorsOf(*fit, wanted, bare);
    EXPECT_LT(rms, 0.1);
}

TEST(WarpFit, says_that_the_wanted_place_is_not_lit) {
    ProjectedWall wall = slantedWall();
    Rng rng(5);
    const WantedPlace wanted{wall.camera, {{{2, 2}, {30, 2}, {30, 20}, {2, 20}}}};
    const auto fit = fitWarp(sharedPoints(mapOf(wall, rng)), wanted, wholeCanvas(wall.projector.size));
    ASSERT_FALSE(fit);
    EXPECT_THAT(fit.error().message(), HasSubstr("points of the wanted place are lit"));
}

}  // namespace
}  // namespace fantascope::vision
