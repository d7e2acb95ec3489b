#include "vision/camera_model.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::vision {
namespace {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

Pose somewhere() { return *Pose::lookingAt({1, 2, 9}, {-1, 1.5, 0}); }

// A camera one metre from a wall, facing it squarely, sees the point half a metre to the right at
// its right edge (field of view 2 atan(1/2)), and row 0 is up. Example failure: y up, or pixel
// centres at integers.
TEST(CameraModel, pixels_of_a_hand_worked_view) {
    const Pose pose = *Pose::lookingAt({0, 0, 1}, {0, 0, 0});
    const CameraModel camera = *CameraModel::fromFieldOfView(pose, {200, 100}, 2 * std::atan(0.5));
    const auto right = camera.pixelFromWorld({0.5, 0, 0}), up = camera.pixelFromWorld({0, 0.25, 0});
    ASSERT_TRUE(right && up);
    EXPECT_NEAR(right->x, 200, 1e-9);
    EXPECT_NEAR(right->y, 50, 1e-9);
    EXPECT_NEAR(up->x, 100, 1e-9);
    EXPECT_NEAR(up->y, 0, 1e-9);
    EXPECT_FALSE(camera.pixelFromWorld({0, 0, 2})) << "behind the camera";
}

// Both signs of distortion, mixed terms, none: the ray through a point's pixel hits the point.
TEST(CameraModel, the_ray_through_a_points_pixel_meets_the_point) {
    const std::array<glm::dvec2, 5> lenses{{{0, 0}, {-0.05, 0}, {-0.25, 0.06}, {0.2, 0}, {0.1, -0.02}}};
    Rng rng(7);
    for (const glm::dvec2 lens : lenses) {
        const auto camera = CameraModel::fromFieldOfView(somewhere(), {480, 270}, 60 * kDegree, lens.x, lens.y);
        ASSERT_TRUE(camera) << camera.error().message();
        for (int i = 0; i < 200; ++i) {
            const glm::dvec2 pixel(rng.uniform(0, 480), rng.uniform(0, 270));
            const Ray ray = camera->rayThrough(pixel);
            EXPECT_NEAR(glm::length(ray.direction), 1, 1e-12);
            const auto seen = camera->pixelFromWorld(ray.origin + ray.direction * rng.uniform(0.5, 30));
            ASSERT_TRUE(seen);
            EXPECT_NEAR(seen->x, pixel.x, 1e-8) << lens.x << " " << lens.y;
            EXPECT_NEAR(seen->y, pixel.y, 1e-8) << lens.x << " " << lens.y;
        }
    }
}

// Brown's formula at one point: half a focal length from the axis, 0.5 (1 - 0.1 0.25 + 0.02 0.0625)
// = 0.488125.
TEST(CameraModel, distortion_moves_a_point_along_its_radius_by_browns_polynomial) {
    const Pose pose = *Pose::lookingAt({0, 0, 1}, {0, 0, 0});
    const CameraModel camera = *CameraModel::fromFieldOfView(pose, {1000, 1000}, 90 * kDegree, -0.1, 0.02);
    const auto pixel = camera.pixelFromWorld({0.3, -0.4, 0});  // focal length 500 px
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, 500 + 500 * 0.488125 * 0.6, 1e-9);
    EXPECT_NEAR(pixel->y, 500 + 500 * 0.488125 * 0.8, 1e-9);
}

// Such a lens would show two directions in one pixel, and no iteration could invert it.
TEST(CameraModel, a_distortion_that_folds_the_picture_is_refused) {
    const auto folded = CameraModel::fromFieldOfView(somewhere(), {480, 270}, 90 * kDegree, -0.6);
    ASSERT_FALSE(folded);
    EXPECT_THAT(folded.error().message(), HasSubstr("k1 = -0.6"));
    const CameraModel wide = *CameraModel::fromFieldOfView(somewhere(), {480, 270}, 60 * kDegree, -0.3);
    EXPECT_FALSE(wide.pixelFromWorld(wide.pose.position + wide.pose.worldFromLocal * glm::dvec3(3, 0, 1)))
        << "far outside the picture the polynomial folds back into it";
}

