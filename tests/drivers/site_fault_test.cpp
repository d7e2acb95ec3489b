// What goes wrong at the simulated site with light, projectors and the camera, as the camera sees
// it. Unplugging, freezing, bumps of projectors and fog: see site_simulated_site_test.cpp.

#include "drivers/simulated_stage.h"
#include "drivers/site/fault.h"
#include "drivers/site/projected_light.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

namespace fantascope::site {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kBright = "white: 0.4, read_noise: 0, shot_noise: 0";  // the wall in ambient light has 0.159 cd/m2
constexpr glm::ivec2 kLeft(13, 12), kRight(34, 12), kBetween(24, 12);

double greenAt(const RgbaImage& image, glm::ivec2 pixel) { return linear(image.at(pixel.x, pixel.y).g); }

TEST(SiteFault, a_dim_projector_gives_a_share_of_its_light) {
    Stage stage("faults: [{kind: dim, output: left, at: 1, until: 3, level: 0.25, rise: 1}]");
    const double dark = greenAt(stage.pictureAt(200ms), kLeft);
    stage.show("left", 255);
    stage.show("right", 255);
    const RgbaImage full = stage.pictureAt(500ms);
    const auto share = [&](Time time) { return (greenAt(stage.pictureAt(time), kLeft) - dark) / (greenAt(full, kLeft) - dark); };
    EXPECT_NEAR(share(1500ms), 0.625, 0.01) << "half way to a quarter";
    const RgbaImage dim = stage.pictureAt(2500ms);
    EXPECT_NEAR((greenAt(dim, kLeft) - dark) / (greenAt(full, kLeft) - dark), 0.25, 0.01);
    EXPECT_EQ(greenAt(dim, kRight), greenAt(full, kRight));
    EXPECT_NEAR(share(3500ms), 0.625, 0.01);
    EXPECT_EQ(stage.pictureAt(4s), full);
}

// An edge becomes the integral of a Gaussian, in light and not in stored values.
TEST(SiteFault, a_projector_out_of_focus_blurs_its_light) {
    RgbaImage halves(64, 64, {0, 0, 0, 255});
    for (int y = 0; y < 64; ++y)
        for (int x = 32; x < 64; ++x) halves.at(x, y) = {255, 255, 255, 255};
    const auto frame = std::make_shared<const RgbaImage>(halves);
    ProjectedLight light({64, 64}, 2.2, 0);
    light.show(frame, 3);
    for (const double x : {25.5, 30.5, 33.5, 38.5})
        EXPECT_NEAR(light.at(ProjectedLight::placeOf({64, 64}, {x, 20}, 1)).g,
                    0.5 * (1 + std::erf((x - 32) / 3 / std::sqrt(2.0))), 5e-3);
    EXPECT_NEAR(light.mean().g, 0.5, 1e-3);
    light.show(frame);
    EXPECT_EQ(light.at(ProjectedLight::placeOf({64, 64}, {30.5, 20}, 1)).g, 0) << "the same frame, sharp again";

    Stage stage("faults: [{kind: defocus, output: left, at: 1, until: 2, blur: 8}]");
    stage.world_.setFrame("left", frame);
    const RgbaImage sharp = stage.pictureAt(500ms), soft = stage.pictureAt(1500ms);
    EXPECT_GT(greenAt(soft, {12, 12}), greenAt(sharp, {12, 12}) + 0.05);
    EXPECT_EQ(stage.pictureAt(2500ms), sharp);
}

TEST(SiteFault, a_projector_at_another_input_shows_that_picture) {
    const ScratchFolder folder;
    ASSERT_TRUE(writePng(folder / "menu.png", RgbaImage(32, 32, {0, 0, 255, 255})));
    Stage stage(
        "faults: [{kind: input, output: left, at: 1, until: 3, picture: menu.png}, {kind: unplug, device: left, at: 2, until: "
        "2.5}]",
        kNoiseless, 1, folder / "site.yaml");
    const RgbaImage dark = stage.pictureAt(500ms), menu = stage.pictureAt(1500ms);
    EXPECT_GT(menu.at(kLeft.x, kLeft.y).b, 100) << "without any frame of ours";
    EXPECT_LT(menu.at(kLeft.x, kLeft.y).g, 40);
    stage.show("left", 255);
    EXPECT_EQ(stage.pictureAt(1800ms), menu);
    EXPECT_EQ(stage.pictureAt(2200ms), dark) << "without power there is no menu either";
    EXPECT_EQ(stage.pictureAt(2800ms), menu);
    stage.show("left", 255);
    EXPECT_GT(stage.pictureAt(3200ms).at(kLeft.x, kLeft.y).g, 100);
    EXPECT_THAT(told(*stage.site_), ElementsAre("1.0 projector left shows menu.png instead of our picture", "2.0 left unplugged",
                                                "2.5 left plugged in again", "3.0 projector left shows our picture again"));
}

TEST(SiteFault, ambient_light_grows_and_fades) {
    Stage stage("faults: [{kind: ambient, at: 1, until: 3, level: 2, rise: 1}]", kBright);
    const RgbaImage before = stage.pictureAt(500ms);
    const double night = greenAt(before, kBetween);
    EXPECT_NEAR(night, 0.5 / std::numbers::pi / 0.4, 0.005);
    EXPECT_NEAR(greenAt(stage.pictureAt(1500ms), kBetween), 1.5 * night, 0.01);
    EXPECT_NEAR(greenAt(stage.pictureAt(2s), kBetween), 2 * night, 0.01);
    EXPECT_NEAR(greenAt(stage.pictureAt(3700ms), kBetween), 1.3 * night, 0.01);
    EXPECT_EQ(stage.pictureAt(4s), before);
}

// At 2.5 Hz, pictures at tenths of a second see the cosine at its quarters.
TEST(SiteFault, street_lamps_flicker_with_the_mains) {
    Stage stage("faults: [{kind: flicker, at: 0, until: 3, depth: 0.8, frequency: 2.5}]",
                "white: 5, read_noise: 0, shot_noise: 0");
    stage.world_.setRelays("road", {false, true});
    const auto red = [&](Time time) {
        const RgbaImage image = stage.pictureAt(time);
        return linear(image.at(kBetween.x, kBetween.y).r);
    };
    const double low = red(200ms), high = red(400ms), half = red(700ms);
    const double ambient = 0.5 / std::numbers::pi / 5;
    EXPECT_NEAR((low - ambient) / (high - ambient), 0.2, 0.02);
    EXPECT_NEAR((half - ambient) / (high - ambient), 0.6, 0.02);
    EXPECT_NEAR(red(3400ms), high, 0.005);

    Fault fault;
    fault.kind = Fault::Kind::Flicker;
    fault.device = "north";
    fault.depth = 0.5;
    fault.frequency = 1;
    EXPECT_NEAR(flickerAt(std::span(&fault, 1), "north", 500ms), 0.5, 1e-12);
    EXPECT_EQ(flickerAt(std::span(&fault, 1), "south", 500ms), 1);
}

// Half a period passes from the first row to the last.
TEST(SiteFault, each_band_of_rows_sees_a_lamp_at_its_own_moment) {
    Stage stage("faults: [{kind: flicker, relay: road, at: 0, depth: 1, frequency: 5}]",
                "white: 5, read_noise: 0, shot_noise: 0, rolling: 0.0999");
    stage.world_.setRelays("road", {false, true});
    stage.advanceTo(0ms);
    stage.advanceTo(100ms);
    stage.clock_.advanceTo(190ms);
    const auto frame = stage.world_.takeFromCamera();
    ASSERT_NE(frame, nullptr);
    const RgbaImage& image = frame->image;
    const double ambient = 0.5 / std::numbers::pi / 5;
    EXPECT_NEAR(linear(image.at(24, 23).r), ambient, 0.005);
    for (int y = 3; y < 24; y += 3) EXPECT_LT(image.at(24, y).r, image.at(24, y - 1).r) << "a new band begins at row " << y;
    EXPECT_GT(linear(image.at(24, 0).r), 5 * ambient);
}

// The column around which the light of the left picture lies.
double middle(const RgbaImage& image) {
    double sum = 0, weight = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const double light = std::max(0.0, greenAt(image, {x, y}) - 0.05);
            sum += light * (x + 0.5);
            weight += light;
        }
    return sum / weight;
}

