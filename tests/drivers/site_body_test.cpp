// People in the simulated site: their shape, what they hide, and the shadow that they throw.

#include "drivers/site/camera_view.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::site {
namespace {

constexpr double kPi = std::numbers::pi;

glm::dvec3 somewhere(Rng& rng, double reach) {
    return {rng.uniform(-reach, reach), rng.uniform(-reach, reach), rng.uniform(-reach, reach)};
}

// Compared with steps along the ray. Example failure: the ball at the wrong end, or the far side of
// the cylinder.
TEST(SiteCapsule, is_met_where_a_ray_first_comes_within_its_radius) {
    Rng rng(1);
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
        Capsule capsule{somewhere(rng, 1), somewhere(rng, 1), rng.uniform(0.05, 0.5)};
        if (i % 5 == 0) capsule.to = capsule.from;
        const glm::dvec3 origin = somewhere(rng, 4), direction = glm::normalize(somewhere(rng, 1) - origin);
        if (capsule.contains(origin)) continue;
        double expected = -1;
        for (double at = 0; at < 10 && expected < 0; at += 0.002)
            if (capsule.contains(origin + direction * at)) expected = at;
        const auto distance = capsule.metBy(origin, direction);
        if (expected < 0) {
            const Capsule within{capsule.from, capsule.to, capsule.radius - 1e-4};
            EXPECT_FALSE(distance && within.metBy(origin, direction)) << i << ": a step misses only what is grazed";
            continue;
        }
        ++met;
        ASSERT_TRUE(distance) << i;
        EXPECT_NEAR(*distance, expected, 0.0021) << i;
    }
    EXPECT_GT(met, 200);
    const Capsule upright{{0, 0, 0}, {0, 1, 0}, 0.25};
    EXPECT_NEAR(upright.metBy({0, 5, 0}, {0, -1, 0}).value(), 3.75, 1e-12) << "along its axis";
    EXPECT_FALSE(upright.metBy({0, 5, 0}, {0, 1, 0})) << "it lies behind";
    EXPECT_NEAR(glm::distance(upright.normalAt({0.25, 0.5, 0}), {1, 0, 0}), 0, 1e-12);
}

TEST(SiteBody, stands_on_the_ground_as_high_as_it_is) {
    const Body body = Body::standing({3, 0, -2}, {0, 0, 1}, 1.8, glm::dvec3(0.3));
    double low = 9, high = -9, width = 0;
    Rng rng(2);
    for (const Capsule& part : body.parts) {
        for (const glm::dvec3 end : {part.from, part.to}) {
            low = std::min(low, end.y - part.radius);
            high = std::max(high, end.y + part.radius);
            width = std::max(width, std::abs(end.x - 3) + part.radius);
            EXPECT_EQ(end.z, -2);
            for (int i = 0; i < 100; ++i)
                EXPECT_TRUE(body.around.contains(end + glm::normalize(somewhere(rng, 1)) * part.radius));
        }
    }
    EXPECT_NEAR(low, 0, 1e-12);
    EXPECT_NEAR(high, 1.8, 1e-12);
    EXPECT_NEAR(width, 0.16 * 1.8, 1e-9) << "the arms, on either side of its way";
}

// A wall of reflectance 0.5 at z = 0, and a camera that sees four metres of it in 120 x 120 pixels.
class BodiesBeforeAWall : public testing::Test {
protected:
    static SceneObject sheet(glm::vec3 centre, float half) {
        const glm::vec3 x(half, 0, 0), y(0, half, 0);
        return {{{centre - x - y, centre + x - y, centre + x + y, centre - x + y}, {{0, 1, 2}, {0, 2, 3}}}, glm::vec3(0.5f)};
    }
    static Body at(double x, double z, double reflectance = 0.3) {
        return Body::standing({x, 0, z}, {0, 0, 1}, 1.75, glm::dvec3(reflectance));
    }
    Image<glm::vec3> seen(CameraView& view, const std::vector<Body>& bodies, const std::vector<glm::vec3>& levels = {},
                          double fog = 0) const {
        Image<glm::vec3> luminance(120, 120);
        Lighting lighting{levels, light_, fog};
        lighting.bodies = bodies;
        view.render(lighting, {0, 120}, luminance);
        return luminance;
    }
    // The pixel that shows a point.
    glm::ivec2 pixelOf(glm::dvec3 point) const { return glm::ivec2(camera_.pixelFromWorld(point).value()); }
    float lightOf(const Image<glm::vec3>& image, glm::dvec3 point) const {
        const glm::ivec2 pixel = pixelOf(point);
        return image.at(pixel.x, pixel.y).g;
    }
    void project(CameraView& view, glm::dvec3 from) {
        const auto pose = Pose::lookingAt(from, {0, 1, 0}).value();
        view.addProjector(vision::CameraModel::fromThrowRatio(pose, {128, 128}, 1, {0, 0}), 1000);
        light_.emplace_back(glm::ivec2(128, 128), 2.2, 0);
        light_.back().show(std::make_shared<const RgbaImage>(128, 128, Rgba8{255, 255, 255, 255}));
    }

