// A show with an image, a video and the camera, as a person runs it.

#include "app/live/programme.h"
#include "app/video_reader.h"

#include "media/image.h"
#include "program.h"
#include "scratch_folder.h"
#include "test_video.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Test
sources:
  rain: {video: rain.mp4}
  poster: {image: poster.png}
  wall: {camera: {}}
looks:
  wet: {outputs: {left: [{source: rain}], right: [{source: poster}]}}
  seen: {outputs: {left: [{source: wall}], right: [{source: rain}]}}
cues: [{name: Wet, look: wet, fade: 0}, {name: Seen, look: seen, fade: 0}]
)";

class ShowWithPictures : public testing::Test {
protected:
    ShowWithPictures() {
        writeVideo(folder_ / "rain.mp4", {.size = {128, 72}, .rate = 25, .bFrames = 3}, 40, [](int number) {
            return numbered({128, 72}, number + 1);
        });
        EXPECT_TRUE(writePng(folder_ / "poster.png", RgbaImage(32, 18, {255, 255, 255, 255})));
        folder_.file("show.yaml", kShow);
    }
    Outcome run(const std::vector<std::string>& arguments) const { return runProgram(arguments, folder_.path()); }
    const ScratchFolder folder_;
};

// Which frame is decoded in time hangs on the machine; which is shown must not.
TEST_F(ShowWithPictures, is_the_same_to_the_byte_as_fast_as_possible) {
    for (const char* name : {"a", "b"}) {
        const Outcome done = run({"rehearse", ".", "--seconds", "2.5", "--as-fast-as-possible", "--record", name, "--report",
                                  std::string(name) + ".json"});
        ASSERT_THAT(done, exits(0));
    }
    for (const char* file : {"left.mp4", "right.mp4", "frames.csv"})
        EXPECT_EQ(contentsOf(folder_ / "a" / file), contentsOf(folder_ / "b" / file)) << file;
    const auto report = nlohmann::json::parse(contentsOf(folder_ / "a.json"));
    EXPECT_EQ(report["late_video_frames"], (nlohmann::json{{"rain", 0}}));
    EXPECT_EQ(report["damaged_video_frames"], (nlohmann::json{{"rain", 0}}));
}

// Twice round in 4 s: what is damaged is counted each time. Example failure: the log alone knows.
TEST_F(ShowWithPictures, counts_the_damaged_frames_of_a_video) {
    writeVideo(folder_ / "rain.mp4", {.size = {128, 72}, .rate = 25, .keyEvery = 1}, 50, [](int number) {
        return noisy({128, 72}, number + 1);
    });
    const auto damagedIn = [&](const std::string& length) {
        const Outcome done = run(
            {"rehearse", ".", "--from", "Wet", "--by-hand", "--seconds", length, "--as-fast-as-possible", "--report", "a.json"});
        EXPECT_THAT(done, exits(0));
        const auto report = nlohmann::json::parse(contentsOf(folder_ / "a.json"));
        EXPECT_EQ(report["late_video_frames"], (nlohmann::json{{"rain", 0}}));
        return report["damaged_video_frames"]["rain"].get<int>();
    };
    damage(folder_ / "rain.mp4", 0.42, 0.48);
    const int once = damagedIn("1.9");
    EXPECT_GE(once, 1);
    EXPECT_EQ(damagedIn("3.9"), 2 * once);
}

// A cue alone lasts one loop of its video, and canvas and rate are the video's where they are asked
// for.
TEST_F(ShowWithPictures, is_exported_frame_by_frame) {
    const Outcome done = run({"export", ".", "--output", "left", "--cue", "Wet", "--canvas", "--fps", "25", "--size", "128x72",
                              "-o", "a.mkv", "--alpha", "none"});
    ASSERT_THAT(done, exits(0));
    const Video video = readVideo(folder_ / "a.mkv");
    ASSERT_EQ(video.frames.size(), 40u);
    for (std::size_t i = 0; i < video.frames.size(); ++i) {
        RgbaImage frame(128, 72);
        for (std::size_t p = 0; p < frame.pixels().size(); ++p)
            frame.pixels()[p].g = static_cast<std::uint8_t>(video.frames[i].pixels()[p].g / 257);
        EXPECT_EQ(numberOn(frame), static_cast<int>(i) + 1);
    }
}

// Example failures: the length of the video is not known to the cues; a slower video jumps; the
// decoder does not follow.
TEST_F(ShowWithPictures, plays_a_video_as_its_cues_say) {
    folder_.file("show.yaml", R"(fantascope: show
version: 2
title: Test
start: Wet
sources: {rain: {video: {file: rain.mp4, times: 1}}}
looks:
  wet: {outputs: {left: [{source: rain}]}}
  slow: {play: {rain: 0.5}}
  again: {play: {rain: {speed: 2, restart: true}}}
cues:
  - {name: Wet, look: wet, fade: 0, follow: 0.8}
  - {name: Slow, look: slow, fade: 0, follow: {after_media: 0.4}}
  - {name: Again, look: again, fade: 0}
)");
    const Outcome done = run({"export", ".", "--output", "left", "--canvas", "--fps", "25", "--size", "128x72", "--seconds",
                              "3.2", "-o", "a.mkv", "--alpha", "none"});
    ASSERT_THAT(done, exits(0));
    std::vector<int> seen, wanted;
    for (const Rgba16Image& picture : readVideo(folder_ / "a.mkv").frames) {
        RgbaImage frame(128, 72);
        for (std::size_t p = 0; p < frame.pixels().size(); ++p)
            frame.pixels()[p].g = static_cast<std::uint8_t>(picture.pixels()[p].g / 257);
        seen.push_back(numberOn(frame));
    }
    for (int i = 0; i < 20; ++i) wanted.push_back(i + 1);
    for (int i = 0; i < 40; ++i) wanted.push_back(21 + i / 2);
    for (int i = 0; i < 10; ++i) wanted.push_back(40);
    for (int i = 0; i < 10; ++i) wanted.push_back(2 * i + 1);
    EXPECT_EQ(seen, wanted);
}

TEST_F(ShowWithPictures, says_where_in_the_show_a_broken_file_is_named) {
    folder_.file("rain.mp4", "rain");
    const Outcome done = run({"rehearse", ".", "--seconds", "1", "--as-fast-as-possible"});
    EXPECT_THAT(done, exits(1));
    EXPECT_THAT(done.errors, HasSubstr("show.yaml:5:9: sources.rain: "));
    EXPECT_THAT(done.errors, HasSubstr("rain.mp4: not a video that can be read, or a truncated one"));
}

// What the camera saw a moment before is on the wall: the left output, dark but for the camera's
// picture.
TEST_F(ShowWithPictures, shows_what_the_camera_sees) {
    const Outcome done = run({"rehearse", ".", "--seconds", "2", "--from", "Seen", "--as-fast-as-possible", "--record", "seen"});
    ASSERT_THAT(done, exits(0));
    const Video video = readVideo(folder_ / "seen/left.mp4");
    const auto light = [](const Rgba16Image& frame) {
        double sum = 0;
        for (const Rgba16 pixel : frame.pixels()) sum += pixel.g / 65535.0;
        return sum / static_cast<double>(frame.pixels().size());
    };
    EXPECT_LT(light(video.frames.front()), 0.002) << "nothing was seen yet";
    EXPECT_GT(light(video.frames.back()), 0.01);
}

}  // namespace
}  // namespace fantascope::app
