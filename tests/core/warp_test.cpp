#include "core/warp.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace fantascope {
namespace {

using testing::HasSubstr;
using Between = WarpMesh::Between;
using Flip = Orientation::Flip;

constexpr glm::ivec2 kSize{1920, 1080};
const std::array<glm::dvec2, 4> kKeystone = {{{103.5, 41.25}, {1811, 12.5}, {1702.75, 1033}, {61, 987.125}}};

WarpMesh meshOf(glm::ivec2 points, Between between, double reach, std::uint64_t seed) {
    WarpMesh mesh{between, points, {}};
    Rng rng(seed);
    for (int i = 0; i < points.x * points.y; ++i) {
        const double x = rng.uniform(-reach, reach), y = rng.uniform(-reach, reach);
        mesh.offsets.emplace_back(x, y);
    }
    return mesh;
}

std::string refusal(const WarpShape& shape) {
    const auto warp = Warp::of(shape);
    return warp ? "accepted" : warp.error().message();
}

TEST(Warp, carries_the_corners_of_the_shown_part_to_the_asked_pixels) {
    const Warp whole = Warp::of({.corners = kKeystone}).value();
    const Warp part = Warp::of({.part = {{0.4, 0.1}, {0.9, 1}}, .corners = kKeystone}).value();
    const std::array<glm::dvec2, 4> wholeCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}},
                                    partCorners = {{{0.4, 0.1}, {0.9, 0.1}, {0.9, 1}, {0.4, 1}}};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_LT(glm::distance(whole.projectorFromCanvas(wholeCorners[i]), kKeystone[i]), 1e-9);
        EXPECT_LT(glm::distance(part.projectorFromCanvas(partCorners[i]), kKeystone[i]), 1e-9);
    }
}

// Where each corner of the canvas appears, by hand: a sheet with A B over D C.
TEST(Warp, mirrors_first_and_then_turns_clockwise) {
    const auto seen = [](Orientation orientation) {
        const Warp warp = Warp::of({.orientation = orientation, .corners = rectangleCorners(kSize.x, kSize.y)}).value();
        std::string letters = "....";  // at the picture's top left, top right, bottom right, bottom left
        const std::array<glm::dvec2, 4> corners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec2 at = warp.projectorFromCanvas(corners[i]) / glm::dvec2(kSize);
            const std::size_t place = at.y < 0.5 ? (at.x < 0.5 ? 0 : 1) : (at.x < 0.5 ? 3 : 2);
            letters[place] = "ABCD"[i];
        }
        return letters;
    };
    EXPECT_EQ(seen({}), "ABCD");
    EXPECT_EQ(seen({Flip::Horizontal, 0}), "BADC");
    EXPECT_EQ(seen({Flip::Vertical, 0}), "DCBA");
    EXPECT_EQ(seen({Flip::None, 1}), "DABC");
    EXPECT_EQ(seen({Flip::None, 2}), "CDAB");
    EXPECT_EQ(seen({Flip::None, 3}), "BCDA");
    EXPECT_EQ(seen({Flip::Horizontal, 1}), "CBAD");
}

// A technician drags a mesh point: the picture follows exactly there, and nothing moves two points
// away.
TEST(Warp, moves_each_point_of_the_mesh_by_its_offset_and_only_its_surroundings) {
    for (const Between between : {Between::Smooth, Between::Straight}) {
        WarpShape shape{.corners = kKeystone, .mesh = meshOf({7, 5}, between, 0, 1)};
        const Warp before = Warp::of(shape).value();
        shape.mesh.offsets[2 * 7 + 3] = {20, -12};
        const Warp after = Warp::of(shape).value();
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 7; ++x) {
                const glm::dvec2 canvas(x / 6.0, y / 4.0);
                const glm::dvec2 moved = after.projectorFromCanvas(canvas) - before.projectorFromCanvas(canvas);
                const glm::dvec2 wanted = x == 3 && y == 2 ? glm::dvec2(20, -12) : glm::dvec2(0);
                EXPECT_LT(glm::distance(moved, wanted), 1e-9) << x << ", " << y;
            }
        const glm::dvec2 far(0.5 / 6, 0.5);
        EXPECT_LT(glm::distance(after.projectorFromCanvas(far), before.projectorFromCanvas(far)), 1e-9);
    }
}

