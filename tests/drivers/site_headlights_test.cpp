// Lamps that drive past the simulated site.

#include "drivers/simulated_stage.h"
#include "drivers/site/camera_view.h"
#include "drivers/site/headlights.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::site {
namespace {

using testing::HasSubstr;

const std::string kBeam = "beam_angle: 20, field_angle: 40";

TEST(SiteBeam, its_table_follows_the_lamp) {
    for (const double field : {0.4, 0.7, 3.0}) {
        Lamp lamp;
        lamp.beam = 0.35;
        lamp.field = field;
        lamp.candela = 15000;
        const Beam beam(lamp);
        for (double angle = 0; angle < std::numbers::pi; angle += 0.00037) {
            const double exact = lamp.intensity({std::sin(angle), -std::cos(angle), 0});
            ASSERT_NEAR(beam.at(static_cast<float>(std::cos(angle))), exact, 0.01 * lamp.candela) << field << " " << angle;
        }
        EXPECT_FLOAT_EQ(beam.at(1), 15000);
        EXPECT_FLOAT_EQ(beam.at(-1), static_cast<float>(lamp.intensity({0, 1, 0})));
    }
}

TEST(SiteHeadlight, drives_along_its_path_again_and_again) {
    const std::string keys = "{path: [[0, 1], [8, 1], [8, 5]], speed: 4, at: 2, every: 10, height: 0.7, " + kBeam + "}";
    const Headlight headlight = readHeadlight(ConfigNode::parse(keys, "site.yaml").value()).value();
    EXPECT_FALSE(headlight.lampAt(1999ms));
    for (const Time pass : {0s, 10s, 70s}) {
        const Lamp straight = headlight.lampAt(pass + 3s).value(), turned = headlight.lampAt(pass + 4500ms).value();
        EXPECT_NEAR(glm::distance(straight.position, {4, 0.7, 1}), 0, 1e-9);
        EXPECT_NEAR(glm::distance(straight.aim, {1, 0, 0}), 0, 1e-9);
        EXPECT_NEAR(glm::distance(turned.position, {8, 0.7, 3}), 0, 1e-9);
        EXPECT_NEAR(glm::distance(turned.aim, {0, 0, 1}), 0, 1e-9);
        EXPECT_TRUE(headlight.lampAt(pass + 5s));
        EXPECT_FALSE(headlight.lampAt(pass + 5001ms));
    }
    EXPECT_EQ(headlight.lampAt(3s)->candela, 15000);
}

// The same lamp, computed beforehand and while it passes: on its way, in its colour, with its head
// in the picture, in clear air and in fog.
TEST(SiteHeadlight, lights_as_a_lamp_in_the_same_place) {
    const glm::vec3 x(10, 0, 0), y(0, 10, 0);
    const Scene scene({{{{-x - y, x - y, x + y, y - x}, {{0, 1, 2}, {0, 2, 3}}}, glm::vec3(0.5f)}});
    const auto camera =
        vision::CameraModel::fromFieldOfView(Pose::lookingAt({0, 0, 3}, {0, 0, 0}).value(), {31, 31}, 2 * std::atan(1.0 / 3))
            .value();
    Lamp lamp;
    lamp.position = {0.3, 0.2, 1};
    lamp.aim = {-1, 0, 0};
    lamp.beam = 2;
    lamp.field = 3;
    lamp.colour = {1, 0.5, 0.25};
    CameraView before(scene, camera, {1, 1, 1}, {0, 0, 0}), passes(scene, camera, {1, 1, 1}, {0, 0, 0});
    before.addLamp(lamp);
    passes.expectBodies();
    for (const double fog : {0.0, 0.05}) {
        Image<glm::vec3> expected(31, 31), seen(31, 31);
        before.render(std::vector{glm::vec3(1)}, {}, fog, expected);
        Lighting lighting{{}, {}, fog};
        lighting.passing = std::span(&lamp, 1);
        for (const Rows rows : {Rows{0, 9}, Rows{9, 31}}) passes.render(lighting, rows, seen);
        const double tolerance = fog > 0 ? 0.02 : 2e-3;  // the fog's light is a mean over fewer samples
        double brightest = 0;
        for (std::size_t i = 0; i < seen.pixels().size(); ++i)
            for (int c = 0; c < 3; ++c) {
                const double wanted = expected.pixels()[i][c];
                brightest = std::max(brightest, wanted);
                EXPECT_NEAR(seen.pixels()[i][c], wanted, tolerance * wanted) << i << " " << c;
            }
        EXPECT_GT(brightest, 1000) << "the head";
    }

    // A person before the head hides it.
    const Body body = Body::standing({0.2, -0.9, 1.7}, {0, 0, 1}, 1.75, glm::dvec3(0));
    Image<glm::vec3> hidden(31, 31);
    Lighting lighting{{}, {}, 0};
    lighting.passing = std::span(&lamp, 1);
    lighting.bodies = std::span(&body, 1);
    passes.render(lighting, {0, 31}, hidden);
    const glm::ivec2 head(camera.pixelFromWorld(lamp.position).value());
    EXPECT_LT(hidden.at(head.x, head.y).g, 10);
}

TEST(SiteHeadlight, is_in_the_pictures_while_it_passes) {
    Stage stage("headlights: [{path: [[-1, 3], [1, 1]], speed: 10, at: 0.25, every: 0.5, height: 0, " + kBeam + "}]");
    const RgbaImage before = stage.look()->image;
    std::string passes;
    for (int i = 0; i < 10; ++i) passes += stage.look()->image == before ? '-' : '*';
    EXPECT_EQ(passes, "-**-**-**-") << "pictures at 0.2, 0.4, 0.5, 0.7, 0.9, 1.0, 1.2, 1.3, 1.5 and 1.7 s";
}

TEST(SiteHeadlight, is_refused_where_it_would_overtake_itself) {
    const auto headlight = [](const std::string& keys) {
        return refusal(simulationText("headlights: [{path: [[-9, 2], [9, 2]], at: 1, " + keys + "}]"));
    };
    EXPECT_EQ(headlight("speed: 9, every: 2, " + kBeam), "accepted");
    EXPECT_THAT(headlight("speed: 9, every: 1.9, " + kBeam), HasSubstr("'every' is shorter than the pass, which takes 2 s"));
    EXPECT_THAT(headlight("speed: 9, beam_angle: 20, field_angle: 20"), HasSubstr("field_angle must be larger than beam_angle"));
    EXPECT_THAT(headlight(kBeam), HasSubstr("'speed' is missing"));
    EXPECT_THAT(headlight("speed: 9, aim: 2, " + kBeam), HasSubstr("aim: unknown key"));
}

}  // namespace
}  // namespace fantascope::site
