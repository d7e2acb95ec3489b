// Pictures of a show on a wall, as a camera sees them: where they stand, and what has moved.

#include "vision/watch/wall_watch.h"

#include "vision/watch/drift_track.h"
#include "vision/watch/what_moved.h"
#include "vision/watched_wall.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace fantascope::vision {
namespace {

constexpr double kInside = 0.1;  // of the picture's width and height: nothing is compared nearer to its edge

// The rms over the picture of a movement's error, projector pixels.
double errorOf(const Homography& found, const ProjectedWall& before, const ProjectedWall& now) {
    double sum = 0;
    constexpr int kPlaces = 9;
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
        const glm::dvec2 share = kInside + (1 - 2 * kInside) * glm::dvec2(i % kPlaces, i / kPlaces) / (kPlaces - 1.0);
        const glm::dvec2 at = share * glm::dvec2(before.projector.size);
        const auto truth = now.projector.pixelFromWorld(before.hit(before.projector.rayThrough(at)));
        const glm::dvec2 off = found(at) - *truth;
        sum += (off.x * off.x + off.y * off.y) / (kPlaces * kPlaces);
    }
    return std::sqrt(sum);
}

// Looks at the wall while a picture is shown on it. `disturb` changes what the camera sees.
std::optional<OutputSight> lookAt(WallWatch& watch, ProjectedWall& wall, const RgbaImage& shown, Rng& rng,
                                  const std::function<void(GreyImage&)>& disturb = {}) {
    GreyImage seen = wall.seen(shown, rng);
    if (disturb) disturb(seen);
    const GreyImage light = watch.lightOf(0, shown);
    return watch.look(storedOf(seen), {&light})[0];
}

TEST(WallWatch, finds_how_far_a_projector_has_moved) {
    for (const double degrees : {0.0, 0.05, 0.3, 1.6}) {
        ProjectedWall wall = brickWall();
        WallWatch watch({watchedOn(wall)}, wall.camera.size);
        ProjectedWall now = wall;
        now.projector = bumped(wall.projector, {degrees * 0.5, degrees, degrees * 0.7}, {0.02 * degrees, 0, 0.03 * degrees});
        Rng rng(3);
        std::optional<OutputSight> sight;
        for (std::uint64_t picture = 0; picture < 6; ++picture)
            sight = lookAt(watch, now, leaves(wall.projector.size, 160, 7 + picture), rng);
        ASSERT_TRUE(sight) << degrees;
        const double error = errorOf(sight->shownFromPlace, wall, now);
        EXPECT_LT(error, 0.35) << degrees;
        EXPECT_LT(error, 4 * sight->sigma) << degrees;
        EXPECT_LT(sight->sigma, 0.3) << degrees;
        EXPECT_GT(sight->agreement * sight->used, 0.6) << degrees;
    }
}

// Without a calibration the bricks are unknown, and stronger than the picture's own edges.
TEST(WallWatch, learns_the_surface_from_the_show) {
    ProjectedWall wall = brickWall();
    WallWatch watch({watchedOn(wall, false)}, wall.camera.size);
    Rng rng(4);
    std::optional<OutputSight> before, after;
    for (std::uint64_t picture = 0; picture < 12; ++picture)
        before = lookAt(watch, wall, leaves(wall.projector.size, 160, 20 + picture), rng);
    ProjectedWall now = brickWall();
    now.projector = bumped(wall.projector, {0.1, 0.4, -0.2});
    for (std::uint64_t picture = 0; picture < 8; ++picture)
        after = lookAt(watch, now, leaves(wall.projector.size, 160, 40 + picture), rng);
    ASSERT_TRUE(before && after);
    EXPECT_LT(errorOf(after->shownFromPlace * before->shownFromPlace.inverse(), wall, now), 0.6);
}

