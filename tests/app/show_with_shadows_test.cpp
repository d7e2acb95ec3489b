// A show with shadow theatre, from the drawing to the wall, as a person makes it.

#include "app/export/cast_scene.h"

#include "theatre/deform/silhouette_sequence.h"
#include "theatre/search/pose_search.h"
#include "theatre/stage/cast.h"

#include "core/file.h"
#include "media/image.h"
#include "pictures.h"
#include "program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Arguments = std::vector<std::string>;

constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Test
sources:
  still: {shadow: bar.cast.yaml}
  moves: {shadow: {cast: moving.cast.yaml}}
looks:
  still: {outputs: {left: [{source: still}]}}
  moves: {outputs: {left: [{source: moves}]}}
cues: [{name: Still, look: still, fade: 0}, {name: Moves, look: moves, fade: 0}]
)";
constexpr glm::ivec2 kPicture{160, 140};

class ShowWithShadows : public testing::Test {
protected:
    ShowWithShadows() {
        fs::copy(prepared() / ".", folder_ / ".", fs::copy_options::recursive);
        folder_.file("show.yaml", kShow);
    }
    // What every test begins with, made once.
    static const ScratchFolder& prepared() {
        static const ScratchFolder folder;
        if (fs::exists(folder / "moving.cast.yaml")) return folder;
        EXPECT_TRUE(writePng(folder / "bar.png",
                             pictureOf(kPicture.x, kPicture.y, [](int x, int y) { return isIn(x, y, 60, 30, 30, 100); })));
        EXPECT_THAT(runProgram({"pose", "bar.png", "-o", "bar.cast.yaml", "--actors", "1", "--trials", "1", "--evaluations",
                                "2000", "--report", "report.json"},
                               folder / "."),
                    exits(0));
        // Frames without a sequence, as somebody may write them: he leans.
        theatre::Cast cast = theatre::readCast(folder / "bar.cast.yaml").value();
        cast.framesPerSecond = 10;
        for (int frame = 0; frame < 5; ++frame) {
            theatre::ActorPose pose = cast.actors[0].poses.back();
            pose.root.x += 0.05;
            cast.actors[0].poses.push_back(pose);
        }
        EXPECT_TRUE(theatre::writeCast(folder / "moving.cast.yaml", cast));
        return folder;
    }
    Outcome run(const Arguments& arguments) const { return runProgram(arguments, folder_ / "."); }
    std::string refusal(const std::string& source) const {
        folder_.file("show.yaml",
                     fmt::format("fantascope: show\nversion: 1\ntitle: Test\nsources:\n  him: {{shadow: {}}}\n"
                                 "looks:\n  a: {{outputs: {{left: [{{source: him}}]}}}}\ncues: [{{name: A, look: a, fade: 0}}]\n",
                                 source));
        const Outcome done = run({"rehearse", ".", "--seconds", "0.1", "--as-fast-as-possible"});
        EXPECT_THAT(done, exits(1)) << source;
        return done.errors;
    }
    const ScratchFolder folder_;
};

// What the wall shows is what the search found, down to the figure that it reported.
TEST_F(ShowWithShadows, throws_the_shadow_that_was_found) {
    constexpr int kFiner = 4;
    const glm::ivec2 size = kFiner * kPicture;
    const std::string sizeText = fmt::format("{}x{}", size.x, size.y);
    ASSERT_THAT(run({"export", ".", "--output", "left", "--cue", "Still", "--canvas", "--size", sizeText, "--seconds", "0.03",
                     "--fps", "30", "--alpha", "none", "-o", "frames"}),
                exits(0));
    const GreyImage seen = readGrey(folder_ / "frames" / "frame-000000.png").value();
    const GreyImage target = readGrey(folder_ / "bar.png").value();
    ASSERT_EQ(glm::ivec2(seen.width(), seen.height()), size);
    int both = 0, either = 0;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const bool shadow = seen.at(x, y)<0.5f, wanted = target.at(x / kFiner, y / kFiner)> 0.5f;
            both += shadow && wanted, either += shadow || wanted;
        }
    const double reported = nlohmann::json::parse(readFile(folder_ / "report.json").value())["iou"];
    EXPECT_NEAR(static_cast<double>(both) / either, reported, 0.015);
    EXPECT_GT(reported, 0.6) << "something was found at all";
}

TEST_F(ShowWithShadows, is_the_same_to_the_byte_as_fast_as_possible) {
    for (const char* name : {"a", "b"})
        ASSERT_THAT(run({"rehearse", ".", "--seconds", "1.5", "--from", "Moves", "--as-fast-as-possible", "--record", name}),
                    exits(0));
    EXPECT_EQ(readFile(folder_ / "a/left.mp4").value(), readFile(folder_ / "b/left.mp4").value());
}

// A cue alone lasts as long as its movement.
TEST_F(ShowWithShadows, is_exported_from_its_first_frame_to_its_last) {
    ASSERT_THAT(run({"export", ".", "--output", "left", "--cue", "Moves", "--fps", "20", "-o", "film"}), exits(0));
    int frames = 0;
    for ([[maybe_unused]] const auto& file : fs::directory_iterator(folder_ / "film")) ++frames;
    EXPECT_EQ(frames, 10);
    EXPECT_NE(readFile(folder_ / "film/frame-000000.png").value(), readFile(folder_ / "film/frame-000009.png").value());
}