    const Scene wall_{{sheet({0, 0, 0}, 10)}};
    const vision::CameraModel camera_ =
        vision::CameraModel::fromFieldOfView(Pose::lookingAt({0, 1, 5}, {0, 1, 0}).value(), {120, 120}, 2 * std::atan(2.0 / 5))
            .value();
    std::vector<ProjectedLight> light_;
};

TEST_F(BodiesBeforeAWall, hide_it_and_show_their_own_surface) {
    CameraView view(wall_, camera_, glm::dvec3(2), {0, 0, 0});
    view.expectBodies();
    const auto without = seen(view, {}), with = seen(view, {at(0.5, 2)});
    int changed = 0, top = 120, bottom = 0;
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 120; ++x)
            if (with.at(x, y) != without.at(x, y)) {
                ++changed;
                top = std::min(top, y);
                bottom = std::max(bottom, y);
            }
    EXPECT_NEAR(lightOf(with, {0.5, 1.2, 2.17}), 0.3 * 2 / kPi, 1e-5);
    EXPECT_NEAR(lightOf(without, {0.5, 1.2, 2.17}), 0.5 * 2 / kPi, 1e-5);
    const double pixelsPerMetre = camera_.focal / 3;
    EXPECT_NEAR(top, 60 - 0.75 * pixelsPerMetre, 1.5);
    EXPECT_NEAR(bottom, 60 + 1 * pixelsPerMetre, 1.5);
    // Legs 0.52 x 0.1 twice, trunk 0.42 x 0.2, arms 0.44 x 0.06 twice, head: shares of the height's
    // square, less what overlaps.
    EXPECT_NEAR(changed / (pixelsPerMetre * pixelsPerMetre * 1.75 * 1.75), 0.23, 0.03);
}

TEST_F(BodiesBeforeAWall, are_hidden_by_what_is_before_them) {
    const Scene scene({sheet({0, 0, 0}, 10), sheet({0, 1, 3}, 3)});
    CameraView view(scene, camera_, glm::dvec3(2), {0, 0, 0});
    view.expectBodies();
    EXPECT_EQ(seen(view, {at(0.5, 2)}), seen(view, {}));
    EXPECT_NE(seen(view, {at(0.5, 3.5)}), seen(view, {}));
    EXPECT_EQ(seen(view, {at(0.5, 8)}), seen(view, {})) << "behind the camera";
    EXPECT_EQ(seen(view, {at(9, 4)}), seen(view, {})) << "beside the picture";
}

// Example failure: the last one wins.
TEST_F(BodiesBeforeAWall, hide_each_other_by_distance) {
    CameraView view(wall_, camera_, glm::dvec3(2), {0, 0, 0});
    view.expectBodies();
    const Body near = at(0, 3, 0.2), far = at(0.1, 1, 0.8);
    const auto first = seen(view, {near, far}), second = seen(view, {far, near});
    for (std::size_t i = 0; i < first.pixels().size(); ++i)
        EXPECT_NEAR(first.pixels()[i].g, second.pixels()[i].g, 1e-6) << "pixel " << i;
    EXPECT_NEAR(lightOf(seen(view, {far, near}), {0, 1.2, 3.17}), 0.2 * 2 / kPi, 1e-5);
}

// The projector stands to the right, so the shadow of the head lies to the left of the head.
TEST_F(BodiesBeforeAWall, throw_their_shadow_into_a_projectors_light) {
    CameraView view(wall_, camera_, glm::dvec3(0), {0, 0, 0});
    const glm::dvec3 lens(3, 1, 5);
    project(view, lens);
    view.expectBodies();
    const Body body = at(0.8, 2);
    const auto without = seen(view, {}), with = seen(view, {body});
    const auto onWall = [&](glm::dvec3 point) { return lens + (point - lens) * (lens.z / (lens.z - point.z)); };
    const Capsule &head = body.parts[5], &arm = body.parts[3];
    const glm::dvec3 shadow = onWall(head.from);
    EXPECT_EQ(lightOf(with, shadow), 0);
    EXPECT_GT(lightOf(without, shadow), 1);
    EXPECT_EQ(lightOf(with, onWall(arm.to)), 0);
    EXPECT_EQ(lightOf(with, shadow + glm::dvec3(-0.35, 0, 0)), lightOf(without, shadow + glm::dvec3(-0.35, 0, 0)));
    EXPECT_EQ(lightOf(with, shadow + glm::dvec3(0, 0.4, 0)), lightOf(without, shadow + glm::dvec3(0, 0.4, 0)));
    EXPECT_EQ(seen(view, {at(4, 5.5)}), without) << "behind the projector";
    EXPECT_EQ(seen(view, {}), without);
}