// Example failure: every pixel counts alike, and two people draw the picture to their side.
TEST(WallWatch, is_not_deceived_by_people_and_smooth_light) {
    ProjectedWall wall = brickWall();
    WallWatch watch({watchedOn(wall)}, wall.camera.size);
    ProjectedWall now = wall;
    now.projector = bumped(wall.projector, {0.1, 0.2, 0});
    Rng rng(5);
    std::optional<OutputSight> sight;
    for (std::uint64_t picture = 0; picture < 4; ++picture)
        sight = lookAt(watch, now, leaves(wall.projector.size, 160, 60 + picture), rng, [](GreyImage& seen) {
            for (int y = 0; y < seen.height(); ++y)
                for (int x = 0; x < seen.width(); ++x) {
                    if (y > 90 && std::abs(x - 180) < 18) seen.at(x, y) = 0.01f;
                    if (y > 70 && std::abs(x - 300) < 16) seen.at(x, y) = 0.12f + 0.05f * static_cast<float>(y % 7 < 3);
                    seen.at(x, y) += 0.1f * std::exp(-static_cast<float>((x - 240) * (x - 240)) / 20000.0f);
                }
        });
    ASSERT_TRUE(sight);
    EXPECT_LT(errorOf(sight->shownFromPlace, wall, now), 0.5);
}

// Example failure: the neighbour's light counts as part of the picture, or is subtracted where it
// was before.
TEST(WallWatch, sees_each_of_two_pictures_that_overlap) {
    std::array<ProjectedWall, 2> plan{brickWall(), brickWall()};
    for (ProjectedWall& wall : plan) wall.strength = 0.4;
    plan[1].projector = bumped(plan[1].projector, {0, 1, 0});
    plan[1].ambient = 0;
    WallWatch watch({watchedOn(plan[0]), watchedOn(plan[1])}, plan[0].camera.size);
    std::array<ProjectedWall, 2> now = plan;
    now[0].projector = bumped(plan[0].projector, {0.1, 0.3, 0.2});
    now[1].projector = bumped(plan[1].projector, {-0.2, 0.2, -0.3});
    Rng rng(11);
    std::vector<std::optional<OutputSight>> sights;
    for (std::uint64_t picture = 0; picture < 6; ++picture) {
        GreyImage seen;
        std::array<GreyImage, 2> light;
        for (std::size_t i = 0; i < 2; ++i) {
            const RgbaImage shown = leaves(plan[i].projector.size, 120, 100 + 10 * i + picture);
            const GreyImage alone = now[i].seen(shown, rng);
            light[i] = watch.lightOf(i, shown);
            if (seen.empty()) seen = GreyImage(alone.width(), alone.height());
            for (std::size_t p = 0; p < seen.pixels().size(); ++p) seen.pixels()[p] += alone.pixels()[p];
        }
        sights = watch.look(storedOf(seen), {&light[0], &light[1]});
    }
    for (std::size_t i = 0; i < 2; ++i) {
        ASSERT_TRUE(sights[i]) << i;
        EXPECT_LT(errorOf(sights[i]->shownFromPlace, plan[i], now[i]), 0.5) << i;
        EXPECT_GT(sights[i]->agreement, 0.8) << i << ": .7 if the neighbour's light is not subtracted";
    }
}

TEST(WallWatch, says_nothing_of_a_picture_without_content) {
    ProjectedWall wall = brickWall();
    WallWatch watch({watchedOn(wall)}, wall.camera.size);
    Rng rng(6);
    EXPECT_FALSE(lookAt(watch, wall, RgbaImage(wall.projector.size.x, wall.projector.size.y, Rgba8{0, 0, 0, 255}), rng));
    const RgbaImage shown = leaves(wall.projector.size, 160, 8);
    const auto covered = lookAt(watch, wall, shown, rng, [](GreyImage& seen) { std::ranges::fill(seen.pixels(), 0.02f); });
    EXPECT_TRUE(!covered || covered->agreement * covered->used < 0.3);
}