// Example failure: the projector that was bumped before stands in its old place for the camera.
TEST(SiteFault, a_bumped_camera_sees_all_from_its_new_place) {
    Stage stage(R"(faults:
  - {kind: bump, output: left, at: 1, turn: [0, 3, 0]}
  - {kind: camera_bump, at: 2, until: 3, move: [0.2, 0, 0]}
  - {kind: camera_bump, at: 4, until: 5, turn: [0, -2, 0]}
)");
    stage.show("left", 255);
    const RgbaImage before = stage.pictureAt(1500ms);
    const double focal = 24 / std::tan(0.5);
    EXPECT_NEAR(middle(stage.pictureAt(2500ms)) - middle(before), -focal * 0.2 / 4, 0.2) << "the camera went right";
    EXPECT_EQ(stage.pictureAt(3500ms), before);
    EXPECT_NEAR(middle(stage.pictureAt(4500ms)) - middle(before), focal * std::tan(2 * std::numbers::pi / 180), 0.3)
        << "the camera turned to the left";
    EXPECT_EQ(stage.pictureAt(5500ms), before);
}

TEST(SiteFault, something_covers_a_part_of_the_cameras_picture) {
    Stage stage(
        "faults: [{kind: cover, at: 1, until: 2, rectangle: [0.5, 0.25, 1, 0.75], reflectance: [0.2, 0.2, 0.2], luminance: [0, "
        "0.1, 0]}]",
        kBright);
    const RgbaImage before = stage.pictureAt(500ms), covered = stage.pictureAt(1500ms);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 48; ++x) {
            if (x < 24 || y < 6 || y >= 18) {
                ASSERT_EQ(covered.at(x, y), before.at(x, y)) << x << " " << y;
                continue;
            }
            ASSERT_NEAR(greenAt(covered, {x, y}), (0.2 / std::numbers::pi + 0.1) / 0.4, 0.005);
            ASSERT_NEAR(linear(covered.at(x, y).r), 0.2 / std::numbers::pi / 0.4, 0.005);
        }
    EXPECT_EQ(stage.pictureAt(2500ms), before);
}

