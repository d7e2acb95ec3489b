// Two projectors side by side on the simulated wall, drawn by the show's own renderer and seen by
// the camera: what blends are for.

#include "app/export/off_screen.h"
#include "app/site/site_models.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

// Pictures of 4 m x 2.25 m, side by side from x = -3.6 m to 3.6 m, overlapping by a fifth of a
// picture, thrown squarely on a matt wall.
constexpr const char* kSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {driver: headless}
    size: [640, 360]
    refresh_rate: 30
    canvas: wall
    part: [0, 0, 0.55555556, 1]
    light: {gamma: 2.2, black_level: 0.004}
    projector: {position: [-1.6, 2, 6], look_at: [-1.6, 2, 0], throw_ratio: 1.5}
  - name: right
    display: {driver: headless}
    size: [640, 360]
    refresh_rate: 30
    canvas: wall
    part: [0.44444444, 0, 1, 1]
    light: {gamma: 2.2, black_level: 0.004}
    projector: {position: [1.6, 2, 6], look_at: [1.6, 2, 0], throw_ratio: 1.5}
camera: {device: {driver: simulated}, size: [720, 225], field_of_view: 32.3, position: [0, 2, 12.42], look_at: [0, 2, 0]}
simulation:
  ambient: [0, 0, 0]
  sky: [0, 0, 0]
  objects: [{name: wall, rectangle: {corner: [-9, -4, 0], right: [18, 0, 0], up: [0, 12, 0]}, reflectance: [0.6, 0.6, 0.6]}]
  projectors: {left: {black_level: 0.004, gamma: 2.2}, right: {black_level: 0.004, gamma: 2.2}}
  camera: {white: 80, read_noise: 0, shot_noise: 0}
)";

struct Field {
    double least = INFINITY, most = 0;
    double spread() const { return most - least; }
};

class BlendOnTheWall : public testing::Test {
protected:
    // What the camera sees of a canvas of one grey, over all of the wall that is lit but for its
    // rim; linear light.
    Field fieldOf(float grey, const std::string& site) {
        const show::Site read = show::readSite(folder_.file("site.yaml", site)).value();
        ManualClock clock;
        site::World world(clock);
        const auto simulated = site::SimulatedSite::open(*read.simulation, simulationOf(read).value(), 1, world).value();
        simulated->begin(Time{});
        for (std::size_t output = 0; output < read.outputs.size(); ++output) {
            const auto screen = OffScreen::open(read.outputs[output].projection, blendOf(read, output),
                                                render::PictureSources::numbered({render::SolidSource{glm::vec3(1)}}))
                                    .value();
            world.setFrame(read.outputs[output].name, std::make_shared<const RgbaImage>(screen->draw({{{0, grey}}}, {}, Time{})));
        }
        clock.advance(fromSeconds(0.1));  // a camera frame
        simulated->advanceTo(clock.now());
        clock.advance(fromSeconds(0.1));
        const RgbaImage seen = world.takeFromCamera()->image;
        const vision::CameraModel camera = *simulationOf(read).value().camera;
        Field field;
        for (double x = -3.5; x <= 3.5; x += 0.02)
            for (double y = 1; y <= 3; y += 0.02) {
                const glm::dvec2 pixel = camera.pixelFromWorld({x, y, 0}).value();
                const Rgba8 stored = seen.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
                const double light = static_cast<double>(linearFromSrgb(static_cast<float>(stored.g) / 255));
                field.least = std::min(field.least, light);
                field.most = std::max(field.most, light);
            }
        return field;
    }

    const ScratchFolder folder_;
};

TEST_F(BlendOnTheWall, every_grey_is_even_from_one_end_to_the_other_black_included) {
    const double white = fieldOf(1, kSite).most;
    double worst = 0;
    for (const float grey : {0.0f, 0.003f, 0.02f, 0.1f, 0.25f, 0.5f, 0.75f, 1.0f}) {
        const double spread = fieldOf(grey, kSite).spread() / white;
        EXPECT_LE(spread, 0.02) << grey;
        worst = std::max(worst, spread);
    }
    std::printf("at most %.2f %% of full white between the brightest and the darkest place\n", 100 * worst);
}

// What the technician has to say for it: without the gamma the overlap is off, and without a canvas
// in common it is twice as bright.
TEST_F(BlendOnTheWall, is_uneven_without_what_it_needs_to_know) {
    const auto without = [](const std::string& what) {
        std::string text = kSite;
        for (std::size_t at; (at = text.find(what)) != std::string::npos;) text.erase(at, what.size());
        return text;
    };
    const double white = fieldOf(1, kSite).most;
    EXPECT_GT(fieldOf(0.5f, without("    canvas: wall\n")).spread(), 0.3 * white);
    EXPECT_GT(fieldOf(0.1f, without("gamma: 2.2, ")).spread() / white, fieldOf(0.1f, kSite).spread() / white);
    EXPECT_GT(fieldOf(0, without(", black_level: 0.004")).spread(), 0.003 * white);
}

}  // namespace
}  // namespace fantascope::app
