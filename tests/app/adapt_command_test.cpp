// The program as a person runs it: its exit statuses, its messages, and what it leaves behind.

#include "theatre/cast.h"
#include "theatre/posed_body.h"
#include "theatre/silhouette_sequence.h"

#include "core/file.h"
#include "core/image.h"
#include "pictures.h"
#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using Arguments = std::vector<std::string>;

// Somebody whose shadow is about a bar, and the bar that bends to the right within six frames.
class AdaptCommand : public testing::Test {
protected:
    AdaptCommand() { fs::copy(prepared() / ".", folder_ / ".", fs::copy_options::recursive); }
    // What every test begins with, made once.
    static const ScratchFolder& prepared() {
        static const ScratchFolder folder;
        if (fs::exists(folder / "bar.cast.yaml")) return folder;
        EXPECT_TRUE(writePng(folder / "bar.png", bar(60)));
        folder.file("bar.motion.yaml",
                    "fantascope: motion\nversion: 1\nseconds: 0.5\nframes_per_second: 10\nhandles:\n"
                    "  - {name: left foot, at: [0.4, 0.9]}\n  - {name: right foot, at: [0.54, 0.9]}\n"
                    "  - {name: top, at: [0.47, 0.25], keys: [{time: 0, by: [0, 0]}, {time: 0.5, by: [0.2, 0.05]}]}\n");
        EXPECT_THAT(runProgram({"deform", "bar.png", "--motion", "bar.motion.yaml", "-o", "moves"}, folder / "."), exits(0));
        EXPECT_THAT(
            runProgram({"pose", "bar.png", "-o", "bar.cast.yaml", "--actors", "1", "--trials", "1", "--evaluations", "2000"},
                       folder / "."),
            exits(0));
        return folder;
    }
    static GreyImage bar(int left) {
        return pictureOf(160, 140, [=](int x, int y) { return isIn(x, y, left, 30, 30, 100); });
    }
    Outcome run(const Arguments& arguments) const { return runProgram(arguments, folder_ / "."); }
    Outcome adapt(const Arguments& more = {}) const {
        Arguments arguments = {"adapt", "bar.cast.yaml", "moves", "-o", "motion.cast.yaml", "--searches", "4"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    std::string text(const std::string& file) const { return readFile(folder_ / file).value(); }
    theatre::Cast cast(const std::string& file = "motion.cast.yaml") const {
        auto read = theatre::readCast(folder_ / file);
        EXPECT_TRUE(read) << read.error().message();
        return std::move(read).value();
    }

    const ScratchFolder folder_;
};

TEST_F(AdaptCommand, poses_follow_the_silhouette_and_the_feet_stay) {
    ASSERT_THAT(adapt({"--report", "r.json", "--sheet", "sheet.png", "--video", "v.mp4"}), exits(0));
    const theatre::Cast motion = cast();
    ASSERT_EQ(motion.actors.size(), 1u);
    ASSERT_EQ(motion.actors[0].poses.size(), 6u);
    EXPECT_EQ(motion.framesPerSecond, 10);
    ASSERT_TRUE(motion.sequence);
    EXPECT_EQ(motion.sequence->representative, 0u);
    EXPECT_EQ(motion.sequence->first, 0u);
    EXPECT_TRUE(theatre::readSequence(motion.sequence->file));
    // The first frame is the principal poses', and they move on from it.
    const theatre::ActorPose principal = cast("bar.cast.yaml").actors[0].poses[0];
    const auto& poses = motion.actors[0].poses;
    EXPECT_LT(glm::distance(poses[0].root, principal.root), 1e-9);
    EXPECT_GT(glm::distance(poses[5].root, poses[0].root), 0.02);

    const auto report = nlohmann::json::parse(text("r.json"));
    EXPECT_LE(report["farthest_contact"].get<double>(), 0.01);
    EXPECT_LE(report["fastest_joint"].get<double>(), 600);
    ASSERT_EQ(report["frames"].size(), 6u);
    EXPECT_GT(report["iou_worst"].get<double>(), 0.8);
    for (const char* file : {"sheet.png", "v.mp4"}) EXPECT_GT(fs::file_size(folder_ / file), 1000u) << file;

    // A frame of it is drawn against that frame's silhouette.
    ASSERT_THAT(run({"plot", "motion.cast.yaml", "-o", "p.png", "--figure", "shadow", "--frame", "5"}), exits(0));
    ASSERT_THAT(run({"plot", "motion.cast.yaml", "-o", "q.png", "--figure", "shadow", "--frame", "6"}), exits(1));
}

TEST_F(AdaptCommand, is_the_same_bytes_for_a_seed_on_any_number_of_threads) {
    ASSERT_THAT(adapt({"--threads", "1"}), exits(0));
    const std::string one = text("motion.cast.yaml");
    ASSERT_THAT(adapt({"--threads", "2"}), exits(0));
    EXPECT_TRUE(one == text("motion.cast.yaml"));
}

TEST_F(AdaptCommand, goes_on_with_what_was_interrupted) {
    ASSERT_THAT(adapt({"--passes", "0"}), exits(0));
    const std::string whole = text("motion.cast.yaml");
    fs::remove(folder_ / "motion.cast.yaml");
    // The signal is sent once it works: its first frame would take years.
    EXPECT_EQ(
        interruptProgram({"adapt", "bar.cast.yaml", "moves", "-o", "motion.cast.yaml", "--searches", "100000", "--wanted", "1"},
                         folder_ / ".", 1),
        0);
    EXPECT_EQ(cast().actors[0].poses.size(), 1u) << "the representative frame, which was there";
    const Outcome rest = adapt({"--passes", "0"});
    ASSERT_THAT(rest, exits(0));
    EXPECT_THAT(rest.errors, HasSubstr("goes on with 1 of 6 frames"));
    EXPECT_TRUE(whole == text("motion.cast.yaml"));
}

// Where poses and silhouettes come from different hands.
TEST_F(AdaptCommand, finds_the_frame_that_the_poses_are_of) {
    fs::create_directories(folder_ / "shots");
    for (int i = 0; i < 4; ++i)  // narrower ones first
        EXPECT_TRUE(writePng(folder_ / fmt::format("shots/{}.png", i),
                             pictureOf(160, 140, [=](int x, int y) { return isIn(x, y, 75 - 5 * i, 30, 15 + 5 * i, 100); })));
    const Outcome outcome = run({"adapt", "bar.cast.yaml", "shots", "-o", "motion.cast.yaml", "--searches", "0", "--fps", "4"});
    ASSERT_THAT(outcome, exits(0));
    EXPECT_EQ(cast().sequence->representative, 3u);
    EXPECT_EQ(cast().framesPerSecond, 4);
    EXPECT_THAT(outcome.out, HasSubstr("4 frames from frame 4"));
    // A motion elsewhere takes its pictures along.
    ASSERT_THAT(
        run({"adapt", "bar.cast.yaml", "shots", "-o", "far/away/m.cast.yaml", "--searches", "0", "--representative", "4"}),
        exits(0));
    EXPECT_EQ(theatre::readSequence(cast("far/away/m.cast.yaml").sequence->file).value().pictures.size(), 4u);
}

TEST_F(AdaptCommand, refuses_what_it_cannot_follow) {
    const auto refused = [&](const Arguments& arguments, const auto& what) {
        const Outcome outcome = run(arguments);
        EXPECT_THAT(outcome, exits(1));
        EXPECT_THAT(outcome.errors, what);
    };
    refused({"adapt", "bar.cast.yaml", "moves", "-o", "bar.cast.yaml"}, HasSubstr("would be overwritten"));
    refused({"adapt", "bar.cast.yaml", "nowhere", "-o", "m.cast.yaml"}, HasSubstr("is not there"));
    fs::create_directories(folder_ / "empty");
    refused({"adapt", "bar.cast.yaml", "empty", "-o", "m.cast.yaml"}, HasSubstr("neither a sequence.yaml nor pictures"));
    refused({"adapt", "bar.cast.yaml", "moves", "-o", "m.cast.yaml", "--representative", "7"}, HasSubstr("has 6 frames"));
    refused({"adapt", "bar.cast.yaml", "moves", "-o", "m.cast.yaml", "--fps", "7"},
            HasSubstr("--fps is for a folder of pictures"));

    fs::create_directories(folder_ / "shots");
    const auto shot = [&](int number, const GreyImage& picture) {
        EXPECT_TRUE(writePng(folder_ / fmt::format("shots/{}.png", number), picture));
    };
    const Arguments shots = {"adapt", "bar.cast.yaml", "shots", "-o", "m.cast.yaml", "--representative", "1"};
    shot(1, bar(60));
    shot(2, GreyImage(160, 140));
    refused(shots, AllOf(HasSubstr("frame 2"), HasSubstr("nothing in it is white")));
    shot(2, pictureOf(150, 140, [](int x, int y) { return isIn(x, y, 60, 30, 30, 100); }));
    refused(shots, AllOf(HasSubstr("frame 2"), HasSubstr("all are to be of one size")));
    shot(2, pictureOf(160, 140, [](int x, int y) { return isIn(x, y, 60, 35, 30, 100); }));
    refused(shots, AllOf(HasSubstr("frame 2"), HasSubstr("below the floor")));
}

}  // namespace
}  // namespace fantascope
