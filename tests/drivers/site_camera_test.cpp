// What the simulated camera makes of a site: its lens, and its rows that are exposed one after the
// other.

#include "drivers/simulated_stage.h"

#include <gmock/gmock.h>

namespace fantascope::site {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The number of rows from the top, and from the bottom, that are bright in the picture's middle.
std::pair<int, int> brightRows(const RgbaImage& image) {
    const auto bright = [&](int y) { return image.at(24, y).g > 50; };
    int above = 0, below = 0;
    while (above < image.height() && bright(above)) ++above;
    while (below < image.height() && bright(image.height() - 1 - below)) ++below;
    return {above, below};
}

// Example failures: the bands see the first moment; the frame comes before its last row.
TEST(SimulatedCamera, exposes_its_rows_one_band_after_the_other) {
    Stage stage("", kNoiseless + ", rolling: 0.07");
    stage.setSlot(10, 255);
    std::vector<std::int64_t> events;
    for (Time next = stage.site_->nextEvent(); next <= 100ms; next = stage.site_->nextEvent()) {
        events.push_back(next.count() / 1000000);
        if (next > 25ms) stage.setSlot(10, 0);
        stage.advanceTo(next);
    }
    EXPECT_THAT(events, ElementsAre(0, 10, 20, 30, 40, 50, 60, 70, 100));
    stage.advanceTo(119ms);
    EXPECT_EQ(stage.world_.takeFromCamera(), nullptr) << "the last row was exposed at 70 ms, and its way takes 50 ms";
    stage.clock_.advanceTo(120ms);
    const auto frame = stage.world_.takeFromCamera();
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->exposed, Time(0ms));
    EXPECT_EQ(brightRows(frame->image), std::pair(9, 0)) << "three bands of three rows";
}

// With steps that are longer than a frame, a frame that was begun still comes, and then the newest.
TEST(SimulatedCamera, finishes_the_picture_that_it_began) {
    Stage stage("", kNoiseless + ", rolling: 0.07");
    stage.setSlot(10, 255);
    stage.advanceTo(20ms);
    stage.setSlot(10, 0);
    stage.advanceTo(540ms);
    const auto first = stage.world_.takeFromCamera();
    ASSERT_NE(first, nullptr);
    EXPECT_EQ(first->sequence, 0u);
    EXPECT_EQ(brightRows(first->image), std::pair(9, 0));
    EXPECT_EQ(stage.site_->nextEvent(), Time(550ms)) << "the next band of the picture at 500 ms";
    stage.advanceTo(570ms);
    stage.clock_.advanceTo(620ms);
    const auto next = stage.world_.takeFromCamera();
    ASSERT_NE(next, nullptr);
    EXPECT_EQ(next->sequence, 5u);
}

// Example failure: the plug is looked at with the first band alone.
TEST(SimulatedCamera, loses_the_picture_during_which_it_was_unplugged) {
    Stage stage("faults: [{kind: unplug, device: camera, at: 0.135, until: 0.15}]", kNoiseless + ", rolling: 0.07");
    stage.advanceTo(170ms);
    stage.clock_.advanceTo(250ms);
    EXPECT_EQ(stage.world_.takeFromCamera(), nullptr);
    stage.advanceTo(270ms);
    stage.clock_.advanceTo(320ms);
    const auto next = stage.world_.takeFromCamera();
    ASSERT_NE(next, nullptr);
    EXPECT_EQ(next->sequence, 2u);
}

// The wall is lit evenly by the ambient light alone, so the closed forms hold in the picture.
TEST(SimulatedCamera, its_lens_loses_light_and_blurs) {
    const std::string exposure = "white: 0.2, read_noise: 0, shot_noise: 0";  // the wall has 0.159 cd/m2
    const auto plain = Stage("", exposure).look()->image, lossy = Stage("", exposure + ", vignetting: 0.5").look()->image;
    EXPECT_NEAR(linear(lossy.at(0, 0).g) / linear(plain.at(0, 0).g), 1 - 0.5 * (47 * 47 + 23 * 23) / (48.0 * 48 + 24 * 24), 0.01);
    EXPECT_EQ(lossy.at(24, 12), plain.at(24, 12));
    EXPECT_EQ(Stage("", exposure + ", blur: 3").look()->image, plain);

    Stage sharp, soft("", kNoiseless + ", blur: 2");
    sharp.show("left", 255);
    soft.show("left", 255);
    const auto edge = [](const RgbaImage& image) {  // columns between dark and bright, in the middle row
        int between = 0;
        for (int x = 0; x < 24; ++x) between += image.at(x, 12).g > 60 && image.at(x, 12).g < image.at(13, 12).g - 20;
        return between;
    };
    EXPECT_GE(edge(soft.look()->image), edge(sharp.look()->image) + 3);
}

// Everything that moves and fails at once, twice; and with another seed.
TEST(SimulatedCamera, gives_the_same_bytes_for_the_same_seed_with_all_that_moves) {
    const std::string busy = R"(walkers: [{name: Ann, path: [[-2, 2], [2, 2]], at: 0.2, loop: true}]
headlights: [{path: [[-2, 3], [2, 1]], speed: 4, at: 0.4, beam_angle: 20, field_angle: 45}]
faults:
  - {kind: flicker, at: 0, depth: 0.5, frequency: 7}
  - {kind: defocus, output: left, at: 0.3, blur: 3, rise: 1}
  - {kind: dim, output: right, at: 0.5, level: 0.2, rise: 1}
  - {kind: bump, output: left, at: 0.6, turn: [0, 2, 0]}
  - {kind: camera_bump, at: 0.735, until: 1.2, move: [0.1, 0, 0]}
  - {kind: fog, at: 0.1, density: 0.05, rise: 1}
  - {kind: dirt, at: 0.2, blur: 1, veil: 0.2, rise: 1}
)";
    const auto night = [&](std::uint64_t seed) {
        Stage stage(busy, "white: 20, read_noise: 0.01, shot_noise: 0.02, vignetting: 0.3, blur: 0.8, rolling: 0.07", seed);
        stage.world_.setRelays("road", {true, true});
        std::vector<RgbaImage> frames;
        for (int tick = 0; tick < 150; ++tick) {
            stage.show("left", static_cast<std::uint8_t>(tick));
            stage.show("right", static_cast<std::uint8_t>(255 - tick));
            stage.advanceTo(tick * 10ms);
            if (const auto frame = stage.world_.takeFromCamera()) frames.push_back(frame->image);
        }
        return frames;
    };
    const auto first = night(1);
    EXPECT_EQ(first.size(), 14u) << "one every tenth of a second; the first comes at 120 ms";
    EXPECT_EQ(first, night(1));
    EXPECT_NE(first, night(2));
}

TEST(SimulatedCamera, refuses_what_no_lens_and_no_shutter_does) {
    const auto camera = [](const std::string& keys) { return refusal(simulationText("", keys)); };
    EXPECT_EQ(camera("vignetting: 1, blur: 20, rolling: 0.099"), "accepted");
    EXPECT_THAT(camera("vignetting: 1.1"), HasSubstr("camera.vignetting: 1.1 is out of range"));
    EXPECT_THAT(camera("blur: 21"), HasSubstr("camera.blur: 21 is out of range"));
    EXPECT_THAT(camera("rolling: 0.1"), HasSubstr("'rolling' must be shorter than a frame's period, here 0.1 s"));
}

}  // namespace
}  // namespace fantascope::site
