#include "plot/stage_view.h"

#include <glm/common.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

namespace fantascope::plot {
namespace {

constexpr int kWidth = 640, kHeight = 320;

// A screen of 4 m x 2 m with pixels of 2 cm. The target, at the left, and the shadow, at the right,
// are 1 m wide and high.
StageView aView() {
    const theatre::Stage stage;
    StageView view{stage,
                   {{theatre::ScreenFrame(stage, -2, 2, 0.02, 200, 100), theatre::BitMask(200, 100), theatre::BitMask(200, 100)}},
                   {}};
    for (int y = 50; y < 100; ++y) view.images[0].target.fill(y, 25, 75), view.images[0].shadow.fill(y, 125, 175);
    return view;
}

TriangleMesh box(const glm::vec3& least, const glm::vec3& most) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.vertices.push_back(glm::mix(least, most, glm::vec3(i & 1, i >> 1 & 1, i >> 2)));
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

const glm::dvec3 kGreen(0, 0.6, 0.2), kBlue(0, 0.2, 0.8);
bool isGreen(Rgba8 p) { return p.g > p.r + 25 && p.g > p.b + 25; }
bool isBlue(Rgba8 p) { return p.b > p.r + 40 && p.b > p.g + 25; }
bool isRed(Rgba8 p) { return p.r > p.g + 40 && p.r > p.b + 40; }
int brightness(Rgba8 p) { return p.r + p.g + p.b; }

Rgba8 at(const RgbaImage& picture, const Camera& camera, const glm::dvec3& place) {
    const glm::dvec2 pixel = camera.pixelAt(place, kWidth, kHeight).value();
    return picture.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
}

TEST(StageView, shows_shadow_and_target_where_they_are_on_the_screen) {
    const StageView view = aView();
    for (const Camera& camera : {view.overview(2), view.closeUp(2)}) {
        const RgbaImage picture = view.draw(camera, kWidth, kHeight);
        EXPECT_LT(brightness(at(picture, camera, {1, 0.8, 0})), 250);   // in the shadow
        EXPECT_GT(brightness(at(picture, camera, {1, 1.5, 0})), 550);   // above it
        EXPECT_GT(brightness(at(picture, camera, {-1, 0.5, 0})), 550);  // in the target, without shadow
        EXPECT_TRUE(isRed(at(picture, camera, {-1, 1, 0})));            // on its upper edge
        EXPECT_TRUE(isRed(at(picture, camera, {-1.5, 0.5, 0})));        // on its left edge
    }
}

// The view is from behind the lamp and the right: each of two people of the same size has his own
// colour, and the nearer hides the farther.
TEST(StageView, shows_people_in_their_colours_the_nearer_before_the_farther) {
    StageView view = aView();
    view.actors = {{box({-0.2f, 0, 2}, {0.2f, 1.7f, 2.2f}), kGreen}, {box({-1, 0, 1}, {1, 1.6f, 1.2f}), kBlue}};
    const Camera ahead{{0, 1, 12}, {0, 1, 0}, 0.5};
    const RgbaImage picture = view.draw(ahead, kWidth, kHeight);
    EXPECT_TRUE(isGreen(at(picture, ahead, {0, 1, 2.2})));
    EXPECT_TRUE(isBlue(at(picture, ahead, {0.8, 0.7, 1.2})));
    std::swap(view.actors[0], view.actors[1]);
    EXPECT_EQ(view.draw(ahead, kWidth, kHeight), picture);
}

// The second screen stands at the right and faces left. It has the same image, mirrored.
TEST(StageView, shows_every_screen_with_its_own_shadow) {
    StageView view = aView();
    view.stage.screens.push_back({{2.5, 3}, -std::numbers::pi / 2});
    view.stage.beams.push_back({{-4, 0, 3}, 1});
    view.images.push_back(
        {theatre::ScreenFrame(view.stage, -2, 2, 0.02, 200, 100, 1), view.images[0].target, view.images[0].shadow});
    for (const Camera& camera : {view.overview(2), view.closeUp(2)}) {
        const RgbaImage picture = view.draw(camera, kWidth, kHeight);
        EXPECT_LT(brightness(at(picture, camera, {1, 0.8, 0})), 250);    // in the first screen's shadow
        EXPECT_GT(brightness(at(picture, camera, {-1, 0.5, 0})), 550);   // beside it
        EXPECT_LT(brightness(at(picture, camera, {2.5, 0.8, 2})), 250);  // 1 m to the left on the second screen
        EXPECT_GT(brightness(at(picture, camera, {2.5, 0.5, 4})), 550);  // in its target
        EXPECT_TRUE(isRed(at(picture, camera, {2.5, 1, 4})));
    }
}

// In each light's shadow, half of the light is missing.
TEST(StageView, two_shadows_on_a_screen_are_twice_as_dark_where_they_meet) {
    StageView view = aView();
    view.stage.beams.push_back({{0.1, 0, 7}, 0});
    const theatre::BitMask shadow = view.images[0].shadow, none(200, 100);
    view.images[0].target = none;
    view.images.push_back({theatre::ScreenFrame(view.stage, -2, 2, 0.02, 200, 100, 1), none, none});
    for (int y = 0; y < 100; ++y) view.images[1].shadow.fill(y, 100, 150);
    const Camera camera{{0, 1, 12}, {0, 1, 0}, 0.5};
    const RgbaImage picture = view.draw(camera, kWidth, kHeight);
    const int bright = brightness(at(picture, camera, {-1, 1.5, 0})), first = brightness(at(picture, camera, {1.25, 0.5, 0})),
              second = brightness(at(picture, camera, {0.5, 1.5, 0})), both = brightness(at(picture, camera, {0.75, 0.5, 0}));
    EXPECT_GT(bright, first + 100);
    EXPECT_GT(bright, second + 100);
    EXPECT_GT(std::min(first, second), both + 100);
}

TEST(StageView, shows_a_curved_screen_where_it_is) {
    for (const double radius : {3.0, -3.0}) {
        StageView view = aView();
        view.stage.screens[0].radius = radius;
        const Camera camera{{0, 3, 9}, {0, 1, 0}, 0.5};
        const RgbaImage picture = view.draw(camera, kWidth, kHeight);
        const auto pixel = [&](const glm::dvec2& unrolled) {
            return at(picture, camera, view.stage.screens[0].surface(unrolled));
        };
        EXPECT_LT(brightness(pixel({1.45, 0.5})), 250) << radius;  // in the shadow, near its edge
        EXPECT_GT(brightness(pixel({1.55, 0.5})), 450) << radius;  // beside it
        EXPECT_TRUE(isRed(pixel({-1.5, 0.5}))) << radius;
        EXPECT_TRUE(isRed(pixel({-1, 1}))) << radius;
    }
}

TEST(StageView, shows_props) {
    StageView view = aView();
    view.props = {{box({-0.3f, 0, 3}, {0.3f, 0.5f, 3.4f}), kGreen}};
    const Camera camera = view.overview(2);
    EXPECT_TRUE(isGreen(at(view.draw(camera, kWidth, kHeight), camera, {0.3, 0.25, 3.2})));
}

// Example failure: people seem to hover, since nothing shows that they stand on the floor.
TEST(StageView, darkens_the_floor_where_something_stands_on_it) {
    StageView view = aView();
    const Camera camera = view.overview(2);
    const glm::dvec3 beside(1.65, 0, 2.5), away(3.5, 0, 2.5);
    const RgbaImage before = view.draw(camera, kWidth, kHeight);
    const auto darker = [&](float bottom, const glm::dvec3& place) {
        view.actors = {{box({1, bottom, 2.2f}, {1.6f, bottom + 1, 2.8f}), kGreen}};
        return brightness(at(before, camera, place)) - brightness(at(view.draw(camera, kWidth, kHeight), camera, place));
    };
    EXPECT_GT(darker(0, beside), 40);
    EXPECT_LT(darker(0.8f, beside), darker(0, beside)) << "less below high things";
    EXPECT_EQ(darker(0, away), 0);
}

TEST(StageView, has_the_lamp_and_all_people_in_its_pictures) {
    StageView view = aView();
    view.stage.beams[0].light = {0.5, 1.2, 6};
    view.actors = {{box({-3, 0, 2}, {-2.6f, 1.7f, 2.2f}), kGreen}};
    for (const Camera& camera : {view.overview(2), view.fromTheSide(2)}) {
        const RgbaImage picture = view.draw(camera, kWidth, kHeight);
        EXPECT_GT(brightness(at(picture, camera, view.stage.beams[0].light)), 680);
        for (const glm::vec3& vertex : view.actors[0].mesh.vertices) {
            const glm::dvec2 pixel = camera.pixelAt(vertex, kWidth, kHeight).value();
            EXPECT_TRUE(pixel.x > 0 && pixel.x < kWidth && pixel.y > 0 && pixel.y < kHeight);
        }
        EXPECT_TRUE(std::any_of(picture.pixels().begin(), picture.pixels().end(), isGreen));
    }
}

TEST(StageView, is_the_same_picture_each_time) {
    StageView view = aView();
    view.actors = {{box({-0.2f, 0, 2}, {0.2f, 1.7f, 2.2f}), kGreen}};
    EXPECT_EQ(view.draw(view.overview(2), kWidth, kHeight), view.draw(view.overview(2), kWidth, kHeight));
}

}  // namespace
}  // namespace fantascope::plot
