// Golden frames, and the reproducibility of frames.

#include "render/golden.h"
#include "render/scene.h"

#include "contract/x_server.h"
#include "core/file.h"

#include <gmock/gmock.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{480, 270};

// Shapes, shading, warp and movement together, for errors that no other test would find.
TEST(GoldenFrames, a_swaying_pattern_through_a_keystone) {
    DrawnOutput output(kSize, keystone(kSize), {moving(smallPattern())});
    EXPECT_TRUE(looksLikeGolden("pattern-at-0s", output.frame({{0, 1}}, Time::zero())));
    EXPECT_TRUE(looksLikeGolden("pattern-at-12s", output.frame({{0, 1}}, std::chrono::seconds(12))));
}

// A sharp and a blurred layer of leaves, the floor of a pond and a mirror ball's spots.
TEST(GoldenFrames, light_through_leaves_on_water_and_from_mirrors) {
    FoliageSource foliage{glm::vec3(1, 0.93f, 0.76f), glm::vec3(0.01f), {}};
    foliage.layers.push_back({moving(smallPattern()), {}});
    foliage.layers.push_back({moving(smallPattern()), {0.1, nullptr}});
    DrawnOutput output(kSize, keystone(kSize),
                       {foliage, CausticsSource{glm::vec3(0.1f, 0.15f, 0.17f), {16.0 / 3, 3}, 1.2, 0.55, 0.02, 1},
                        MirrorBallSource{glm::vec3(3), {16.0 / 3, 3}, {0, 0.5, 2.2}, 0.25, 0.03, {2.6, 1.8, 1}, 0.05, 60}});
    const std::array<const char*, 3> names = {"foliage", "caustics", "mirror-ball"};
    for (std::uint32_t source = 0; source < names.size(); ++source)
        EXPECT_TRUE(looksLikeGolden(names[source], output.frame({{source, 1}}, std::chrono::seconds(12))));
}

// Tests the comparison itself: a picture that is a pixel off, or a shade darker, differs from the
// golden one.
TEST(GoldenFrames, are_not_met_by_a_shifted_or_a_darker_picture) {
    DrawnOutput output(kSize, keystone(kSize), {moving(smallPattern())});
    const RgbaImage frame = output.frame({{0, 1}}, Time::zero());
    RgbaImage shifted = frame, darker = frame;
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 1; x < kSize.x; ++x) shifted.at(x, y) = frame.at(x - 1, y);
    for (Rgba8& pixel : darker.pixels()) pixel.g = static_cast<std::uint8_t>(pixel.g * 95 / 100);
    EXPECT_EQ(differsVisibly(frame, frame), "");
    EXPECT_NE(differsVisibly(frame, shifted), "");
    EXPECT_NE(differsVisibly(frame, darker), "");
}

std::string framesOfAnotherProcess(const std::string& environment) {
    const std::string file = testing::TempDir() + "frames.raw";
    const std::string command = environment + " " + DRAW_FRAMES + " " + file;
    if (std::system(command.c_str()) != 0) return command + " failed";
    return readFile(file).value();
}

// A show can be reproduced byte by byte.
// Example failure: the software renderer's threads blend in the order in which they happen to
// finish.
TEST(Frames, are_the_same_bytes_in_every_run_and_on_every_number_of_threads) {
    const std::string frames = framesOfAnotherProcess("LP_NUM_THREADS=0");
    EXPECT_GT(frames.size(), 1'000'000u) << frames;
    EXPECT_TRUE(framesOfAnotherProcess("LP_NUM_THREADS=0") == frames);
    EXPECT_TRUE(framesOfAnotherProcess("LP_NUM_THREADS=2") == frames);
}

TEST(Frames, are_the_same_in_a_window_as_without_a_window_system) {
    const auto server = XServer::start();
    ASSERT_TRUE(server) << server.error().message();
    const PatternSource source = moving(smallPattern());
    const std::vector<show::LayerState> layers = {{0, 0.7f}, {1, 0.2f}};
    DrawnOutput headless(kSize, keystone(kSize), {source, SolidSource{{1, 0.5f, 0.2f}}});
    DrawnOutput window(kSize, keystone(kSize), {source, SolidSource{{1, 0.5f, 0.2f}}}, "glfw");
    for (const Time time : {Time::zero(), Time(std::chrono::seconds(5))})
        EXPECT_LE(difference(headless.frame(layers, time), window.frame(layers, time)).most, 1);
}

}  // namespace
}  // namespace fantascope::render