// A mesh that only shears and stretches must not ripple: between points of a plane it is that
// plane.
TEST(Warp, keeps_a_plane_of_offsets_plane) {
    for (const Between between : {Between::Smooth, Between::Straight})
        for (const glm::ivec2 points : {glm::ivec2(2, 2), glm::ivec2(3, 5), glm::ivec2(9, 4)}) {
            WarpShape shape{.corners = rectangleCorners(kSize.x, kSize.y), .mesh = {between, points, {}}};
            const auto plane = [](glm::dvec2 at) { return glm::dvec2(30 * at.x - 7 * at.y + 3, 11 * at.x + 19 * at.y - 5); };
            for (int i = 0; i < points.x * points.y; ++i)
                shape.mesh.offsets.push_back(plane(glm::dvec2(i % points.x, i / points.x) / glm::dvec2(points - 1)));
            const Warp warp = Warp::of(shape).value();
            for (const glm::dvec2 at : {glm::dvec2(0.03, 0.97), {0.5, 0.5}, {0.31, 0.11}, {1, 0.4}})
                EXPECT_LT(glm::distance(warp.offsetAt(at), plane(at)), 1e-9);
        }
}

// Straight lines become smooth curves: the slope does not jump between patches, as it does in a
// bilinear mesh.
TEST(Warp, joins_smooth_patches_without_a_kink) {
    const auto kinkOf = [](Between between) {
        const Warp warp =
            Warp::of({.corners = rectangleCorners(kSize.x, kSize.y), .mesh = meshOf({5, 4}, between, 25, 3)}).value();
        constexpr double kStep = 1e-5;
        double greatest = 0;
        for (int knot = 1; knot < 4; ++knot)
            for (int i = 0; i < 10; ++i) {
                const glm::dvec2 at(knot / 4.0, (i + 0.5) / 10), step(kStep, 0);
                const glm::dvec2 before = warp.offsetAt(at) - warp.offsetAt(at - step),
                                 after = warp.offsetAt(at + step) - warp.offsetAt(at);
                greatest = std::max(greatest, glm::distance(before, after) / kStep);
            }
        return greatest;
    };
    EXPECT_LT(kinkOf(Between::Smooth), 1);
    EXPECT_GT(kinkOf(Between::Straight), 20);
}

// Example failure: the mesh keeps its offsets, which were made for the corners before.
TEST(Warp, follows_a_projector_that_has_moved) {
    WarpShape shape;
    shape.corners = {glm::dvec2(30, 20), {600, 40}, {580, 330}, {50, 300}};
    shape.mesh.points = {5, 4};
    for (int i = 0; i < 20; ++i) shape.mesh.offsets.emplace_back(3 * std::sin(i), 4 * std::cos(2 * i));
    const Homography map =
        *Homography::fromCorners(rectangleCorners(640, 360), {glm::dvec2(4, -3), {651, 2}, {645, 372}, {-6, 355}});
    const Warp before = *Warp::of(shape), after = *Warp::of(shape.moved(map));
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) {
            const glm::dvec2 canvas(x / 4.0, y / 3.0);
            EXPECT_LT(glm::distance(after.projectorFromCanvas(canvas), map(before.projectorFromCanvas(canvas))), 1e-9);
        }
    // Between the mesh's points a smooth patch is not exact, but nearly so.
    const glm::dvec2 between(0.3, 0.6);
    EXPECT_LT(glm::distance(after.projectorFromCanvas(between), map(before.projectorFromCanvas(between))), 0.05);
}

