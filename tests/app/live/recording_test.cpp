#include "app/live/recording.h"

#include "app/video_reader.h"

#include "core/file.h"
#include "core/random.h"
#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

nlohmann::json reportOf(const std::vector<std::string>& more, const ScratchFolder& folder) {
    std::vector<std::string> arguments{"rehearse", "--record", "videos", "--report", "report.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = runProgram(arguments, folder.path());
    EXPECT_THAT(outcome, exits(0));
    return nlohmann::json::parse(contentsOf(folder / "report.json"));
}

class RecordingTest : public testing::Test {
protected:
    RecordingTest() { fs::remove_all(folder_); }
    ~RecordingTest() override { fs::remove_all(folder_); }
    // 64x48 at 30 Hz, two outputs, five refreshes.
    void record(const fs::path& target) {
        auto recording = Recording::open(target, {{"left", {64, 48}, 30}, {"right", {64, 48}, 30}});
        ASSERT_TRUE(recording) << recording.error().message();
        (*recording)->begin(tickTime(10, 30));
        for (int refresh = 10; refresh < 15; ++refresh)
            for (std::size_t output : {0u, 1u}) {
                const auto shade = static_cast<std::uint8_t>(refresh * 10);
                ASSERT_TRUE((*recording)
                                ->frame(output, RgbaImage(64, 48, {shade, 0, static_cast<std::uint8_t>(output * 200), 255}),
                                        {.refresh = refresh, .at = tickTime(refresh, 30)}, 33ms * refresh));
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
        // Example failure: the last frame has no duration, so that players leave it out and count a
        // faster rate.
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
    EXPECT_EQ(readRgba(folder_ / "camera-2.png").value(), RgbaImage(32, 18, {200, 100, 50, 255}));
    for (const auto& entry : fs::directory_iterator(folder_)) EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST_F(RecordingTest, the_same_pictures_give_the_same_bytes) {
    record(folder_ / "a");
    record(folder_ / "b");
    for (const char* name : {"left.mp4", "frames.csv", "contact-sheet.png"})
        EXPECT_EQ(*readFile(folder_ / "a" / name), *readFile(folder_ / "b" / name)) << name;
}

// The right video's thread was away for a while.
TEST_F(RecordingTest, frames_stand_in_the_order_in_which_they_were_shown_whichever_video_is_behind) {
    auto recording = Recording::open(folder_, {{"left", {64, 48}, 30}, {"right", {64, 48}, 30}}).value();
    constexpr int kFrames = 20;
    for (const std::size_t output : {0u, 1u})
        for (int refresh = 0; refresh < kFrames; ++refresh) {
            const Time at = tickTime(refresh, 30);
            ASSERT_TRUE(recording->frame(output, RgbaImage(64, 48), {.refresh = refresh, .at = at}, at));
        }
    ASSERT_TRUE(recording->finish());
    std::istringstream table(*readFile(folder_ / "frames.csv"));
    std::string line;
    std::getline(table, line);
    for (int refresh = 0; refresh < kFrames; ++refresh)
        for (const char* output : {"left", "right"}) {
            ASSERT_TRUE(std::getline(table, line));
            EXPECT_THAT(line, testing::StartsWith(fmt::format("{},{:.6f},{},", refresh, seconds(tickTime(refresh, 30)), output)));
        }
    EXPECT_FALSE(std::getline(table, line)) << line;
}

// Example failure: a night's lamps are in memory until its end, and lost with the power.
TEST_F(RecordingTest, a_run_that_ends_suddenly_leaves_its_tables) {
    {
        auto recording = Recording::open(folder_, {{"left", {64, 48}, 30}}).value();
        for (int refresh = 0; refresh < 3; ++refresh)
            ASSERT_TRUE(recording->frame(0, RgbaImage(64, 48), {.refresh = refresh, .at = 1s * refresh}, 1s * refresh));
        recording->lighting(1s, 1, std::vector<std::uint8_t>{7, 0, 9, 0, 0});
        recording->relays(1s, "road", {true, false});
        EXPECT_THAT(recording->writeTables(), testing::IsEmpty());
    }
    EXPECT_THAT(*readFile(folder_ / "dmx.csv.unfinished"), HasSubstr("\n1.000000,1,7 0 9\n"));
    EXPECT_THAT(*readFile(folder_ / "relays.csv.unfinished"), HasSubstr("\n1.000000,road,10\n"));
    EXPECT_THAT(*readFile(folder_ / "frames.csv.unfinished"), HasSubstr("\n1,1.000000,left,"));
    EXPECT_FALSE(fs::exists(folder_ / "dmx.csv")) << "what has its name is whole";
}

// Example failure: the lamps' table takes the videos along, or ends the show.
TEST_F(RecordingTest, a_table_that_the_disk_has_no_room_for_ends_alone_and_is_told) {
    const ScratchFolder folder;
    fs::create_directories(folder / "videos");
    fs::create_symlink("/dev/full", folder / "videos/dmx.csv.unfinished");
    const nlohmann::json report = reportOf({"--seconds", "3", "--as-fast-as-possible"}, folder);
    EXPECT_EQ(report["frames"], 2 * 3 * 30);
    EXPECT_EQ(report["recorded"], report["frames_by_output"]);
    EXPECT_THAT(report["faults"].dump(),
                HasSubstr("dmx.csv: cannot be written: No space left on device; the show goes on without this table"));
    EXPECT_TRUE(fs::exists(folder / "videos/relays.csv"));
    EXPECT_FALSE(fs::exists(folder / "videos/dmx.csv"));
}

TEST_F(RecordingTest, one_video_file_holds_the_outputs_side_by_side) {
    record(folder_ / "all.mp4");
    EXPECT_TRUE(fs::exists(folder_ / "all.mp4"));
    EXPECT_FALSE(fs::exists(folder_ / "frames.csv"));
}

// The display was late, was gone for a second, and refreshes a little faster than its site file
// says.
TEST_F(RecordingTest, every_frame_is_at_the_moment_when_it_became_visible) {
    const Time moments[] = {Time{}, 33ms, 100ms, 1100ms, 1116ms, 1133ms};
    auto recording = Recording::open(folder_, {{"left", {64, 48}, 30}}).value();
    recording->begin(5s);
    for (const Time at : moments)
        ASSERT_TRUE(recording->frame(0, RgbaImage(64, 48), {.refresh = 0, .at = 5s + at}, at)) << seconds(at);
    ASSERT_TRUE(recording->finish());
    EXPECT_EQ(recording->recorded(0), 6);
    const Video video = readVideo(folder_ / "left.mp4");
    ASSERT_EQ(video.times.size(), std::size(moments));
    for (std::size_t i = 0; i < video.times.size(); ++i) EXPECT_NEAR(video.times[i], seconds(moments[i]), 1.0 / 240) << i;
    EXPECT_NEAR(video.seconds, 1.133 + 1.0 / 30, 1.0 / 200);
}

// Example failures: pictures of different moments side by side; nothing more once the last
// projector is unplugged.
TEST_F(RecordingTest, side_by_side_each_output_shows_what_it_showed_then) {
    auto recording = Recording::open(folder_ / "all.mp4", {{"left", {64, 48}, 30}, {"right", {64, 48}, 30}}).value();
    const auto show = [&](std::size_t output, int refresh) {
        const auto grey = static_cast<std::uint8_t>(40 * refresh + 20);
        const Time at = tickTime(refresh, 30);
        ASSERT_TRUE(recording->frame(output, RgbaImage(64, 48, {grey, grey, grey, 255}), {.refresh = refresh, .at = at}, at));
    };
    for (int refresh = 0; refresh < 3; ++refresh)
        for (const std::size_t output : {0u, 1u}) show(output, refresh);
    show(0, 3);  // the right one is unplugged
    show(0, 4);
    ASSERT_TRUE(recording->finish());
    EXPECT_EQ(recording->recorded(0), 5);
    EXPECT_EQ(recording->recorded(1), 3);
    const Video video = readVideo(folder_ / "all.mp4");
    ASSERT_EQ(video.frames.size(), 5u);
    for (int i = 0; i < 5; ++i) {
        const Rgba16Image& picture = video.frames[static_cast<std::size_t>(i)];
        EXPECT_NEAR(picture.at(20, 20).g / 257.0, 40 * i + 20, 4) << i;
        EXPECT_NEAR(picture.at(84, 20).g / 257.0, 40 * std::min(i, 2) + 20, 4) << i;
    }
}

// The first output's projector is away, and a quicker one leads: two of its frames are within half
// a refresh of the first. Example failure: every other frame is lost, and counted as recorded all
// the same.
TEST_F(RecordingTest, side_by_side_every_frame_of_a_quicker_output_is_there) {
    auto recording = Recording::open(folder_ / "all.mp4", {{"left", {64, 48}, 30}, {"right", {64, 48}, 60}}).value();
    constexpr int kFrames = 8;
    for (int refresh = 0; refresh < kFrames; ++refresh) {
        const auto grey = static_cast<std::uint8_t>(25 * refresh + 20);
        const Time at = tickTime(refresh, 60);
        const Shown shown{.refresh = refresh, .at = at};
        ASSERT_TRUE(recording->frame(1, RgbaImage(64, 48, {grey, grey, grey, 255}), shown, at));
    }
    ASSERT_TRUE(recording->finish());
    EXPECT_EQ(recording->recorded(0), 0);
    EXPECT_EQ(recording->recorded(1), kFrames);
    const Video video = readVideo(folder_ / "all.mp4");
    ASSERT_EQ(video.frames.size(), std::size_t{kFrames});
    for (int i = 0; i < kFrames; ++i) {
        EXPECT_NEAR(video.frames[static_cast<std::size_t>(i)].at(84, 20).g / 257.0, 25 * i + 20, 4) << i;
        EXPECT_NEAR(video.times[static_cast<std::size_t>(i)], i / 60.0, 1.0 / 240) << i;
    }
}

// Files of this program and of those that it starts may have so many bytes: the disk is full.
class FullDisk {
public:
    explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limited{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limited);
    }
    ~FullDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit before_{};
    sighandler_t handler_;
};

RgbaImage noise(glm::ivec2 size, std::uint64_t seed) {
    RgbaImage picture(size.x, size.y);
    Rng rng(seed);
    for (Rgba8& pixel : picture.pixels()) pixel.g = static_cast<std::uint8_t>(rng.below(256));
    return picture;
}

// Example failures: the error is told for every frame; the video that there is room for is lost
// with the other.
TEST_F(RecordingTest, a_video_that_the_disk_has_no_room_for_ends_alone_and_says_so_once) {
    constexpr glm::ivec2 kSize{256, 256};
    auto recording = Recording::open(folder_, {{"left", kSize, 30}, {"right", {64, 48}, 30}}).value();
    int refusals = 0;
    {
        const FullDisk full(200'000);
        for (int refresh = 0; refresh < 60; ++refresh) {
            const Shown shown{.refresh = refresh, .at = tickTime(refresh, 30)};
            const auto left = recording->frame(0, noise(kSize, static_cast<std::uint64_t>(refresh)), shown, shown.at);
            if (!left) {
                EXPECT_THAT(left.error().message(), AllOf(HasSubstr("left.mp4"), HasSubstr("File too large")));
                ++refusals;
            }
            ASSERT_TRUE(recording->frame(1, RgbaImage(64, 48), shown, shown.at));
        }
        EXPECT_TRUE(recording->finish());
    }
    EXPECT_EQ(refusals, 1);
    EXPECT_EQ(recording->recorded(0), 0);
    EXPECT_EQ(recording->recorded(1), 60);
    EXPECT_FALSE(fs::exists(folder_ / "left.mp4"));
    EXPECT_EQ(readVideo(folder_ / "right.mp4").frames.size(), 60u);
}

// What is missing is counted, however busy the machine is: every frame that was shown is in the
// file or in the count. Example failure: 321 of 447 frames are in the video, and nobody says so.
TEST_F(RecordingTest, under_full_load_every_frame_is_in_the_video_or_counted_as_missing) {
    const ScratchFolder folder;
    nlohmann::json report;
    {
        std::vector<std::jthread> load;
        for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i)
            load.emplace_back([](const std::stop_token& stop) {
                while (!stop.stop_requested()) continue;
            });
        report = reportOf({"--seconds", "3"}, folder);
    }
    for (const char* output : {"left", "right"}) {
        const std::size_t frames = report["frames_by_output"][output], recorded = report["recorded"][output],
                          missing = report["not_recorded"][output];
        EXPECT_EQ(recorded + missing, frames) << output;
        const Video video = readVideo(folder / "videos" / (std::string(output) + ".mp4"));
        EXPECT_EQ(video.frames.size(), recorded) << output;
        const std::string said = fmt::format("frames of '{}' are missing", output);
        EXPECT_EQ(report["faults"].dump().find(said) != std::string::npos, missing > 0) << output;
    }
}

TEST_F(RecordingTest, as_fast_as_possible_none_is_missing) {
    const ScratchFolder folder;
    const nlohmann::json report = reportOf({"--seconds", "2", "--as-fast-as-possible"}, folder);
    EXPECT_EQ(report["recorded"], report["frames_by_output"]);
    EXPECT_EQ(report["not_recorded"], nlohmann::json({{"left", 0}, {"right", 0}}));
    EXPECT_EQ(readVideo(folder / "videos/right.mp4").frames.size(), 60u);
}

// Example failure: the show ends, or its report is thrown away with the recording.
TEST_F(RecordingTest, on_a_full_disk_the_show_goes_on_and_the_report_says_when_it_was_full) {
    const ScratchFolder folder;
    nlohmann::json report;
    {
        const FullDisk full(60'000);
        report = reportOf({"--seconds", "4", "--from", "Full", "--by-hand", "--as-fast-as-possible"}, folder);
    }
    EXPECT_EQ(report["frames"], 2 * 4 * 30);
    EXPECT_EQ(report["recorded"]["left"], 0);
    EXPECT_EQ(report["not_recorded"]["left"], 4 * 30);
    const std::string faults = report["faults"].dump();
    EXPECT_THAT(faults, HasSubstr("left.mp4: cannot be written: File too large; the show goes on without this video"));
    EXPECT_THAT(faults, HasSubstr("120 of 120 frames of 'left' are missing"));
}

TEST_F(RecordingTest, another_kind_of_file_is_refused_with_advice) {
    const auto recording = Recording::open(folder_ / "all.avi", {});
    ASSERT_FALSE(recording);
    EXPECT_THAT(recording.error().message(), HasSubstr("ends in .mp4"));
}

}  // namespace
}  // namespace fantascope::app
