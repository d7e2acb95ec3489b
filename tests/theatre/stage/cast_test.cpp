#include "theatre/stage/cast.h"

#include "core/file.h"
#include "core/random.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fantascope::theatre {
namespace {

using testing::HasSubstr;

class CastFile : public testing::Test {
protected:
    // Two people, two frames, every joint somewhere within its limits.
    Cast cast() const {
        Cast cast;
        cast.targets[0].file = folder_ / "target \"x\".png";
        cast.targets[0].height = 1.85;
        cast.stage.beams[0].light = {0.25, 0.1, 6.5};
        cast.framesPerSecond = 12.5;
        cast.seed = 77;
        Rng rng(3);
        for (const double stature : {1.2, 1.8}) {
            const Body body = humanBody(stature);
            cast.actors.push_back({stature, {}});
            for (int frame = 0; frame < 2; ++frame) {
                std::vector<double> dofs(body.dofs);
                for (double& dof : dofs) dof = rng.uniform(-1.5, 1.5);
                body.limit(dofs);
                cast.actors.back().poses.push_back(poseOf(body, dofs));
            }
        }
        return cast;
    }
    std::string refusal(const std::string& from, const std::string& to) {
        EXPECT_TRUE(writeCast(folder_ / "a.cast.yaml", cast()));
        std::string text = readFile(folder_ / "a.cast.yaml").value();
        const auto at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        const auto end = from.back() == ':' ? text.find('\n', at) : at + from.size();
        text.replace(at, end - at, to);
        EXPECT_TRUE(writeFile(folder_ / "b.cast.yaml", text));
        const auto read = readCast(folder_ / "b.cast.yaml");
        return read ? "read" : read.error().message();
    }
    ScratchFolder folder_;
};

TEST_F(CastFile, comes_back_as_it_was) {
    const Cast written = cast();
    ASSERT_TRUE(writeCast(folder_ / "a.cast.yaml", written));
    const auto read = readCast(folder_ / "a.cast.yaml");
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->targets[0].file, written.targets[0].file);
    EXPECT_EQ(read->targets[0].height, written.targets[0].height);
    EXPECT_EQ(read->stage.beams[0].light, written.stage.beams[0].light);
    EXPECT_EQ(read->framesPerSecond, written.framesPerSecond);
    EXPECT_EQ(read->seed, written.seed);
    ASSERT_EQ(read->actors.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(read->actors[i].stature, written.actors[i].stature);
        ASSERT_EQ(read->actors[i].poses.size(), 2u);
        for (std::size_t frame = 0; frame < 2; ++frame) {
            EXPECT_EQ(read->actors[i].poses[frame].root, written.actors[i].poses[frame].root);
            EXPECT_EQ(read->actors[i].poses[frame].turns, written.actors[i].poses[frame].turns) << "to the last bit";
        }
    }
}

// The easy wrong version keeps the light, and whoever opens the file sees people on air.
TEST_F(CastFile, brings_its_stage) {
    ASSERT_TRUE(
        writeFile(folder_ / "own/hall.stage.yaml",
                  "fantascope: stage\nversion: 1\nlight: [0.5, 0.2, 6]\nplatforms:\n  - {name: step, centre: [0, 0.2, 2], "
                  "size: [1, 0.4, 1]}\n"));
    Cast written = cast();
    written.stageFile = folder_ / "own/hall.stage.yaml";
    ASSERT_TRUE(writeCast(folder_ / "a.cast.yaml", written));
    const auto read = readCast(folder_ / "a.cast.yaml");
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->stage.beams[0].light, glm::dvec3(0.5, 0.2, 6));
    ASSERT_EQ(read->stage.platforms.size(), 1u);
    EXPECT_EQ(read->stage.platforms[0].name, "step");
    EXPECT_EQ(read->stageFile, written.stageFile);
    written.stageFile = folder_ / "gone.stage.yaml";
    const auto gone = writeCast(folder_ / "a.cast.yaml", written);
    ASSERT_FALSE(gone);
    EXPECT_THAT(gone.error().message(), HasSubstr("gone.stage.yaml"));
    EXPECT_TRUE(readCast(folder_ / "a.cast.yaml")) << "the good one is still there";
    EXPECT_THAT(refusal("light: [0.25, 0.1, 6.5]\n", ""), HasSubstr("no light"));
    EXPECT_THAT(refusal("light: [0.25, 0.1, 6.5]\n", "light: [0, 0, 6]\nstage: own/hall.stage.yaml\n"),
                HasSubstr("a 'light' too"));
    EXPECT_THAT(refusal("light: [0.25, 0.1, 6.5]\n", "stage: own/hall.stage.yaml\n"), "read");
}