TEST(WallWatch, does_not_watch_an_output_that_the_camera_hardly_sees) {
    ProjectedWall wall = brickWall();
    wall.camera = bumped(wall.camera, {0, 60, 0});
    EXPECT_FALSE(WallWatch({watchedOn(wall)}, wall.camera.size).watches(0));
}

TEST(WallWatch, sees_by_the_surface_whether_the_camera_has_moved) {
    for (const bool isCamera : {false, true}) {
        ProjectedWall wall = brickWall();
        WallWatch watch({watchedOn(wall)}, wall.camera.size);
        ProjectedWall now = wall;
        CameraModel& device = isCamera ? now.camera : now.projector;
        device = bumped(device, {0.2, 0.6, 0.1});
        Rng rng(9);
        double stayed = 0;
        for (std::uint64_t picture = 0; picture < 4; ++picture)
            if (const auto sight = lookAt(watch, now, leaves(wall.projector.size, 160, 80 + picture), rng))
                stayed = sight->surfaceStayed;
        EXPECT_GT(isCamera ? -stayed : stayed, 5) << (isCamera ? "camera" : "projector");
    }
}

constexpr Time kStep = std::chrono::milliseconds(100);

OutputSight sightOf(glm::dvec2 shift, double sigma = 0.1) {
    return {Homography(glm::dmat3(1, 0, 0, 0, 1, 0, shift.x, shift.y, 1)), sigma, 1, 0.95, 0.9, 0};
}

TEST(DriftTrack, takes_the_median_of_what_was_seen) {
    DriftTrack track({0, 0}, {640, 360}, true);
    EXPECT_FALSE(track.now());
    for (int i = 0; i < 10; ++i) track.add(i * kStep, i % 4 == 3 ? sightOf({-60, 25}) : sightOf({3 + 0.05 * (i % 3 - 1), 4}));
    ASSERT_TRUE(track.now());
    EXPECT_NEAR(track.now()->px, 5, 0.06);
    EXPECT_TRUE(track.now()->isSure());
}

TEST(DriftTrack, says_nothing_if_most_pictures_say_nothing_or_differ) {
    DriftTrack hidden({0, 0}, {640, 360}, true), wild({0, 0}, {640, 360}, true), old({0, 0}, {640, 360}, true);
    for (int i = 0; i < 20; ++i) {
        hidden.add(i * kStep, i % 3 == 0 ? std::optional(sightOf({3, 4})) : std::nullopt);
        wild.add(i * kStep, sightOf({40.0 * (i % 2), 13.0 * (i % 3)}));
        old.add(i * kStep, i < 5 ? std::optional(sightOf({3, 4})) : std::nullopt);
    }
    EXPECT_FALSE(hidden.now());
    EXPECT_FALSE(wild.now());
    EXPECT_FALSE(old.now());
}

// A plan is never right to the pixel, so where the picture stands at first is where it belongs.
TEST(DriftTrack, without_a_survey_begins_where_the_picture_stands) {
    DriftTrack track({0, 0}, {640, 360}, false);
    int step = 0;
    for (; step < 60; ++step) track.add(step * kStep, sightOf({7, -2}));
    EXPECT_LT(track.now()->px, 0.01);
    for (; step < 80; ++step) track.add(step * kStep, sightOf({10, 2}));
    EXPECT_NEAR(track.now()->px, 5, 0.01);
    track.forget();
    for (; step < 100; ++step) track.add(step * kStep, sightOf({10, 2}));
    EXPECT_LT(track.now()->px, 0.01);
}

