// Radiometry that can be computed by hand: a wall of reflectance 0.5 at z = 0 that a camera faces
// squarely.

#include "drivers/site/camera_view.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::site {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kReflectance = 0.5f;

SceneObject sheet(glm::vec3 centre, float half, float reflectance = kReflectance) {
    const glm::vec3 x(half, 0, 0), y(0, half, 0);
    return {{{centre - x - y, centre + x - y, centre + x + y, centre - x + y}, {{0, 1, 2}, {0, 2, 3}}}, glm::vec3(reflectance)};
}

Pose facing(glm::dvec3 position, glm::dvec3 target = {0, 0, 0}) { return Pose::lookingAt(position, target).value(); }

std::shared_ptr<const RgbaImage> plainFrame(glm::ivec2 size, std::uint8_t value) {
    return std::make_shared<const RgbaImage>(size.x, size.y, Rgba8{value, value, value, 255});
}

// A camera of 31 x 31 pixels, three metres from the wall, that sees two metres of it.
const vision::CameraModel kCamera =
    vision::CameraModel::fromFieldOfView(facing({0, 0, 3}), {31, 31}, 2 * std::atan(1.0 / 3)).value();

struct Seen {
    Image<glm::vec3> luminance{kCamera.size.x, kCamera.size.y};
    double at(int x, int y) const { return luminance.at(x, y).g; }
    double middle() const { return at(15, 15); }
};

Seen seen(const CameraView& view, const std::vector<glm::vec3>& levels, const std::vector<ProjectedLight>& light,
          double fog = 0) {
    Seen seen;
    view.render(levels, light, fog, seen.luminance);
    return seen;
}

Lamp lampAt(glm::dvec3 position, double candela) {
    Lamp lamp;
    lamp.position = position;
    lamp.aim = glm::normalize(-position);
    lamp.candela = candela;
    return lamp;
}

double luminanceOf(double lux) { return kReflectance * lux / kPi; }

TEST(SiteLight, a_lamp_lights_a_wall_by_cosine_and_inverse_square) {
    const Scene scene({sheet({0, 0, 0}, 10)});
    CameraView view(scene, kCamera, {0, 0, 0}, {0, 0, 0});
    view.addLamp(lampAt({0, 0, 4}, 100));  // straight on, four metres: 100 / 16 lux
    view.addLamp(lampAt({3, 0, 4}, 100));  // five metres, cosine 4/5: 100 / 25 * 0.8 lux
    EXPECT_NEAR(seen(view, {{1, 1, 1}, {0, 0, 0}}, {}).middle(), luminanceOf(6.25), 1e-3 * luminanceOf(6.25));
    EXPECT_NEAR(seen(view, {{0, 0, 0}, {1, 1, 1}}, {}).middle(), luminanceOf(3.2), 1e-3 * luminanceOf(3.2));
    // Two lights add up, each at its level.
    EXPECT_NEAR(seen(view, {{0.5, 0.5, 0.5}, {0.25, 0.25, 0.25}}, {}).middle(), luminanceOf(3.125 + 0.8), 1e-3);
    EXPECT_EQ(seen(view, {{0, 0, 0}, {0, 0, 0}}, {}).middle(), 0);
}

// Half the intensity at half the beam angle, a tenth at half the field angle, by definition.
TEST(SiteLight, a_lamps_beam_and_field_angles_mean_what_they_say) {
    Lamp lamp = lampAt({0, 0, 1}, 800);
    lamp.beam = 0.5;
    lamp.field = 0.8;
    const auto towards = [&](double angle) { return lamp.intensity({std::sin(angle), 0, -std::cos(angle)}); };
    EXPECT_NEAR(towards(0), 800, 1e-9);
    EXPECT_NEAR(towards(0.25), 400, 1e-6);
    EXPECT_NEAR(towards(0.4), 80, 1e-6);
    EXPECT_LT(towards(kPi), 1e-12);
}