// What a search works with comes back from what the file keeps.
TEST_F(CastFile, poses_and_degrees_of_freedom_are_two_ways_to_say_the_same) {
    const Body body = humanBody(1.7);
    Rng rng(9);
    for (int i = 0; i < 200; ++i) {
        std::vector<double> dofs(body.dofs);
        for (double& dof : dofs) dof = rng.uniform(-1.5, 1.5);
        body.limit(dofs);
        const auto back = dofsOf(body, poseOf(body, dofs));
        for (std::size_t k = 0; k < dofs.size(); ++k) EXPECT_NEAR(back[k], dofs[k], 1e-9) << k;
    }
}

TEST_F(CastFile, says_where_a_file_is_wrong) {
    EXPECT_THAT(refusal("left knee:", "left knee: [0.7071067811865476, -0.7071067811865476, 0, 0]"),
                AllOf(HasSubstr("b.cast.yaml:"), HasSubstr("left knee"), HasSubstr("cannot turn like this: -90.0 degrees")));
    EXPECT_THAT(refusal("left knee:", "left knee: [0.5, 0, 0, 0]"), HasSubstr("length 1"));
    EXPECT_THAT(refusal("left knee:", "left kne: [1, 0, 0, 0]"), HasSubstr("did you mean 'left knee'?"));
    EXPECT_THAT(refusal("stature: 1.2", "stature: 12"), HasSubstr("0.5 .. 2.5"));
    EXPECT_THAT(refusal("version: 1", "version: 2"), HasSubstr("version"));
    EXPECT_THAT(refusal("target:", "target: ../target.png"), HasSubstr("target"));
}

// Example failure: a show that divides by nothing.
TEST_F(CastFile, that_moves_says_how_fast) {
    Cast timeless = cast();
    timeless.framesPerSecond = 0;
    const auto written = writeCast(folder_ / "a.cast.yaml", timeless);
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message(), HasSubstr("no 'frames_per_second'"));
}

TEST_F(CastFile, frames_must_be_as_many_for_everyone) {
    Cast uneven = cast();
    uneven.actors[1].poses.pop_back();
    const auto written = writeCast(folder_ / "a.cast.yaml", uneven);
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message(), AllOf(HasSubstr("not written"), HasSubstr("1 poses, and the first actor has 2")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.cast.yaml"));
}

TEST_F(CastFile, its_target_lies_beside_it) {
    Cast away = cast();
    away.targets[0].file = "/somewhere/else.png";
    const auto written = writeCast(folder_ / "a.cast.yaml", away);
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message(), HasSubstr("copy it there first"));
}

// A cast for a stage with further beams, and what others want to read.
TEST_F(CastFile, has_a_target_for_each_beam) {
    const std::string stage = "fantascope: stage\nversion: 1\nlight: [0, 0, 7]\n";
    const std::string further = "further_beams: [{light: [-6, 0, 1.5], screen: {at: [2.5, 0, 1.5], turned: -90}}]\n";
    ASSERT_TRUE(writeFile(folder_ / "a.stage.yaml", stage + further));
    Cast written = cast();
    written.stageFile = folder_ / "a.stage.yaml";
    written.targets.push_back({folder_ / "other: one.png", 1.25, -0.375});
    ASSERT_TRUE(writeCast(folder_ / "a.cast.yaml", written));
    const auto read = readCast(folder_ / "a.cast.yaml");
    ASSERT_TRUE(read) << read.error().message();
    ASSERT_EQ(read->targets.size(), 2u);
    EXPECT_EQ(read->targets[1].file, written.targets[1].file);
    EXPECT_EQ(read->targets[1].height, 1.25);
    EXPECT_EQ(read->targets[1].middle, -0.375);
    EXPECT_FALSE(read->targets[0].middle) << "it is in front of the light";
    EXPECT_EQ(read->stage.beams.size(), 2u);

    written.targets.pop_back();
    const auto without = writeCast(folder_ / "b.cast.yaml", written);
    ASSERT_FALSE(without);
    EXPECT_THAT(without.error().message(), HasSubstr("0 further_targets, and the stage has 1 further_beams"));
    ASSERT_TRUE(writeFile(folder_ / "a.stage.yaml", stage));
    const auto alone = readCast(folder_ / "a.cast.yaml");
    ASSERT_FALSE(alone);
    EXPECT_THAT(alone.error().message(), HasSubstr("1 further_targets, and the stage has 0"));
}

}  // namespace
}  // namespace fantascope::theatre