TEST(Warp, finds_the_canvas_point_of_every_pixel) {
    for (const Between between : {Between::Smooth, Between::Straight}) {
        const Warp warp = Warp::of({.part = {{0.25, 0}, {1, 0.8}},
                                    .orientation = {Flip::Horizontal, 1},
                                    .corners = kKeystone,
                                    .mesh = meshOf({6, 4}, between, 30, 9)})
                              .value();
        Rng rng(4);
        for (int i = 0; i < 500; ++i) {
            const double x = rng.uniform(0.25, 1), y = rng.uniform(0, 0.8);
            const auto found = warp.canvasFromProjector(warp.projectorFromCanvas({x, y}));
            ASSERT_TRUE(found);
            EXPECT_LT(glm::distance(*found, glm::dvec2(x, y)), 1e-7);
        }
    }
}

// Beyond the horizon of a steep keystone there is no canvas; the formula alone would give a point
// on its far side.
TEST(Warp, has_no_canvas_beyond_the_horizon) {
    const Warp steep = Warp::of({.corners = {{{900, 200}, {1020, 200}, {1900, 1000}, {20, 1000}}}}).value();
    EXPECT_TRUE(steep.canvasFromProjector({960, 210}));
    EXPECT_FALSE(steep.canvasFromProjector({960, 100}));
}

TEST(Warp, says_how_many_pixels_the_canvas_is_high) {
    EXPECT_NEAR(Warp::straight(kSize).canvasRows(16.0 / 9), 1080, 1e-9);
    const WarpShape half{.part = {{0.5, 0}, {1, 1}}, .corners = rectangleCorners(kSize.x, kSize.y)};
    EXPECT_NEAR(Warp::of(half)->canvasRows(32.0 / 9), 1080, 1e-9);
}

TEST(Warp, refuses_what_is_no_picture) {
    EXPECT_THAT(refusal({.corners = {{{0, 0}, {1920, 1080}, {1920, 0}, {0, 1080}}}}), HasSubstr("crossed"));
    EXPECT_THAT(refusal({.corners = {{{0, 0}, {10, 10}, {20, 20}, {0, 30}}}}), HasSubstr("in a line"));
    EXPECT_THAT(refusal({.part = {{0.5, 0}, {0.5, 1}}, .corners = kKeystone}), HasSubstr("no area"));
    EXPECT_THAT(refusal({.corners = kKeystone, .mesh = {Between::Smooth, {1, 4}, {}}}), HasSubstr("2 to 129 points"));
    EXPECT_THAT(refusal({.corners = kKeystone, .mesh = {Between::Smooth, {2, 2}, {{0, 0}}}}), HasSubstr("4 offsets, here are 1"));
    WarpMesh folded = meshOf({4, 4}, Between::Smooth, 0, 1);
    folded.offsets[5] = {700, 0};  // beyond its neighbour
    EXPECT_THAT(refusal({.corners = kKeystone, .mesh = folded}), HasSubstr("folds"));
    folded.offsets[5] = {150, 0};
    EXPECT_EQ(refusal({.corners = kKeystone, .mesh = folded}), "accepted");
    // Corners for rear projection run the other way, which is not a fold.
    EXPECT_EQ(refusal({.corners = {{{1920, 0}, {0, 0}, {0, 1080}, {1920, 1080}}}, .mesh = folded}), "accepted");
}

TEST(Warp, knows_whether_anything_of_it_is_seen) {
    EXPECT_TRUE(Warp::of({.corners = kKeystone})->reaches(kSize));
    WarpShape away{.corners = kKeystone};
    for (glm::dvec2& corner : away.corners) corner.x += 2000;
    EXPECT_FALSE(Warp::of(away)->reaches(kSize));
    WarpShape around{.corners = {{{-5000, -5000}, {9000, -5000}, {9000, 7000}, {-5000, 7000}}}};
    EXPECT_TRUE(Warp::of(around)->reaches(kSize));
}

}  // namespace
}  // namespace fantascope