// 900 lumens spread over a picture of 1.5 m x 0.75 m are 800 lux, in its corner as in its middle.
TEST(SiteLight, a_white_picture_spreads_the_projectors_lumens_evenly) {
    const Scene scene({sheet({0, 0, 0}, 10)});
    CameraView view(scene, kCamera, {0, 0, 0}, {0, 0, 0});
    const glm::ivec2 size(200, 100);
    view.addProjector(vision::CameraModel::fromThrowRatio(facing({0, 0, 3}), size, 2, {0, 0}), 900);
    std::vector<ProjectedLight> light{{size, 2.2, 0}};
    light[0].show(plainFrame(size, 255));
    const Seen white = seen(view, {}, light);
    EXPECT_NEAR(white.middle(), luminanceOf(800), 1e-3 * luminanceOf(800));
    EXPECT_NEAR(white.at(4, 10), luminanceOf(800), 1e-3 * luminanceOf(800)) << "near the picture's left edge";
    EXPECT_EQ(white.at(1, 15), 0) << "left of the picture";
    EXPECT_EQ(white.at(15, 8), 0) << "above it";

    light[0].show(plainFrame(size, 128));
    EXPECT_NEAR(seen(view, {}, light).middle(), luminanceOf(800 * std::pow(128.0 / 255, 2.2)), 1e-3 * luminanceOf(800));
}

// However slanted the projector and shifted its lens, all its light arrives: summed over the
// camera's uniform pixels it equals its lumens. Example failure: a cosine too many or too few,
// which a perpendicular view cannot show.
TEST(SiteLight, a_slanted_projectors_light_adds_up_to_its_lumens) {
    const Scene scene({sheet({0, 0, 0}, 10)});
    const auto camera = vision::CameraModel::fromFieldOfView(facing({0, 0, 6}), {160, 160}, 2 * std::atan(0.5)).value();
    CameraView view(scene, camera, {0, 0, 0}, {0, 0, 0});
    const glm::ivec2 size(64, 36);
    view.addProjector(vision::CameraModel::fromThrowRatio(facing({2.5, 1, 3}, {0.2, 0, 0}), size, 1.5, {0.2, 0.4}), 1000);
    std::vector<ProjectedLight> light{{size, 2.2, 0}};
    light[0].show(plainFrame(size, 255));
    Image<glm::vec3> luminance(160, 160);
    view.render({}, light, 0, luminance);
    const double areaOfPixel = std::pow(6 / camera.focal, 2);
    double lumens = 0;
    for (const glm::vec3& pixel : luminance.pixels()) lumens += pixel.g * kPi / kReflectance * areaOfPixel;
    EXPECT_NEAR(lumens, 1000, 5);
}

// Camera pixel by camera pixel: the light of each projector pixel falls where the two models say.
TEST(SiteLight, a_projector_pixel_is_seen_where_the_models_say) {
    const Scene scene({sheet({0, 0, 0}, 10)});
    CameraView view(scene, kCamera, {0, 0, 0}, {0, 0, 0});
    const glm::ivec2 size(64, 64);
    const auto projector = vision::CameraModel::fromThrowRatio(facing({1.5, 1, 3}), size, 1.7, {0, 0});
    view.addProjector(projector, 900);
    std::vector<ProjectedLight> light{{size, 2.2, 0}};
    for (const glm::ivec2 lit : {glm::ivec2(20, 20), glm::ivec2(40, 24), glm::ivec2(33, 45)}) {
        RgbaImage frame(64, 64, {0, 0, 0, 255});
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) frame.at(lit.x + x, lit.y + y) = {255, 255, 255, 255};
        light[0].show(std::make_shared<const RgbaImage>(frame));
        const Seen picture = seen(view, {}, light);
        glm::dvec2 centre(0.0);
        double sum = 0;
        for (int y = 0; y < 31; ++y)
            for (int x = 0; x < 31; ++x) {
                centre += picture.at(x, y) * glm::dvec2(x + 0.5, y + 0.5);
                sum += picture.at(x, y);
            }
        ASSERT_GT(sum, 0);
        const auto onWall = vision::Plane{}.hitBy(projector.rayThrough(glm::dvec2(lit) + 0.5));
        const auto expected = kCamera.pixelFromWorld(onWall.value());
        EXPECT_NEAR(centre.x / sum, expected->x, 0.15);
        EXPECT_NEAR(centre.y / sum, expected->y, 0.15);
    }
}