// The veil is a share of the picture's mean light.
TEST(SiteFault, a_dirty_lens_blurs_and_veils) {
    Stage stage("faults: [{kind: dirt, at: 1, until: 3, veil: 0.5, rise: 1}, {kind: dirt, at: 5, until: 6, blur: 2}]",
                "white: 80, read_noise: 0, shot_noise: 0");
    stage.show("left", 255);
    const auto mean = [](const RgbaImage& image) {
        double sum = 0;
        for (const Rgba8 pixel : image.pixels()) sum += linear(pixel.g);
        return sum / static_cast<double>(image.pixels().size());
    };
    constexpr glm::ivec2 kCorner(46, 1);
    const RgbaImage clean = stage.pictureAt(500ms), half = stage.pictureAt(1500ms), dirty = stage.pictureAt(2500ms);
    const double light = mean(clean);
    EXPECT_NEAR(mean(half), 1.25 * light, 0.01 * light);
    EXPECT_NEAR(mean(dirty), 1.5 * light, 0.01 * light);
    EXPECT_NEAR(greenAt(dirty, kCorner) - greenAt(clean, kCorner), 0.5 * light, 0.003) << "far from the light";
    EXPECT_EQ(stage.pictureAt(4s), clean);

    const RgbaImage blurred = stage.pictureAt(5500ms);
    EXPECT_NEAR(mean(blurred), light, 0.02 * light);
    EXPECT_EQ(greenAt(blurred, kCorner), greenAt(clean, kCorner));
    EXPECT_LT(greenAt(blurred, {7, 12}), greenAt(clean, {7, 12}) - 0.02) << "just inside the projected picture";
    EXPECT_EQ(stage.pictureAt(6500ms), clean);
}