// A projector and a lamp in the camera's place light the trunk squarely.
TEST_F(BodiesBeforeAWall, are_lit_by_projectors_and_lamps) {
    CameraView view(wall_, camera_, glm::dvec3(0), {0, 0, 0});
    Lamp lamp;
    lamp.position = {0, 1, 5};
    lamp.aim = {0, 0, -1};
    lamp.candela = 90;
    view.addLamp(lamp);
    view.expectBodies();
    const glm::dvec3 chest(0, 1, 2.175);
    const double near = 5 - 2.175;
    const auto byLamp = seen(view, {at(0, 2)}, {glm::vec3(1)});
    EXPECT_NEAR(lightOf(byLamp, chest), 0.3 / kPi * 90 / (near * near), 0.03);
    EXPECT_NEAR(lightOf(seen(view, {at(0, 2)}, {glm::vec3(1)}, 0.1), chest),
                0.3 / kPi * 90 / (near * near) * std::exp(-0.1 * 2 * near), 0.2);

    project(view, {0, 1, 5});  // a square of the distance's width: its lumens over that
    const auto byBoth = seen(view, {at(0, 2)}, {glm::vec3(1)});
    EXPECT_NEAR(lightOf(byBoth, chest) - lightOf(byLamp, chest), 0.3 / kPi * 1000 / (near * near), 0.3);
}

// The other one stands beside the picture, between the projector and the first.
TEST_F(BodiesBeforeAWall, stand_in_each_others_shadow) {
    CameraView view(wall_, camera_, glm::dvec3(0), {0, 0, 0});
    project(view, {3, 1, 5});
    view.expectBodies();
    const glm::dvec3 chest(0.1, 1, 2.13);
    EXPECT_GT(lightOf(seen(view, {at(0, 2)}), chest), 1);
    EXPECT_EQ(lightOf(seen(view, {at(0, 2), at(1.5, 3.5)}), chest), 0);
}

TEST_F(BodiesBeforeAWall, stand_in_the_shadow_of_the_scene) {
    const Scene scene({sheet({0, 0, 0}, 10), sheet({3, 1, 4}, 1)});
    CameraView view(scene, camera_, glm::dvec3(0), {0, 0, 0});
    Lamp lamp;
    lamp.position = {4, 1, 5};
    lamp.aim = glm::normalize(glm::dvec3(-4, 0, -3));
    lamp.beam = 1;
    lamp.field = 1.5;
    view.addLamp(lamp);
    view.expectBodies();
    EXPECT_EQ(lightOf(seen(view, {at(0, 2)}, {glm::vec3(1)}), {0.1, 1, 2.17}), 0);
}

// Example failure: a moved projector is asked about the points that it lit before.
TEST_F(BodiesBeforeAWall, throw_their_shadow_where_a_moved_projector_shines) {
    CameraView moved(wall_, camera_, glm::dvec3(1), {0, 0, 0}), placed(wall_, camera_, glm::dvec3(1), {0, 0, 0});
    project(placed, {-2, 1, 5});
    light_.clear();
    project(moved, {2, 1, 5});
    moved.expectBodies();
    placed.expectBodies();
    moved.moveProjector(
        0, vision::CameraModel::fromThrowRatio(Pose::lookingAt({-2, 1, 5}, {0, 1, 0}).value(), {128, 128}, 1, {0, 0}));
    EXPECT_EQ(seen(moved, {at(0, 2)}), seen(placed, {at(0, 2)}));
}

// The camera exposes its rows in bands; together they are the picture.
TEST_F(BodiesBeforeAWall, look_the_same_in_bands_as_at_once) {
    CameraView view(wall_, camera_, glm::dvec3(1), {0, 0, 0});
    project(view, {2, 1.5, 5});
    view.expectBodies();
    const std::vector<Body> bodies{at(0.5, 2), at(-0.6, 1), at(0.3, 3)};
    Image<glm::vec3> banded(120, 120);
    Lighting lighting{{}, light_, 0.02};
    lighting.bodies = bodies;
    for (int band = 0; band < 7; ++band) view.render(lighting, {120 * band / 7, 120 * (band + 1) / 7}, banded);
    EXPECT_EQ(banded, seen(view, bodies, {}, 0.02));
}

}  // namespace
}  // namespace fantascope::site