// A projector's pixels are finer than the camera's. Taking only one of them per camera pixel would
// turn fine patterns into moire.
TEST(SiteLight, fine_patterns_average_in_linear_light) {
    const Scene scene({sheet({0, 0, 0}, 10)});
    CameraView view(scene, kCamera, {0, 0, 0}, {0, 0, 0});
    const glm::ivec2 size(512, 512);  // twelve times finer than the camera's
    view.addProjector(vision::CameraModel::fromThrowRatio(facing({0, 0, 3}), size, 1, {0, 0}), 900);
    std::vector<ProjectedLight> light{{size, 2.2, 0}};
    light[0].show(plainFrame(size, 255));
    const double white = seen(view, {}, light).middle();
    RgbaImage stripes(512, 512, {0, 0, 0, 255});
    for (int y = 0; y < 512; ++y)
        for (int x = 0; x < 512; ++x)
            if (x % 3 == 0) stripes.at(x, y) = {255, 255, 255, 255};
    light[0].show(std::make_shared<const RgbaImage>(stripes));
    const Seen grey = seen(view, {}, light);
    for (int y = 5; y < 26; ++y)
        for (int x = 5; x < 26; ++x) EXPECT_NEAR(grey.at(x, y), white / 3, 0.05 * white) << x << " " << y;
}

TEST(SiteLight, an_object_casts_its_shadow_in_every_light) {
    // A sheet of 0.4 m, one metre in front of the wall. The lights stand to the right, so the
    // shadow lies to the left.
    const Scene scene({sheet({0, 0, 0}, 10), sheet({0, 0, 1}, 0.2f)});
    CameraView view(scene, kCamera, {0, 0, 0}, {0, 0, 0});
    view.addLamp(lampAt({1.5, 0, 3}, 100));
    const glm::ivec2 size(64, 64);
    view.addProjector(vision::CameraModel::fromThrowRatio(facing({1.5, 0, 3}), size, 1, {0, 0}), 900);
    std::vector<ProjectedLight> light{{size, 2.2, 0}};
    light[0].show(plainFrame(size, 255));
    // The line from the light through the sheet's middle meets the wall at x = -0.75: pixel 15.5 -
    // 0.75 * 15.5.
    const int shadow = 3, lit = 27;
    for (const Seen& picture : {seen(view, {glm::vec3(1)}, {{size, 2.2, 0}}), seen(view, {glm::vec3(0)}, light)}) {
        EXPECT_EQ(picture.at(shadow, 15), 0);
        EXPECT_GT(picture.at(lit, 15), 0.05);
        EXPECT_GT(picture.at(shadow, 28), 0.05) << "below the shadow";
    }
}

// A black pixel of a running projector is brighter than no projector at all.
TEST(SiteLight, black_leaks_but_a_dark_projector_gives_nothing) {
    const Scene scene({sheet({0, 0, 0}, 10)});
    CameraView view(scene, kCamera, {0, 0, 0}, {0, 0, 0});
    const glm::ivec2 size(64, 64);
    view.addProjector(vision::CameraModel::fromThrowRatio(facing({0, 0, 3}), size, 1, {0, 0}), 900);  // 100 lux
    std::vector<ProjectedLight> light{{size, 2.2, 0.01}};
    EXPECT_EQ(seen(view, {}, light).middle(), 0);
    light[0].show(plainFrame(size, 0));
    EXPECT_NEAR(seen(view, {}, light).middle(), luminanceOf(1), 1e-4);
    light[0].show(plainFrame(size, 255));
    EXPECT_NEAR(seen(view, {}, light).middle(), luminanceOf(100), 1e-2);
    light[0].show(nullptr);
    EXPECT_EQ(seen(view, {}, light).middle(), 0);
}

// The lamps and filters of two projectors are never of one colour.
TEST(SiteLight, a_projectors_white_has_its_own_colour_and_so_has_its_black) {
    ProjectedLight light({64, 64}, 2, 0.1, {1, 0.5f, 0.8f});
    const auto place = ProjectedLight::placeOf({64, 64}, {20, 20}, 1);
    light.show(plainFrame({64, 64}, 255));
    EXPECT_EQ(glm::vec3(light.at(place)), glm::vec3(1, 0.5f, 0.8f));
    light.show(plainFrame({64, 64}, 0));
    EXPECT_EQ(glm::vec3(light.at(place)), 0.1f * glm::vec3(1, 0.5f, 0.8f));
}

// A real window may have another size than in the site file; the projector scales it.
TEST(SiteLight, a_frame_of_another_size_fills_the_picture) {
    ProjectedLight light({64, 64}, 1, 0);
    RgbaImage halves(20, 10, {0, 0, 0, 255});
    for (int y = 0; y < 10; ++y)
        for (int x = 10; x < 20; ++x) halves.at(x, y) = {255, 255, 255, 255};
    light.show(std::make_shared<const RgbaImage>(halves));
    EXPECT_NEAR(light.at(ProjectedLight::placeOf({64, 64}, {10, 50}, 1)).r, 0, 1e-6);
    EXPECT_NEAR(light.at(ProjectedLight::placeOf({64, 64}, {55, 10}, 1)).r, 1, 1e-6);
    EXPECT_NEAR(light.mean().r, 0.5, 0.01);
}