TEST(SiteFault, a_blind_camera_sees_one_value) {
    Stage stage(R"(faults:
  - {kind: blind, at: 1, until: 2, level: 0}
  - {kind: blind, at: 2, until: 3, level: 1}
  - {kind: blind, at: 3, until: 4, level: 0.5}
)",
                "white: 40, read_noise: 0.05");
    const auto grey = [](std::uint8_t value) { return Each(Rgba8{value, value, value, 255}); };
    EXPECT_THAT(stage.pictureAt(1500ms).pixels(), grey(0));
    EXPECT_THAT(stage.pictureAt(2500ms).pixels(), grey(255));
    EXPECT_THAT(stage.pictureAt(3500ms).pixels(), grey(128));
    EXPECT_THAT(stage.pictureAt(4500ms).pixels(), testing::Not(grey(128)));
}

TEST(SiteFault, a_camera_upside_down_turns_its_picture) {
    Stage stage("faults: [{kind: upside_down, at: 1, until: 2}]");
    stage.show("left", 255);
    stage.setSlot(10, 30);
    const RgbaImage upright = stage.pictureAt(500ms), turned = stage.pictureAt(1500ms);
    EXPECT_NE(turned, upright);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 48; ++x) ASSERT_EQ(turned.at(x, y), upright.at(47 - x, 23 - y)) << x << " " << y;
    EXPECT_EQ(stage.pictureAt(2500ms), upright);
}

TEST(SiteFault, an_automatic_exposure_drifts) {
    Stage stage("faults: [{kind: exposure, at: 1, until: 3, gain: 2, rise: 1}]", kBright);
    const RgbaImage before = stage.pictureAt(500ms);
    EXPECT_NEAR(greenAt(stage.pictureAt(1500ms), kBetween), 1.5 * greenAt(before, kBetween), 0.01);
    EXPECT_NEAR(greenAt(stage.pictureAt(2500ms), kBetween), 2 * greenAt(before, kBetween), 0.01);
    EXPECT_EQ(stage.pictureAt(4s), before);
}

TEST(SiteFault, is_told_in_plain_words) {
    Stage stage(R"(faults:
  - {kind: dim, output: left, at: 1, until: 1.1, level: 0.3, rise: 5}
  - {kind: defocus, output: right, at: 2, until: 2.1, blur: 3}
  - {kind: ambient, at: 3, until: 3.1, level: 8, rise: 600}
  - {kind: flicker, relay: road, at: 4, until: 4.1, depth: 0.4, frequency: 100}
  - {kind: flicker, at: 4.5, depth: 0.4, frequency: 100}
  - {kind: camera_bump, at: 5, until: 5.1, turn: [0, 2, 0]}
  - {kind: cover, at: 6, until: 6.1, rectangle: [0, 0, 0.5, 1]}
  - {kind: dirt, at: 7, until: 7.1, veil: 0.1, rise: 60}
  - {kind: blind, at: 8, until: 8.1, level: 1}
  - {kind: upside_down, at: 9, until: 9.1}
  - {kind: exposure, at: 10, until: 10.1, gain: 0.5}
)");
    stage.advanceTo(11s);
    EXPECT_THAT(
        told(*stage.site_),
        ElementsAre("1.0 projector left gives 0.3 of its light within 5 s",
                    "1.1 projector left gives all its light again within 5 s", "2.0 projector right loses its focus by 3 pixels",
                    "2.1 projector right is in focus again", "3.0 ambient light becomes 8 times as bright within 600 s",
                    "3.1 ambient light becomes as before within 600 s", "4.0 street lamp road flickers by 0.4 at 100 Hz",
                    "4.1 street lamp road shines steadily again", "4.5 street lamps flicker by 0.4 at 100 Hz",
                    "5.0 camera bumped by 0.000 m and 2.00 degrees", "5.1 camera put back",
                    "6.0 something covers a part of the camera's picture",
                    "6.1 nothing covers that part of the camera's picture any more", "7.0 camera's lens gets dirty within 60 s",
                    "7.1 camera's lens is clean again within 60 s", "8.0 camera sees only white", "8.1 camera sees again",
                    "9.0 camera's picture stands upside down", "9.1 camera's picture stands upright again",
                    "10.0 camera exposes 0.5 times the light", "10.1 camera exposes as before"));
}