TEST_F(ShowWithShadows, says_what_cannot_be_played) {
    EXPECT_THAT(refusal("{cast: moving.cast.yaml, play: loop}"), HasSubstr("as a loop it would jump; take 'to_and_fro'"));
    EXPECT_THAT(refusal("{cast: bar.cast.yaml, actors: [[1, 0, 0], [0, 1, 0]]}"), HasSubstr("2 colours of 'actors', but"));
    folder_.file("broken.cast.yaml", "fantascope: cast\nversion: 1\n");
    EXPECT_THAT(refusal("broken.cast.yaml"), HasSubstr("broken.cast.yaml"));
    fs::remove(folder_ / "bar.png");
    EXPECT_THAT(refusal("bar.cast.yaml"), HasSubstr("bar.png"));
}

// Without its picture nobody knows what the shadow is to be; the show plays all the same.
TEST_F(ShowWithShadows, plays_on_without_a_score_if_the_target_is_missing) {
    folder_.file("show.yaml",
                 "fantascope: show\nversion: 1\ntitle: Test\n"
                 "sources: {him: {shadow: {cast: bar.cast.yaml, picture: {x: [-2.56, 2.56], y: [-0.1, 2.78]}}}}\n"
                 "looks: {a: {outputs: {left: [{source: him}]}}}\ncues: [{name: A, look: a, fade: 0}]\n");
    const Arguments rehearsal = {"rehearse", ".",       "--seconds", "1", "--from", "A", "--as-fast-as-possible",
                                 "--report", "run.json"};
    const auto scores = [&] { return nlohmann::json::parse(readFile(folder_ / "run.json").value())["iou_camera"]["left"]; };
    EXPECT_THAT(run(rehearsal), exits(0));
    EXPECT_FALSE(scores().empty());
    fs::remove(folder_ / "bar.png");
    const Outcome blind = run(rehearsal);
    EXPECT_THAT(blind, exits(0));
    EXPECT_THAT(blind.errors, testing::AllOf(HasSubstr("the shadow of 'him' is not scored"), HasSubstr("bar.png")));
    EXPECT_TRUE(scores().empty());
}

// The menagerie's casts as they lie in its folder: people can hold every frame, it reads as the
// drawing, and nobody slides or leaps.
TEST(Menagerie, is_played_by_people_who_can_do_it) {
    const fs::path folder = sourceFolder() + "/shows/menagerie";
    for (const char* name : {"rabbit", "elephant", "car"}) {
        const fs::path file = folder / (std::string(name) + ".cast.yaml");
        const auto cast = theatre::readCast(file);
        ASSERT_TRUE(cast) << cast.error().message();
        const std::size_t frames = cast->actors[0].poses.size();
        ASSERT_TRUE(cast->sequence);
        EXPECT_EQ(frames, theatre::readSequence(cast->sequence->file).value().pictures.size()) << name << " is not whole";
        double mean = 0;
        for (std::size_t frame = 0; frame < frames; ++frame) {
            const auto scene = app::readCastScene(file, frame);
            ASSERT_TRUE(scene) << scene.error().message();
            const auto quality = theatre::PoseSearch::measure(scene->problem, scene->dofs);
            EXPECT_TRUE(quality.isValid()) << name << ", frame " << frame;
            EXPECT_GE(quality.iou, 0.88) << name << ", frame " << frame;
            mean += quality.iou / static_cast<double>(frames);
        }
        EXPECT_GE(mean, 0.92) << name;
    }
    EXPECT_THAT(runProgram({"check", folder.string(), "--site", sourceFolder() + "/config/simulated"}, folder), exits(0));
}

double meanIou(const nlohmann::json& series, double from, double to) {
    double sum = 0;
    int count = 0;
    for (const nlohmann::json& entry : series)
        if (const double at = entry[0]; at >= from && at < to) sum += entry[1].get<double>(), ++count;
    EXPECT_GT(count, 5) << from << " .. " << to;
    return sum / std::max(1, count);
}

// On the default site, with a sky, a lamp on the sculpture and a camera whose pixels are 3 cm on
// the wall.
TEST(Menagerie, is_scored_by_the_camera_as_its_search_scored_it) {
    const ScratchFolder folder;
    const fs::path shows = sourceFolder() + "/shows/menagerie";
    fs::copy(sourceFolder() + "/config/simulated", folder / "site", fs::copy_options::recursive);
    std::string site = readFile(folder / "site" / "site.yaml").value();
    const std::string section = "\nsimulation:\n";
    site.replace(site.find(section), section.size(),
                 "\ncorrections: {geometry: {mode: advise}}" + section +
                     "  faults: [{kind: bump, output: left, at: 6, turn: [0, 1, 0]}]\n");
    ASSERT_TRUE(writeFile(folder / "site" / "site.yaml", site));
    ASSERT_THAT(runProgram({"rehearse", shows.string(), "--site", (folder / "site").string(), "--from", "Rabbit", "--by-hand",
                            "--seconds", "8", "--as-fast-as-possible", "--report", "run.json"},
                           folder / "."),
                exits(0));
    const nlohmann::json report = nlohmann::json::parse(readFile(folder / "run.json").value());
    const nlohmann::json& series = report["iou_camera"]["left"];
    EXPECT_TRUE(report["iou_camera"]["right"].empty()) << "a pattern is no shadow";

    // From 3 to 6 s, the rabbit's 16 frames are played more than once.
    const fs::path file = shows / "rabbit.cast.yaml";
    const std::size_t frames = theatre::readCast(file).value().actors[0].poses.size();
    double searched = 0;
    for (std::size_t frame = 0; frame < frames; ++frame) {
        const auto scene = app::readCastScene(file, frame);
        ASSERT_TRUE(scene) << scene.error().message();
        searched += theatre::PoseSearch::measure(scene->problem, scene->dofs).iou / static_cast<double>(frames);
    }
    const double before = meanIou(series, 3, 6), bumped = meanIou(series, 6.5, 8);
    EXPECT_NEAR(before, searched, 0.06);
    EXPECT_LT(bumped, before - 0.15);
}

}  // namespace
}  // namespace fantascope
