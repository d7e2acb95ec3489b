// A calibration that is killed at any moment leaves the site as it was or as it is to be, and
// everything goes on from there.

#include "app/site/site_file.h"
#include "app/site/survey_file.h"

#include "core/clock.h"
#include "core/random.h"
#include "killed_program.h"
#include "program.h"
#include "running_program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::IsEmpty;
using Arguments = std::vector<std::string>;

// As small as it can be measured.
constexpr std::string_view kSmallSite = R"(fantascope: site
version: 1
outputs:
  - name: left   # on the ladder
    display: {driver: headless}
    size: [160, 90]
    refresh_rate: 30
    corners: [[0, 0], [160, 0], [160, 90], [0, 90]]
    projector: {position: [0, 1.5, 4], look_at: [0, 1.5, 0], throw_ratio: 1.6}
    surface: {point: [0, 0, 0], normal: [0, 0, 1]}
cue_controller: {device: {driver: simulated}, buttons: {go: 1}}
camera:
  device: {driver: simulated}
  size: [128, 72]
  field_of_view: 45
  position: [0.4, 1.7, 4]
  look_at: [0, 1.5, 0]
corrections: {light: {mode: automatic, least: 0.1}}
simulation:
  ambient: [0.7, 0.95, 1.6]
  objects:
    - {name: wall, rectangle: {corner: [-9, -2, 0], right: [18, 0, 0], up: [0, 8, 0]}, reflectance: [0.58, 0.57, 0.54]}
  camera: {white: 600, frame_rate: 15}
)";
constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Test
sources: {white: {solid: [1, 1, 1]}}
looks: {lit: {outputs: {left: [{source: white}]}}}
cues: [{name: Lit, look: lit, fade: 0}]
)";

// Everything in a site's folder, by name. A temporary name holds a process's number.
using Files = std::map<std::string, std::string>;

class KilledCalibration : public testing::Test {
protected:
    KilledCalibration() { folder_.file("show/show.yaml", kShow); }

    void makeSite() const { folder_.file("site/site.yaml", kSmallSite); }
    static Arguments calibration(int seed) { return {"calibrate", ".", "--simulate", "--write", "--seed", std::to_string(seed)}; }
    Outcome run(const Arguments& arguments) const { return runProgram(arguments, site()); }
    fs::path site() const { return folder_ / "site"; }
    std::string text(const std::string& file) const { return contentsOf(site() / file); }
    Files files() const {
        Files files;
        for (const auto& entry : fs::recursive_directory_iterator(site())) {
            std::string name = entry.path().lexically_relative(site());
            if (const auto temporary = name.find_first_of("0123456789", name.find(".yaml")); temporary < name.size())
                name.resize(temporary);
            files[name] = entry.is_directory() ? "" : contentsOf(entry.path());
        }
        return files;
    }
    void keep(const fs::path& name) const { replace(folder_ / name, site()); }
    void restore(const fs::path& name) const { replace(site(), folder_ / name); }

    // Kills the program at each of its calls that change a file, each time from the same start.
    // Calls `then` with each state that is left; with the same state once.
    template <class Then>
    void killEverywhere(const Arguments& arguments, const Then& then) {
        keep("start");
        std::set<Files> seen;
        for (int n = 0;; ++n) {
            restore("start");
            const KilledProgram program(arguments, site(), n);
            if (!program.wasKilled()) {
                EXPECT_EQ(program.status(), 0);
                EXPECT_GT(n, 0);
                break;
            }
            if (!seen.insert(files()).second) continue;
            SCOPED_TRACE(fmt::format("killed before {}: {}", n, program.call()));
            then();
        }
    }