TEST(SiteFault, is_refused_with_keys_of_another_kind) {
    const auto fault = [](const std::string& keys) { return refusal(simulationText("faults: [{at: 1, kind: " + keys + "}]")); };
    EXPECT_THAT(fault("dim, output: middle, level: 0.5"), HasSubstr("one of left, right is needed"));
    EXPECT_THAT(fault("dim, output: left, level: 1.5"), HasSubstr("faults[0].level: 1.5 is out of range"));
    EXPECT_THAT(fault("dim, output: left"), HasSubstr("'level' is missing"));
    EXPECT_THAT(fault("defocus, output: left, blur: 51"), HasSubstr("faults[0].blur: 51 is out of range"));
    EXPECT_THAT(fault("input, output: left, picture: none.png"), HasSubstr("none.png"));
    EXPECT_THAT(fault("flicker, relay: rod, depth: 0.5, frequency: 50"), HasSubstr("did you mean 'road'?"));
    EXPECT_THAT(fault("flicker, depth: 0.5, frequency: 0"), HasSubstr("faults[0].frequency: 0 is out of range"));
    EXPECT_THAT(fault("flicker, depth: 0.5, frequency: 50, rise: 2"), HasSubstr("rise: unknown key"));
    EXPECT_THAT(fault("cover, rectangle: [0.5, 0, 0.5, 1]"), HasSubstr("left before right and top above bottom"));
    EXPECT_THAT(fault("cover, rectangle: [0, 0, 1]"), HasSubstr("faults[0].rectangle"));
    EXPECT_THAT(fault("cover, rectangle: [0, 0, 1, 2]"), HasSubstr("2 is out of range"));
    EXPECT_THAT(fault("dirt, veil: 2"), HasSubstr("faults[0].veil: 2 is out of range"));
    EXPECT_THAT(fault("blind, level: 2"), HasSubstr("faults[0].level: 2 is out of range"));
    EXPECT_THAT(fault("upside_down, level: 1"), HasSubstr("level: unknown key"));
    EXPECT_THAT(fault("exposure, level: 1"), HasSubstr("level: unknown key"));
    EXPECT_EQ(fault("camera_bump, move: [0, 0, 1]"), "accepted");
}

// Example failure: a camera's fault is accepted and never seen.
TEST(SiteFault, of_the_camera_needs_one) {
    NominalSite nominal = nominalSite();
    nominal.camera.reset();
    for (const std::string kind :
         {"camera_bump", "blind, level: 0", "upside_down", "cover, rectangle: [0, 0, 1, 1]", "dirt", "exposure, gain: 2"}) {
        const auto fault = readFault(ConfigNode::parse("{at: 1, kind: " + kind + "}", "site.yaml").value(), nominal);
        ASSERT_FALSE(fault) << kind;
        EXPECT_THAT(fault.error().message(), HasSubstr("this site has no camera"));
    }
}

}  // namespace
}  // namespace fantascope::site