// Throw ratio 2: a picture one metre wide at two metres. A lens shift of half a height puts the
// axis on the picture's lower edge.
TEST(CameraModel, throw_ratio_and_lens_shift_place_the_projectors_picture) {
    const Pose pose = *Pose::lookingAt({0, 0, 2}, {0, 0, 0});
    const Plane wall{};
    const CameraModel plain = CameraModel::fromThrowRatio(pose, {640, 360}, 2, {0, 0});
    const auto left = wall.hitBy(plain.rayThrough({0, 180})), right = wall.hitBy(plain.rayThrough({640, 180}));
    ASSERT_TRUE(left && right);
    EXPECT_NEAR(left->x, -0.5, 1e-12);
    EXPECT_NEAR(right->x, 0.5, 1e-12);
    const CameraModel shifted = CameraModel::fromThrowRatio(pose, {640, 360}, 2, {0.25, 0.5});
    const auto bottomLeft = wall.hitBy(shifted.rayThrough({0, 360}));
    ASSERT_TRUE(bottomLeft);
    EXPECT_NEAR(bottomLeft->x, -0.25, 1e-12) << "a quarter of a width to the right";
    EXPECT_NEAR(bottomLeft->y, 0, 1e-12);
}

TEST(Plane, is_met_from_its_front_alone) {
    const Plane wall{};
    EXPECT_TRUE(wall.hitBy({{0, 0, 1}, {0, 0, -1}}));
    EXPECT_FALSE(wall.hitBy({{0, 0, 1}, {0, 0, 1}})) << "away from it";
    EXPECT_FALSE(wall.hitBy({{0, 0, 1}, {1, 0, 0}})) << "along it";
    EXPECT_FALSE(wall.hitBy({{0, 0, -1}, {0, 0, 1}})) << "from behind";
}

// The technician's question: which corners put the canvas straight on the wall? The homography
// through them must also carry the canvas's centre to the quadrilateral's centre.
TEST(RectifyingCorners, put_the_canvas_on_the_quadrilateral) {
    const Pose pose = *Pose::lookingAt({3, 3, 6}, {0, 1, 0});
    const CameraModel projector = CameraModel::fromThrowRatio(pose, {640, 360}, 1.2, {0, 0});
    const std::array<glm::dvec3, 4> picture{{{-1.6, 1.9, 0}, {1.6, 1.9, 0}, {1.6, 0.1, 0}, {-1.6, 0.1, 0}}};
    const auto corners = rectifyingCorners(projector, picture);
    ASSERT_TRUE(corners) << corners.error().message();
    const Homography projectorFromCanvas = *Homography::fromCorners(rectangleCorners(16.0 / 9, 1), *corners);
    const auto middle = Plane{}.hitBy(projector.rayThrough(projectorFromCanvas({8.0 / 9, 0.5})));
    ASSERT_TRUE(middle);
    EXPECT_NEAR(glm::length(*middle - glm::dvec3(0, 1, 0)), 0, 1e-9);

    const std::array<glm::dvec3, 4> tooFar{{{-9, 2, 0}, {1.6, 2, 0}, {1.6, 0, 0}, {-9, 0, 0}}};
    EXPECT_THAT(rectifyingCorners(projector, tooFar).error().message(), HasSubstr("corner 1 lies outside"));
}

TEST(CameraModel, has_its_axis_where_the_centre_is_said_to_be) {
    const glm::dvec2 centre(250, 120);
    const CameraModel camera = *CameraModel::fromFieldOfView(Pose(), {480, 270}, 60 * kDegree, -0.1, 0, centre);
    EXPECT_EQ(camera.pixelFromWorld({0, 0, 3}), centre);
    EXPECT_NEAR(camera.fieldOfView(), 60 * kDegree, 1e-12);
    EXPECT_NEAR(camera.focal, 240 / std::tan(30 * kDegree), 1e-9);
    // The corner that is farther away folds first.
    EXPECT_TRUE(CameraModel::fromFieldOfView(Pose(), {480, 270}, 60 * kDegree, -0.32));
    EXPECT_FALSE(CameraModel::fromFieldOfView(Pose(), {480, 270}, 60 * kDegree, -0.32, 0, glm::dvec2(300, 135)));
}

}  // namespace
}  // namespace fantascope::vision
