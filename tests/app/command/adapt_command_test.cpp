// The program as a person runs it: its exit statuses, its messages, and what it leaves behind.

#include "theatre/body/posed_body.h"
#include "theatre/deform/silhouette_sequence.h"
#include "theatre/stage/cast.h"
#include "theatre/stage/continuity.h"

#include "core/file.h"
#include "media/image.h"
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
using testing::Not;
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
            runProgram({"pose", "bar.png", "-o", "bar.cast.yaml", "--actors", "1", "--trials", "1", "--evaluations", "4000"},
                       folder / "."),
            exits(0));
        return folder;
    }
    static GreyImage bar(int left) {
        return pictureOf(160, 140, [=](int x, int y) { return isIn(x, y, left, 30, 30, 100); });
    }
    Outcome run(const Arguments& arguments) const { return runProgram(arguments, folder_ / "."); }
    Outcome adapt(const Arguments& more = {}) const { return adaptTo("motion.cast.yaml", more); }
    Outcome adaptTo(const std::string& file, const Arguments& more) const {
        Arguments arguments = {"adapt", "bar.cast.yaml", "moves", "-o", file, "--searches", "4"};
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
    const theatre::Body body = theatre::humanBody(motion.actors[0].stature);
    EXPECT_GT(theatre::poseDifference(body, theatre::dofsOf(body, poses[5]), poses[0]), 0.01) << "some ten degrees in two joints";

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
    // The signal is sent once it works, after a line on the frame in the middle: its first frame
    // would take years.
    EXPECT_EQ(
        interruptProgram({"adapt", "bar.cast.yaml", "moves", "-o", "motion.cast.yaml", "--searches", "100000", "--wanted", "1"},
                         folder_ / ".", 2),
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

// Whatever the sequence says, and the frames stay the same ones.
TEST_F(AdaptCommand, plays_a_sequence_at_another_rate) {
    ASSERT_THAT(adapt({"--passes", "0"}), exits(0));
    const theatre::Cast slow = cast();
    ASSERT_THAT(adaptTo("quick.cast.yaml", {"--passes", "0", "--fps", "25"}), exits(0));
    const theatre::Cast quick = cast("quick.cast.yaml");
    EXPECT_EQ(slow.framesPerSecond, 10);
    EXPECT_EQ(quick.framesPerSecond, 25);
    ASSERT_EQ(quick.actors[0].poses.size(), slow.actors[0].poses.size());
    for (std::size_t i = 0; i < slow.actors[0].poses.size(); ++i)
        EXPECT_EQ(quick.actors[0].poses[i].root, slow.actors[0].poses[i].root) << i;
}

// What is left of a run that was interrupted is gone on with to the same bytes, wherever it was
// cut.
TEST_F(AdaptCommand, goes_on_to_the_same_bytes) {
    ASSERT_THAT(adapt({"--passes", "1"}), exits(0));
    const std::string whole = text("motion.cast.yaml");
    ASSERT_THAT(adapt({"--passes", "0"}), exits(0));
    for (const std::size_t count : {2u, 4u}) {
        theatre::Cast part = cast();
        for (auto& actor : part.actors) actor.poses.resize(count);
        ASSERT_TRUE(theatre::writeCast(folder_ / "part.cast.yaml", part));
        const Outcome rest = adaptTo("part.cast.yaml", {"--passes", "1"});
        ASSERT_THAT(rest, exits(0));
        EXPECT_THAT(rest.errors, HasSubstr(fmt::format("goes on with {} of 6 frames", count)));
        EXPECT_TRUE(whole == text("part.cast.yaml")) << count;
    }
}

// A block that stands, and a rod in the hand: they are on the stage of every frame, and the stage
// goes where the motion goes.
TEST_F(AdaptCommand, takes_the_stage_along_and_says_what_props_bring) {
    const ScratchFolder elsewhere;
    fs::copy(folder_ / "bar.png", elsewhere / "bar.png");
    const std::string block = "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    elsewhere.file("block.obj", block);
    elsewhere.file(
        "hall.stage.yaml",
        "fantascope: stage\nversion: 1\nlight: [0, 0, 7]\nprops:\n  - {name: block, mesh: block.obj, at: [-0.1, 0, 1]}\n"
        "  - {name: rod, mesh: block.obj, scale: 0.5, held_by: {actor: 1, part: left hand}}\n");
    ASSERT_THAT(run({"pose", "bar.png", "-o", elsewhere / "bar.cast.yaml", "--actors", "1", "--trials", "1", "--evaluations",
                     "2000", "--stage", elsewhere / "hall.stage.yaml"}),
                exits(0));
    const Outcome done = run({"adapt", elsewhere / "bar.cast.yaml", "moves", "-o", "motion.cast.yaml", "--searches", "2",
                              "--report", "r.json", "--sheet", "sheet.png"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(done.out, HasSubstr("; the people's shadow alone 0."));
    const auto report = nlohmann::json::parse(text("r.json"));
    EXPECT_GT(report["props_cover_mean"].get<double>(), 0.02);
    EXPECT_LT(report["iou_without_props_mean"].get<double>(), report["iou_mean"].get<double>());
    EXPECT_EQ(report["frames"][5].count("iou_without_props"), 1u);

    for (const char* file : {"hall.stage.yaml", "block.obj"}) fs::remove(elsewhere / file);
    const theatre::Cast motion = cast();
    ASSERT_EQ(motion.stage.props.size(), 2u);
    ASSERT_TRUE(motion.stageFile);
    EXPECT_EQ(motion.stageFile->lexically_relative(folder_ / "."), "motion.stage/hall.stage.yaml");
    EXPECT_THAT(run({"plot", "motion.cast.yaml", "-o", "p.png", "--frame", "5"}), exits(0));
}

// The best that can be done is done, and it says what is in doubt.
TEST_F(AdaptCommand, warns_of_frames_that_are_hard_to_follow) {
    const Outcome steady = adapt({"--passes", "0"});
    EXPECT_THAT(steady, exits(0));
    EXPECT_THAT(steady.errors, Not(HasSubstr("warning")));
    fs::create_directories(folder_ / "shots");
    const auto shots = [&](const std::vector<int>& lefts) {
        for (std::size_t i = 0; i < lefts.size(); ++i)
            EXPECT_TRUE(writePng(folder_ / fmt::format("shots/{}.png", i), bar(lefts[i])));
        return run({"adapt", "bar.cast.yaml", "shots", "-o", "m.cast.yaml", "--searches", "0", "--passes", "0",
                    "--representative", "1"});
    };
    const Outcome jumps = shots({60, 62, 85, 86});
    EXPECT_THAT(jumps, exits(0));
    EXPECT_THAT(
        jumps.errors,
        AllOf(HasSubstr("adapt: warning: from frame 2 to frame 3 the silhouette jumps: 13 % of what either covers is in both"),
              HasSubstr("put frames in between"), Not(HasSubstr("from frame 1"))));
    // 30 columns of which 22 are common from one to the next, and 14 to the one after it.
    const Outcome aside = shots({60, 64, 68, 72});
    EXPECT_THAT(aside.errors, AllOf(HasSubstr("adapt: frame 2 is more like all the others than frame 1"),
                                    HasSubstr("shots/1.png"), Not(HasSubstr("warning"))));

    theatre::SilhouetteSequence sequence = theatre::readSequence(folder_ / "moves/sequence.yaml").value();
    auto& vertices = sequence.interior->vertices;
    const glm::uvec3 triangle = sequence.interior->triangles[0];
    const glm::dvec2 first = vertices[3][triangle.x];
    // Its corner goes beyond its opposite side.
    vertices[3][triangle.x] = vertices[3][triangle.y] + vertices[3][triangle.z] - first;
    ASSERT_TRUE(theatre::writeSequence(folder_ / "moves/folded.yaml", sequence));
    EXPECT_THAT(
        run({"adapt", "bar.cast.yaml", "moves/folded.yaml", "-o", "f.cast.yaml", "--searches", "0", "--passes", "0"}).errors,
        AllOf(HasSubstr("adapt: warning: frame 4: "), HasSubstr("are folded over, against frame 1")));
    for (glm::dvec2& vertex : vertices[4]) vertex.x += 30;
    ASSERT_TRUE(theatre::writeSequence(folder_ / "moves/other.yaml", sequence));
    const Outcome other = run({"adapt", "bar.cast.yaml", "moves/other.yaml", "-o", "o.cast.yaml"});
    EXPECT_THAT(other, exits(1));
    EXPECT_THAT(other.errors,
                AllOf(HasSubstr("frame 5: its triangles are not those of its picture"), HasSubstr("leave 'interior' out")));
}

}  // namespace
}  // namespace fantascope