    // Files are read, the show starts, and says whether it uses the survey.
    void expectShowStarts() const {
        EXPECT_THAT(run({"check", "."}), exits(0));
        const Outcome played =
            run({"rehearse", "../show", "--site", ".", "--seconds", "1", "--as-fast-as-possible", "--report", "../r.json"});
        ASSERT_THAT(played, exits(0));
        const auto light = nlohmann::json::parse(contentsOf(folder_ / "r.json"))["light_correction"];
        const auto survey = readSurvey(readSite(site()).value());
        ASSERT_TRUE(survey) << survey.error().message();
        const bool counts = *survey && (*survey)->outputs.contains("left");
        EXPECT_EQ(light["left"]["applied"], counts) << light;
        if (!counts) {
            EXPECT_THAT(played.out + played.errors, testing::HasSubstr("calibrate")) << light;
        }
    }
    // The next calibration, and the way back.
    void expectGoesOn() const {
        const std::string standing = text("site.yaml");
        const bool wasSurveyed = surveyCounts();
        ASSERT_THAT(run(calibration(9)), exits(0));
        EXPECT_TRUE(surveyCounts());
        EXPECT_EQ(text("site.yaml.previous"), standing);
        EXPECT_THAT(run({"check", "."}), exits(0));
        const std::string now = text("site.yaml");
        ASSERT_THAT(run({"calibrate", ".", "--undo"}), exits(0));
        EXPECT_EQ(text("site.yaml"), standing);
        EXPECT_EQ(text("site.yaml.previous"), now);
        EXPECT_EQ(surveyCounts(), wasSurveyed) << "the way back has its survey";
        EXPECT_LE(fs::hard_link_count(site() / "site.yaml"), 1u);
        std::size_t count = 0;
        for ([[maybe_unused]] const auto& entry : fs::directory_iterator(site() / "site.survey")) ++count;
        EXPECT_LE(count, 5u) << "two records at most, and nothing else";
    }
    bool surveyCounts() const {
        const auto survey = readSurvey(readSite(site()).value());
        return survey && *survey && (*survey)->outputs.contains("left");
    }

    const ScratchFolder folder_;

private:
    static void replace(const fs::path& to, const fs::path& from) {
        fs::remove_all(to);
        fs::copy(from, to, fs::copy_options::recursive);
    }
};

TEST_F(KilledCalibration, the_first_one_leaves_the_site_old_or_new) {
    makeSite();
    keep("before");
    ASSERT_THAT(run(calibration(1)), exits(0));
    const std::string after = text("site.yaml");
    restore("before");
    killEverywhere(calibration(1), [&] {
        EXPECT_THAT(text("site.yaml"), AnyOf(std::string(kSmallSite), after));
        expectShowStarts();
        expectGoesOn();
    });
}

TEST_F(KilledCalibration, leaves_the_site_old_or_new) {
    makeSite();
    for (const int seed : {1, 2}) ASSERT_THAT(run(calibration(seed)), exits(0));
    const std::string before = text("site.yaml");
    keep("before");
    ASSERT_THAT(run(calibration(3)), exits(0));
    const std::string after = text("site.yaml");
    ASSERT_NE(after, before);
    restore("before");
    killEverywhere(calibration(3), [&] {
        EXPECT_THAT(text("site.yaml"), AnyOf(before, after));
        EXPECT_TRUE(surveyCounts()) << "whichever of site and survey was written";
        expectShowStarts();
        expectGoesOn();
    });
}

// Measuring changes nothing.
TEST_F(KilledCalibration, while_it_measures_leaves_everything_as_it_was) {
    makeSite();
    for (const int seed : {1, 2}) ASSERT_THAT(run(calibration(seed)), exits(0));
    const std::string before = text("site.yaml");
    ASSERT_THAT(run(calibration(3)), exits(0));
    const std::string after = text("site.yaml");
    ASSERT_THAT(run({"calibrate", ".", "--undo"}), exits(0));
    keep("start");
    const Files start = files();
    Rng random(1);
    SteadyClock clock;
    for (int i = 0; i < 5; ++i) {
        restore("start");
        RunningProgram program(calibration(3), site());
        clock.sleepUntil(clock.now() + fromSeconds(random.uniform(0, 0.4)));
        EXPECT_THAT(program.stop(SIGKILL), AnyOf(0, 128 + SIGKILL));
        EXPECT_THAT(text("site.yaml"), AnyOf(before, after));
        if (text("site.yaml") == before && text("site.yaml.previous") == after) {
            EXPECT_EQ(files(), start);
        }
    }
    restore("start");
    expectShowStarts();
    expectGoesOn();
}

// Of the two site files none is ever lost.
TEST_F(KilledCalibration, a_way_back_is_gone_whole_or_not_at_all) {
    makeSite();
    for (const int seed : {1, 2}) ASSERT_THAT(run(calibration(seed)), exits(0));
    const std::string now = text("site.yaml"), before = text("site.yaml.previous");
    ASSERT_NE(now, before);
    killEverywhere({"calibrate", ".", "--undo"}, [&] {
        EXPECT_THAT(text("site.yaml") + text("site.yaml.previous"), AnyOf(now + before, before + now));
        EXPECT_TRUE(surveyCounts());
        expectShowStarts();
        expectGoesOn();
    });
}

}  // namespace
}  // namespace fantascope::app
