// Two projectors that differ in brightness, colour and gamma, calibrated as a person does it: what
// the camera sees across the overlap of their canvas, with the light settings that were written and
// without them.

#include "app/export/off_screen.h"
#include "app/site/site_models.h"

#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

// Pictures of 4 m x 2.25 m, thrown squarely on a matt wall, that overlap by 0.8 m.
constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {driver: headless}
    size: [640, 360]
    refresh_rate: 60
    canvas: wall
    part: [0, 0, 0.55555556, 1]
    light: {gamma: 2.1, white: [1, 0.5, 1], dither: true}  # by eye
    projector: {position: [-1.6, 2, 6], look_at: [-1.6, 2, 0], throw_ratio: 1.5}
    surface: {point: [0, 0, 0], normal: [0, 0, 1]}
  - name: right
    display: {driver: headless}
    size: [640, 360]
    refresh_rate: 60
    canvas: wall
    part: [0.44444444, 0, 1, 1]
    projector: {position: [1.6, 2, 6], look_at: [1.6, 2, 0], throw_ratio: 1.5}
    surface: {point: [0, 0, 0], normal: [0, 0, 1]}
camera: {device: {driver: simulated}, size: [480, 150], field_of_view: 32.3, position: [0, 2, 12.42], look_at: [0, 2, 0]}
simulation:
  ambient: [0.2, 0.25, 0.4]
  objects: [{name: wall, rectangle: {corner: [-9, -4, 0], right: [18, 0, 0], up: [0, 12, 0]}, reflectance: [0.6, 0.6, 0.6]}]
  projectors:
    left: {gamma: 2.45, lumens: 3500, white: [1, 0.95, 0.9]}
    right: {gamma: 1.85, lumens: 2600, white: [0.9, 1, 0.95]}
  camera: {white: 120, read_noise: 0.003, shot_noise: 0.012, latency: 0.1, frame_rate: 30}
)";

class CalibratedBlend : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<ScratchFolder>();
        folder_->file("site.yaml", std::string(kSite));
        outcome_ = runProgram({"calibrate", ".", "--simulate", "--write", "--report", "r.json"}, *folder_ / ".");
    }
    static void TearDownTestSuite() { folder_.reset(); }
    void SetUp() override { ASSERT_THAT(outcome_, exits(0)); }
    static show::Site calibrated() { return show::readSite(*folder_ / "site.yaml").value(); }

    // The greatest difference of the light along the canvas's middle line, over the overlap and as
    // much on both sides of it, as a share of the mean light; of the worst channel.
    static double unevenness(const show::Site& site, float grey) {
        const Image<glm::vec3> lit = seen(site, grey), dark = seen(site, 0);
        const vision::CameraModel camera = *simulationOf(site).value().camera;
        double worst = 0;
        for (int channel = 0; channel < 3; ++channel) {
            double least = INFINITY, most = 0, sum = 0;
            int places = 0;
            for (double x = -1.2; x <= 1.2; x += 0.02, ++places) {
                double light = 0;
                for (double y = 1.8; y <= 2.2; y += 0.02) {
                    const glm::ivec2 pixel(camera.pixelFromWorld({x, y, 0}).value());
                    light += double(lit.at(pixel.x, pixel.y)[channel] - dark.at(pixel.x, pixel.y)[channel]);
                }
                least = std::min(least, light);
                most = std::max(most, light);
                sum += light;
            }
            worst = std::max(worst, (most - least) / (sum / places));
        }
        return worst;
    }

    static inline std::unique_ptr<ScratchFolder> folder_;
    static inline Outcome outcome_;

private:
    // The mean of the camera's pictures of a canvas of one grey.
    static Image<glm::vec3> seen(const show::Site& site, float grey) {
        constexpr int kFrames = 16;
        ManualClock clock;
        site::World world(clock);
        const auto simulated = site::SimulatedSite::open(*site.simulation, simulationOf(site).value(), 1, world).value();
        simulated->begin(Time{});
        for (std::size_t output = 0; output < site.outputs.size(); ++output) {
            const auto screen = OffScreen::open(site.outputs[output].projection, blendOf(site, output),
                                                render::PictureSources::numbered({render::SolidSource{glm::vec3(1)}}))
                                    .value();
            world.setFrame(site.outputs[output].name, std::make_shared<const RgbaImage>(screen->draw({{{0, grey}}}, {}, Time{})));
        }
        const vision::CameraLight light = cameraLightOf(site);
        Image<glm::vec3> sum(site.nominalCamera->size.x, site.nominalCamera->size.y);
        for (int frame = 0; frame < kFrames;) {
            clock.advance(fromSeconds(1 / 30.0));
            simulated->advanceTo(clock.now());
            const auto taken = world.takeFromCamera();
            if (!taken) continue;
            for (int y = 0; y < sum.height(); ++y)
                for (int x = 0; x < sum.width(); ++x) sum.at(x, y) += light.at(taken->image, x, y) / float(kFrames);
            ++frame;
        }
        return sum;
    }
};

TEST_F(CalibratedBlend, is_even_in_light_and_colour_where_the_projectors_differ) {
    const show::Site after = calibrated();
    show::Site before = after;
    for (show::Output& output : before.outputs) output.projection.light = {};
    for (const float grey : {0.2f, 0.5f, 1.0f}) {
        const double with = unevenness(after, grey), without = unevenness(before, grey);
        std::printf("light %.1f: %.1f %% between the brightest and the darkest place of the line, before %.1f %%\n", double(grey),
                    100 * with, 100 * without);
        EXPECT_LT(with, 0.05) << grey;
        EXPECT_GT(without, 0.15) << grey;
    }
}

TEST_F(CalibratedBlend, is_written_as_the_projectors_are) {
    const show::Site site = calibrated();
    const ProjectorLight &left = site.outputs[0].projection.light, &right = site.outputs[1].projection.light;
    EXPECT_NEAR(left.gamma.value_or(0), 2.45, 0.05);
    EXPECT_NEAR(right.gamma.value_or(0), 1.85, 0.05);
    const double dimmer = 2600.0 / 3500;
    const glm::dvec3 ratio = dimmer * glm::dvec3(0.9, 1, 0.95) / glm::dvec3(1, 0.95, 0.9);  // right / left
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(left.white[i], std::min(1.0, ratio[i]), 0.03) << i;
        EXPECT_NEAR(right.white[i], std::min(1.0, 1 / ratio[i]), 0.03) << i;
    }
}

TEST_F(CalibratedBlend, is_told_and_replaces_what_was_set_by_hand) {
    const auto report = nlohmann::json::parse(contentsOf(*folder_ / "r.json"))["outputs"];
    for (const show::Output& output : calibrated().outputs) {
        const ProjectorLight& light = output.projection.light;
        EXPECT_THAT(outcome_.out, HasSubstr(fmt::format("\n{}: gamma {:g}, white [{:g}, {:g}, {:g}]; written\n", output.name,
                                                        light.gamma.value_or(0), light.white.r, light.white.g, light.white.b)));
        EXPECT_NEAR(report[output.name]["gamma"].get<double>(), light.gamma.value_or(0), 0.005);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(report[output.name]["white"][i].get<double>(), light.white[static_cast<int>(i)]);
    }
    EXPECT_THAT(contentsOf(*folder_ / "site.yaml"), HasSubstr(", dither: true}  # by eye\n"));
    EXPECT_EQ(contentsOf(*folder_ / "site.yaml.previous"), kSite);
}

}  // namespace
}  // namespace fantascope::app