// Two projectors side by side before one camera.
struct TwoOutputs {
    std::array<ProjectedWall, 2> walls{slantedWall(), slantedWall()};
    TwoOutputs() {
        walls[0].projector = bumped(walls[0].projector, {0, -4, 0});
        walls[1].projector = bumped(walls[1].projector, {0, 4, 0});
    }
    WallWatch watch() const { return WallWatch({watchedOn(walls[0]), watchedOn(walls[1])}, walls[0].camera.size); }
    // What is seen of an output once its projector, or the camera, is another one.
    std::optional<Drift> drift(std::size_t output, const CameraModel& projector, const CameraModel& camera,
                               double surfaceStayed = 0) const {
        const ProjectedWall& wall = walls[output];
        const auto corners = rectangleCorners(wall.projector.size.x, wall.projector.size.y);
        auto moved = corners;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto pixel = wall.camera.pixelFromWorld(wall.hit(wall.projector.rayThrough(corners[i])));
            moved[i] = *projector.pixelFromWorld(wall.hit(camera.rayThrough(*pixel)));
        }
        Drift drift{*Homography::fromCorners(corners, moved), 0, 0.1, surfaceStayed};
        drift.px = rmsMovement(drift.moved, {0, 0}, wall.projector.size);
        return drift;
    }
};

TEST(WhatMoved, tells_a_projector_from_the_camera) {
    const TwoOutputs two;
    const WallWatch watch = two.watch();
    ASSERT_TRUE(watch.watches(0) && watch.watches(1));
    const CameraModel &left = two.walls[0].projector, &right = two.walls[1].projector, &camera = two.walls[0].camera;
    for (const glm::dvec3 turn : {glm::dvec3(0.1, 0.2, 0), glm::dvec3(-0.5, 0.3, 0.8), glm::dvec3(0.2, -1.5, 0.5)}) {
        EXPECT_EQ(whatMoved(watch, {two.drift(0, bumped(left, turn), camera), two.drift(1, right, camera)}), Moved::Projectors);
        EXPECT_EQ(whatMoved(watch, {two.drift(0, left, bumped(camera, turn)), two.drift(1, right, bumped(camera, turn))}),
                  Moved::Camera);
        EXPECT_EQ(whatMoved(watch, {two.drift(0, bumped(left, turn), camera), two.drift(1, bumped(right, -turn), camera)}),
                  Moved::Projectors);
    }
    EXPECT_EQ(whatMoved(watch, {two.drift(0, left, camera), two.drift(1, right, camera)}), Moved::Nothing);
    EXPECT_EQ(whatMoved(watch, {std::nullopt, std::nullopt}), Moved::Nothing);
}

// Example failure: nothing is told of a push by a pixel, since the other picture's place is known to
// a quarter of a pixel only.
TEST(WhatMoved, calls_a_picture_still_that_moved_by_less_than_the_other_in_all_likelihood) {
    const TwoOutputs two;
    const CameraModel &left = two.walls[0].projector, &right = two.walls[1].projector, &camera = two.walls[0].camera;
    std::optional<Drift> pushed = two.drift(0, bumped(left, {0, 0.05, 0}), camera), still = two.drift(1, right, camera);
    ASSERT_GT(pushed->px, 0.9);
    ASSERT_LT(pushed->px, 1.3);
    pushed->sigma = still->sigma = 0.28;
    EXPECT_EQ(whatMoved(two.watch(), {pushed, still}), Moved::Projectors);
    still->sigma = 0.5;
    EXPECT_EQ(whatMoved(two.watch(), {pushed, still}), Moved::Unclear);
}

TEST(WhatMoved, asks_the_surface_if_only_one_output_is_seen) {
    const TwoOutputs two;
    const WallWatch watch = two.watch();
    const CameraModel now = bumped(two.walls[0].projector, {0.1, 0.4, 0});
    const auto seen = [&](double surfaceStayed) {
        return whatMoved(watch, {two.drift(0, now, two.walls[0].camera, surfaceStayed), std::nullopt});
    };
    EXPECT_EQ(seen(6), Moved::Projectors);
    EXPECT_EQ(seen(-6), Moved::Camera);
    EXPECT_EQ(seen(1), Moved::Unclear);
}

}  // namespace
}  // namespace fantascope::vision
