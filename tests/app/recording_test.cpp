#include "app/recording.h"

#include "app/video_reader.h"

#include "core/file.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

class RecordingTest : public testing::Test {
protected:
    RecordingTest() { fs::remove_all(folder_); }
    ~RecordingTest() override { fs::remove_all(folder_); }
    // 64x48 at 30 Hz, two outputs, five refreshes.
    void record(const fs::path& target) {
        auto recording = Recording::open(target, {{"left", {64, 48}, 30}, {"right", {64, 48}, 30}});
        ASSERT_TRUE(recording) << recording.error().message();
        for (int refresh = 10; refresh < 15; ++refresh)
            for (std::size_t output : {0u, 1u}) {
                const auto shade = static_cast<std::uint8_t>(refresh * 10);
                ASSERT_TRUE((*recording)
                                ->frame(output, RgbaImage(64, 48, {shade, 0, static_cast<std::uint8_t>(output * 200), 255}),
                                        refresh, 33ms * refresh));
            }
        (*recording)->lighting(1s, 1, std::vector<std::uint8_t>{7, 0, 9, 0, 0});
        (*recording)->cue(1, "2 Rise", RgbaImage(32, 18, {200, 100, 50, 255}));
        ASSERT_TRUE((*recording)->finish());
    }
    const fs::path folder_ = fs::path(testing::TempDir()) / ("recording-" + std::to_string(getpid()));
};

TEST_F(RecordingTest, leaves_a_video_an_output_the_traces_and_the_contact_sheet) {
    record(folder_);
    for (const char* name : {"left.mp4", "right.mp4"}) {
        // Example failure: the last frame has no duration, so that players leave it out and count a faster rate.
        const Video video = readVideo(folder_ / name);
        EXPECT_EQ(video.frames.size(), 5u);
        EXPECT_NEAR(video.seconds, 5.0 / 30, 1e-3);
        EXPECT_NEAR(video.framesPerSecond, 30, 1e-6);
    }
    EXPECT_THAT(*readFile(folder_ / "dmx.csv"), HasSubstr("\n1.000000,1,7 0 9\n"));
    EXPECT_THAT(*readFile(folder_ / "frames.csv"), HasSubstr("\n12,0.396000,right,"));
    const auto sheet = readRgba(folder_ / "contact-sheet.png");
    ASSERT_TRUE(sheet);
    EXPECT_EQ(sheet->at(20, 20), (Rgba8{200, 100, 50, 255}));
    for (const auto& entry : fs::directory_iterator(folder_)) EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST_F(RecordingTest, the_same_pictures_give_the_same_bytes) {
    record(folder_ / "a");
    record(folder_ / "b");
    for (const char* name : {"left.mp4", "frames.csv", "contact-sheet.png"})
        EXPECT_EQ(*readFile(folder_ / "a" / name), *readFile(folder_ / "b" / name)) << name;
}

TEST_F(RecordingTest, one_video_file_holds_the_outputs_side_by_side) {
    record(folder_ / "all.mp4");
    EXPECT_TRUE(fs::exists(folder_ / "all.mp4"));
    EXPECT_FALSE(fs::exists(folder_ / "frames.csv"));
}

TEST_F(RecordingTest, another_kind_of_file_is_refused_with_advice) {
    const auto recording = Recording::open(folder_ / "all.avi", {});
    ASSERT_FALSE(recording);
    EXPECT_THAT(recording.error().message(), HasSubstr("ends in .mp4"));
}

}  // namespace
}  // namespace fantascope::app