// Beer's law over the whole path; and what the fog takes from ambient light returns as a veil over
// distant surfaces.
TEST(SiteLight, fog_weakens_light_on_its_way_and_lays_a_veil) {
    const Scene scene({sheet({0, 0, 0}, 10)});
    CameraView ambient(scene, kCamera, {20, 20, 20}, {0, 0, 0});
    const double left = std::exp(-0.1 * 3);  // from the wall to the camera
    EXPECT_NEAR(seen(ambient, {}, {}).middle(), luminanceOf(20), 1e-4);
    EXPECT_NEAR(seen(ambient, {}, {}, 0.1).middle(), luminanceOf(20) * left + 20 / (4 * kPi) * (1 - left), 1e-3);

    // On a black wall only the veil is visible, more of it in thicker fog. On a bright wall the
    // lamp's light is weakened, too.
    const Scene black({sheet({0, 0, 0}, 10, 0)});
    CameraView lampOnBlack(black, kCamera, {0, 0, 0}, {0, 0, 0}), lampOnWall(scene, kCamera, {0, 0, 0}, {0, 0, 0});
    lampOnBlack.addLamp(lampAt({0, 0, 4}, 100));
    lampOnWall.addLamp(lampAt({0, 0, 4}, 100));
    const std::vector<glm::vec3> on{glm::vec3(1)};
    const double veil = seen(lampOnBlack, on, {}, 0.1).middle();
    EXPECT_GT(veil, 0);
    EXPECT_GT(seen(lampOnBlack, on, {}, 0.3).middle(), 1.5 * veil);
    EXPECT_NEAR(seen(lampOnWall, on, {}, 0.1).middle() - veil, luminanceOf(6.25) * std::exp(-0.1 * (4 + 3)), 2e-3);
}

TEST(SiteLight, a_moved_projector_lights_as_if_it_had_always_stood_there) {
    const Scene scene({sheet({0, 0, 0}, 10), sheet({0, 0, 1}, 0.2f)});
    const glm::ivec2 size(64, 64);
    const auto here = vision::CameraModel::fromThrowRatio(facing({0, 0, 3}), size, 1, {0, 0});
    const auto there = vision::CameraModel::fromThrowRatio(facing({1, 0.5, 3}), size, 1, {0, 0});
    CameraView moved(scene, kCamera, {1, 1, 1}, {0, 0, 0}), placed(scene, kCamera, {1, 1, 1}, {0, 0, 0});
    moved.addProjector(here, 900);
    placed.addProjector(there, 900);
    std::vector<ProjectedLight> light{{size, 2.2, 0}};
    light[0].show(plainFrame(size, 200));
    EXPECT_NE(seen(moved, {}, light).luminance, seen(placed, {}, light).luminance);
    moved.moveProjector(0, there);
    EXPECT_EQ(seen(moved, {}, light).luminance, seen(placed, {}, light).luminance);
}

// A lit street lamp appears as a bright spot in its place, but not through a wall.
TEST(SiteLight, a_lamps_head_is_seen) {
    Lamp lamp = lampAt({0.5, 0.5, 0.5}, 100);
    lamp.aim = {0, 0, 1};  // at the camera
    lamp.radius = 0.02;
    const Scene open({sheet({0, 0, 0}, 10)}), hidden({sheet({0, 0, 0}, 10), sheet({0.4f, 0.4f, 1}, 0.1f)});
    CameraView view(open, kCamera, {0, 0, 0}, {0, 0, 0}), behind(hidden, kCamera, {0, 0, 0}, {0, 0, 0});
    view.addLamp(lamp);
    behind.addLamp(lamp);
    const glm::ivec2 pixel = kCamera.pixelFromWorld(lamp.position).value();
    EXPECT_GT(seen(view, {glm::vec3(1)}, {}).at(pixel.x, pixel.y), 1000);
    EXPECT_LT(seen(view, {glm::vec3(1)}, {}).at(pixel.x - 3, pixel.y), 10);
    EXPECT_LT(seen(behind, {glm::vec3(1)}, {}).at(pixel.x, pixel.y), 10);
}

}  // namespace
}  // namespace fantascope::site
