// Whole rehearsals of the default show with the built program, as a newcomer would run them; most
// of them on the stepped clock.

#include "media/image.h"
#include "program.h"
#include "source_folder.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

const fs::path kSource = sourceFolder();
const std::vector<std::string> kCues = {"Dusk", "First light", "Left rises", "Both", "Full", "Farewell"};

void replace(std::string& text, const std::string& before, const std::string& after) {
    const auto at = text.find(before);
    ASSERT_NE(at, std::string::npos) << before;
    text.replace(at, before.size(), after);
}

// The default site with further lines in its simulation section.
fs::path siteWith(const ScratchFolder& folder, const std::string& lines) {
    fs::copy(kSource / "config/simulated", folder / "site", fs::copy_options::recursive);
    std::ofstream(folder / "site/site.yaml", std::ios::app) << lines;
    return folder / "site";
}

Outcome rehearse(const fs::path& folder, std::vector<std::string> more,
                 const std::vector<std::pair<std::string, std::string>>& environment = {}) {
    std::vector<std::string> arguments = {"rehearse",   "--as-fast-as-possible", "--record", "rehearsal", "--report",
                                          "report.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runProgram(arguments, folder, environment);
}

// Every part on a thread of its own, for the thread sanitizer's eyes above all. How punctual they
// are, and how much a camera sees beside them on a machine without time to spare, is for
// bench/rehearsal to say.
TEST(Rehearsal, in_real_time_reaches_every_cue) {
    const ScratchFolder folder;
    const Outcome outcome =
        runProgram({"rehearse", "--seconds", "6", "--record", "rehearsal", "--report", "report.json"}, folder.path());
    ASSERT_THAT(outcome, exits(0));
    const json report = json::parse(contentsOf(folder / "report.json"));
    EXPECT_EQ(report["cues"].size(), kCues.size());
    EXPECT_EQ(report["stop_reason"], "length");
    // A refresh shows a frame of ours or was missed by us: one count must not hide what the other
    // leaves out.
    for (const char* output : {"left", "right"}) {
        const int frames = report["frames_by_output"][output], late = report["late_frames_by_output"][output];
        EXPECT_LE(frames, 6 * 30);
        EXPECT_GE(frames + late, 6 * 30 - 1);
    }
    EXPECT_GT(report["yardstick"]["ticks"], 0);
    EXPECT_GT(report["dmx_interval_ms"]["count"], 0);
}

// With every part on its thread, and a terminal that has the key.
TEST(Rehearsal, the_key_s_takes_a_picture_of_every_output_while_the_show_runs) {
    const ScratchFolder folder;
    EXPECT_EQ(typeAtProgram({"rehearse", "--by-hand", "--from", "Full", "--pictures", "shots"}, folder.path(),
                            {{"frames/s", 4, 's'}, {"picture: ", 2, 'q'}}),
              0);
    std::vector<std::string> outputs;
    for (const auto& entry : fs::directory_iterator(folder / "shots")) {
        const std::string name = entry.path().filename();
        outputs.push_back(name.substr(name.rfind('-')));
        EXPECT_THAT(name, HasSubstr("s-5-Full-"));
        const auto picture = readRgba(entry.path());
        ASSERT_TRUE(picture) << picture.error().message();
        const auto isLit = [](const Rgba8& pixel) { return pixel.r + pixel.g + pixel.b > 0; };
        EXPECT_TRUE(std::ranges::any_of(picture->pixels(), isLit)) << name;
    }
    EXPECT_THAT(outputs, testing::UnorderedElementsAre("-left.png", "-right.png"));
}

// Draws the report and a camera picture of a rehearsal. In cue 5, Full, the left output shows its
// pattern alone.
void expectFigures(const ScratchFolder& folder) {
    EXPECT_THAT(runProgram({"plot", "report.json", "-o", "night.png"}, folder.path()), exits(0));
    EXPECT_GT(readRgba(folder / "night.png").value().height(), 600) << "z, tone and drift";
    std::vector<std::string> wall = {"plot", "rehearsal/camera-5.png", "--site", (kSource / "config/simulated").string()};
    wall.insert(wall.end(), {"--guide", (kSource / "shows/light-movement/left.pattern.yaml").string(), "-o", "wall.png"});
    wall.insert(wall.end(), {"--output", "left"});
    EXPECT_THAT(runProgram(wall, folder.path()), exits(0));
    const int one = readRgba(folder / "wall.png").value().height();
    wall.insert(wall.end(), {"--before", "rehearsal/camera-4.png"});
    EXPECT_THAT(runProgram(wall, folder.path()), exits(0));
    EXPECT_GT(readRgba(folder / "wall.png").value().height(), one + 200);
}

TEST(Rehearsal, reaches_every_cue_and_leaves_everything_to_look_at) {
    const ScratchFolder folder;
    const Outcome outcome = rehearse(folder.path(), {"--seconds", "30"});
    ASSERT_THAT(outcome, exits(0));
    const json report = json::parse(contentsOf(folder / "report.json"));
    std::vector<std::string> entered;
    for (const json& cue : report["cues"]) entered.push_back(cue["name"]);
    EXPECT_EQ(entered, kCues);
    EXPECT_EQ(report["frames"], 2 * 30 * 30);
    const std::string recorded = contentsOf(folder / "rehearsal/frames.csv");
    EXPECT_EQ(std::count(recorded.begin(), recorded.end(), '\n'), 1 + 2 * 30 * 30) << "every frame shown, the last one too";
    EXPECT_EQ(report["late_frames"], 0);
    EXPECT_EQ(report["input_to_frame_ms"]["count"], 6);
    EXPECT_EQ(report["stop_reason"], "length");
    for (const char* file : {"left.mp4", "right.mp4", "contact-sheet.png", "dmx.csv", "relays.csv", "frames.csv"})
        EXPECT_GT(fs::file_size(folder / "rehearsal" / file), 0u) << file;
    // The road lamps are on before and after the show and off during it; the sculpture's lamp
    // follows the looks.
    const std::string relays = contentsOf(folder / "rehearsal/relays.csv");
    EXPECT_THAT(relays, testing::MatchesRegex("show_time_s,bank,states\n[0-9.]+,road,11\n[0-9.]+,road,00\n[0-9.]+,road,11\n"));
    EXPECT_THAT(contentsOf(folder / "rehearsal/dmx.csv"), HasSubstr(",1,255\n"));
    expectFigures(folder);
}

// The operator's word is only worth something if a rehearsal can be repeated. Example failure: a
// part that reads the real clock, a result that depends on which thread came first.
TEST(Rehearsal, is_the_same_byte_for_byte_in_another_folder_and_with_other_threads) {
    const ScratchFolder one, other;
    ASSERT_THAT(rehearse(one.path(), {"--seconds", "6"}, {{"LP_NUM_THREADS", "0"}}), exits(0));
    ASSERT_THAT(rehearse(other.path(), {"--seconds", "6"}, {{"LP_NUM_THREADS", "2"}}), exits(0));
    for (const char* file : {"frames.csv", "dmx.csv", "relays.csv", "left.mp4", "right.mp4", "contact-sheet.png"})
        EXPECT_EQ(contentsOf(one / "rehearsal" / file), contentsOf(other / "rehearsal" / file)) << file;
    json reportOne = json::parse(contentsOf(one / "report.json")), reportOther = json::parse(contentsOf(other / "report.json"));
    EXPECT_EQ(reportOne["z_camera"], reportOther["z_camera"]);
}

TEST(Rehearsal, another_seed_gives_other_camera_noise_and_the_same_show) {
    const ScratchFolder one, other;
    ASSERT_THAT(rehearse(one.path(), {"--seconds", "3", "--by-hand", "--from", "Full", "--seed", "1"}), exits(0));
    ASSERT_THAT(rehearse(other.path(), {"--seconds", "3", "--by-hand", "--from", "Full", "--seed", "2"}), exits(0));
    EXPECT_EQ(contentsOf(one / "rehearsal/frames.csv"), contentsOf(other / "rehearsal/frames.csv"));
    EXPECT_NE(contentsOf(one / "rehearsal/contact-sheet.png"), contentsOf(other / "rehearsal/contact-sheet.png"));
}

double meanScore(const json& series, double from, double to) {
    double sum = 0;
    int count = 0;
    for (const json& entry : series) {
        if (entry[0] < from || entry[0] >= to) continue;
        sum += entry[1].get<double>();
        ++count;
    }
    EXPECT_GT(count, 0) << "no score between " << from << " and " << to << " s";
    return sum / count;
}

// The camera's score tells a technician which projector was knocked, and that it stands right
// again. It knows the nominal site alone. Example failure: the comparison reads the simulated
// truth, so that a bump moves both sides.
TEST(Rehearsal, the_cameras_score_rises_while_a_projector_is_bumped_and_only_for_its_output) {
    const ScratchFolder folder;
    const fs::path site = siteWith(
        folder, "  faults:\n    - {at: 6, until: 12, kind: bump, output: left, move: [0.05, 0, 0], turn: [0, 1.5, 0.5]}\n");
    const Outcome outcome = rehearse(folder.path(), {"--seconds", "18", "--by-hand", "--from", "Full", "--site", site.string()});
    ASSERT_THAT(outcome, exits(0));
    const json report = json::parse(contentsOf(folder / "report.json"));
    EXPECT_EQ(report["faults"].size(), 2u) << report["faults"];
    const json &left = report["z_camera"]["left"], &right = report["z_camera"]["right"];
    // The first seconds belong to the fade.
    const double before = meanScore(left, 4.5, 6), bumped = meanScore(left, 6.5, 12), after = meanScore(left, 12.5, 18);
    EXPECT_GT(bumped, 1.25 * before) << before << " " << bumped << " " << after;
    EXPECT_NEAR(after, before, 0.3 * (bumped - before)) << before << " " << bumped << " " << after;
    const double still = meanScore(right, 4.5, 6), alsoStill = meanScore(right, 6.5, 12);
    EXPECT_NEAR(alsoStill, still, 0.2 * (bumped - before)) << still << " " << alsoStill;
}

// The default site whose geometry is corrected as `mode` says, with further lines in its simulation
// section.
fs::path correctedSite(const ScratchFolder& folder, const std::string& mode, const std::string& lines) {
    const fs::path site = siteWith(folder, lines);
    std::string text = contentsOf(site / "site.yaml");
    replace(text, "\nsimulation:", "\ncorrections: {geometry: {mode: " + mode + "}}\n\nsimulation:");
    std::ofstream(site / "site.yaml") << text;
    return site;
}

json watchedRehearsal(const ScratchFolder& folder, const fs::path& site, const std::string& seconds) {
    const Outcome outcome = runProgram({"rehearse", "--as-fast-as-possible", "--report", "report.json", "--seconds", seconds,
                                        "--by-hand", "--from", "Full", "--site", site.string()},
                                       folder.path());
    EXPECT_THAT(outcome, exits(0));
    return json::parse(contentsOf(folder / "report.json"));
}

// Example failures: the picture of the output that was not pushed moves, too; the picture jumps;
// the correction is added to what was corrected already.
TEST(Rehearsal, the_picture_of_a_pushed_projector_is_moved_back_while_the_show_runs) {
    const ScratchFolder folder;
    const fs::path site =
        correctedSite(folder, "automatic", "  faults:\n    - {at: 7, kind: bump, output: left, turn: [0.2, 0.5, 0.3]}\n");
    const json report = watchedRehearsal(folder, site, "15");
    const json &left = report["watch"]["left"], &right = report["watch"]["right"];
    ASSERT_FALSE(left.empty() || right.empty()) << report["watch"];
    const double drift = left.back()["drift_px"], moved = left.back()["moved_px"];
    EXPECT_GT(drift, 5);
    EXPECT_NEAR(moved, drift, 1);
    for (const json& seen : right) EXPECT_EQ(seen["moved_px"], 0.0) << seen;
    for (const json& seen : left)
        if (seen["at"] < 7) {
            EXPECT_EQ(seen["moved_px"], 0.0) << seen;
        }
    ASSERT_EQ(report["causes"].size(), 1u) << report["causes"];
    EXPECT_EQ(report["causes"][0]["cause"], "out of place");
    EXPECT_EQ(report["causes"][0]["output"], "left");
    EXPECT_LT(report["causes"][0]["to"], 15);
}

TEST(Rehearsal, advice_moves_nothing_and_neither_does_a_pushed_camera) {
    for (const auto& [mode, fault, cause] :
         {std::tuple("advise", "kind: bump, output: left, turn: [0.2, 0.5, 0.3]", "out of place"),
          std::tuple("automatic", "kind: camera_bump, turn: [0.3, 0.8, 0.2]", "camera moved")}) {
        const ScratchFolder folder;
        const json report =
            watchedRehearsal(folder, correctedSite(folder, mode, std::string("  faults:\n    - {at: 6, ") + fault + "}\n"), "10");
        for (const json& output : report["watch"])
            for (const json& seen : output) EXPECT_EQ(seen["moved_px"], 0.0) << seen;
        ASSERT_EQ(report["causes"].size(), 1u) << report["causes"];
        EXPECT_EQ(report["causes"][0]["cause"], cause);
    }
}

TEST(Rehearsal, an_unplugged_projector_goes_dark_and_comes_back_while_the_other_plays_on) {
    const ScratchFolder folder;
    const fs::path site = siteWith(folder, "  faults:\n    - {at: 2, until: 4, kind: unplug, device: left}\n");
    const Outcome outcome = rehearse(folder.path(), {"--seconds", "6", "--by-hand", "--from", "Full", "--site", site.string()});
    ASSERT_THAT(outcome, exits(0));
    const json report = json::parse(contentsOf(folder / "report.json"));
    EXPECT_EQ(report["frames_by_output"]["right"], 180);
    EXPECT_NEAR(report["frames_by_output"]["left"].get<double>(), 120, 2);
    EXPECT_EQ(report["late_frames"], 0);
    // The operator is told, in the dark.
    EXPECT_THAT(outcome.errors, HasSubstr("left (headless) is missing: "));
    EXPECT_THAT(outcome.errors, HasSubstr("left (headless) is back"));
}

// Adds a third output to the default site's two.
void addOutput(const fs::path& site) {
    std::string text = contentsOf(site / "site.yaml");
    replace(text, "\nuniverses:",
            "  - name: middle\n"
            "    display: {driver: headless}\n"
            "    size: [640, 360]\n"
            "    refresh_rate: 30\n"
            "    projector: {position: [0, 3.6, 11], look_at: [0, 2.3, 0], throw_ratio: 1.7, lens_shift: [0, 0]}\n"
            "    surface: {point: [0, 0, 0], normal: [0, 0, 1]}\n\n"
            "universes:");
    std::ofstream(site / "site.yaml") << text;
}

TEST(Rehearsal, an_output_whose_graphics_never_work_costs_the_others_no_frame_and_the_report_says_it) {
    const ScratchFolder folder;
    const fs::path site = siteWith(folder, "  faults:\n    - {at: 0, kind: graphics, device: middle}\n");
    addOutput(site);
    const Outcome outcome = rehearse(folder.path(), {"--seconds", "8", "--by-hand", "--from", "Full", "--site", site.string()});
    ASSERT_THAT(outcome, exits(0));
    const json report = json::parse(contentsOf(folder / "report.json"));
    EXPECT_EQ(report["frames_by_output"], json({{"left", 240}, {"middle", 0}, {"right", 240}}));
    EXPECT_EQ(report["late_frames"], 0);
    const auto fault = std::find_if(report["faults"].begin(), report["faults"].end(),
                                    [](const json& each) { return each.value("device", "") == "middle"; });
    ASSERT_NE(fault, report["faults"].end()) << report["faults"];
    EXPECT_THAT((*fault)["what"].get<std::string>(), HasSubstr("its picture cannot be drawn: middle: its OpenGL fails"));
    EXPECT_FALSE(fault->contains("until")) << *fault;
    EXPECT_THAT(outcome.errors, HasSubstr("middle (headless) is missing: its picture cannot be drawn"));
}

TEST(Rehearsal, an_output_whose_graphics_work_again_is_drawn_again) {
    const ScratchFolder folder;
    const fs::path site = siteWith(folder, "  faults:\n    - {at: 2, until: 2.5, kind: graphics, device: left}\n");
    ASSERT_THAT(rehearse(folder.path(), {"--seconds", "6", "--by-hand", "--from", "Full", "--site", site.string()}), exits(0));
    const json report = json::parse(contentsOf(folder / "report.json"));
    EXPECT_EQ(report["frames_by_output"]["right"], 180);
    EXPECT_NEAR(report["frames_by_output"]["left"].get<double>(), 150, 2) << "it is tried again after a second";
    EXPECT_EQ(report["late_frames"], 0);
}

TEST(Rehearsal, an_outage_stands_in_the_report_with_its_length) {
    const ScratchFolder folder;
    const fs::path site = siteWith(folder, "  faults:\n    - {at: 1, until: 2, kind: unplug, device: road}\n");
    ASSERT_THAT(rehearse(folder.path(), {"--seconds", "3", "--by-hand", "--from", "Full", "--site", site.string()}), exits(0));
    const json report = json::parse(contentsOf(folder / "report.json"));
    std::vector<json> noticed;
    for (const json& fault : report["faults"])
        if (fault.contains("device")) noticed.push_back(fault);
    ASSERT_EQ(noticed.size(), 1u) << report["faults"];
    EXPECT_EQ(noticed[0]["device"], "road");
    EXPECT_THAT(noticed[0]["what"].get<std::string>(), HasSubstr("road (simulated) is missing: "));
    EXPECT_NEAR(noticed[0]["at"].get<double>(), 1, 0.15);
    EXPECT_NEAR(noticed[0]["until"].get<double>(), 2, 0.15);
}

// The show ends in the middle of a cue: its pictures end, its lamps and relays go on to where they
// stay.
// Example failure: the lamps keep their last level all night.
TEST(Rehearsal, ends_with_its_lamps_at_the_end_levels_and_its_relays_safe) {
    const ScratchFolder folder;
    const fs::path site = siteWith(folder, "end_fade: 0.5\n");
    std::string text = contentsOf(site / "site.yaml");
    replace(text, "channels: [intensity]}", "channels: [intensity], end: 0.2}");
    std::ofstream(site / "site.yaml") << text;
    ASSERT_THAT(rehearse(folder.path(), {"--seconds", "2", "--by-hand", "--from", "Full", "--site", site.string()}), exits(0));
    EXPECT_EQ(json::parse(contentsOf(folder / "report.json"))["seconds"], 2.0);
    const std::string dmx = contentsOf(folder / "rehearsal/dmx.csv"), relays = contentsOf(folder / "rehearsal/relays.csv");
    EXPECT_TRUE(dmx.ends_with("\n2.500000,1,51\n")) << dmx.substr(dmx.size() - 60);
    EXPECT_THAT(relays, testing::MatchesRegex("show_time_s,bank,states\n0.000000,road,00\n2.0[0-9]+,road,11\n"));
    const std::string recorded = contentsOf(folder / "rehearsal/frames.csv");
    EXPECT_EQ(std::count(recorded.begin(), recorded.end(), '\n'), 1 + 2 * 2 * 30);
}

// A machine that boots plays. Example failures: the show waits in the dark for GO; it ends after
// one pass; the rehearsal presses GO in between.
TEST(Rehearsal, of_a_show_that_plays_by_itself_presses_nothing) {
    const ScratchFolder folder;
    fs::copy(kSource / "shows/light-movement", folder / "show", fs::copy_options::recursive);
    std::string show = contentsOf(folder / "show/show.yaml");
    replace(show, "version: 1", "version: 2\nstart: Left rises\nat_end: loop");
    for (const std::string& cue : kCues) replace(show, "name: " + cue + ",", "name: " + cue + ", block: true, follow: 0.5,");
    std::ofstream(folder / "show/show.yaml") << show;
    ASSERT_THAT(runProgram({"check", "show"}, folder.path()).out,
                HasSubstr("starts with 'Left rises' and plays by itself for ever"));
    ASSERT_THAT(
        runProgram({"rehearse", "show", "--as-fast-as-possible", "--seconds", "4.2", "--report", "report.json"}, folder.path()),
        exits(0));
    std::vector<std::string> entered;
    std::vector<double> times;
    const json report = json::parse(contentsOf(folder / "report.json"));
    for (const json& cue : report["cues"]) {
        entered.push_back(cue["name"]);
        times.push_back(cue["entered"]);
    }
    EXPECT_THAT(entered, testing::ElementsAre("Left rises", "Both", "Full", "Farewell", "Dusk", "First light", "Left rises",
                                              "Both", "Full"));
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], 0.5 * static_cast<double>(i), 0.02) << i;
}

// Each mistake ends with one message that says where and what to do, exit status 1, and nothing
// half written.
TEST(Rehearsal, bad_input_is_refused_before_anything_is_shown) {
    const ScratchFolder folder;
    const auto refused = [&](std::vector<std::string> arguments) {
        const Outcome outcome = rehearse(folder.path(), std::move(arguments));
        EXPECT_THAT(outcome, exits(1));
        EXPECT_FALSE(fs::exists(folder / "rehearsal"));
        EXPECT_FALSE(fs::exists(folder / "report.json"));
        return outcome.errors;
    };
    EXPECT_THAT(refused({"nowhere", "--seconds", "1"}), HasSubstr("nowhere"));
    EXPECT_THAT(refused({"--seconds", "1", "--from", "Ful"}), HasSubstr("Full"));
    EXPECT_THAT(refused({"--seconds", "1", "--site", "nowhere"}), HasSubstr("nowhere"));
    const fs::path typo = siteWith(folder, "  fautls: []\n");
    EXPECT_THAT(refused({"--seconds", "1", "--site", typo.string()}), HasSubstr("fautls: unknown key (did you mean 'faults'?)"));

    fs::copy(kSource / "shows/light-movement", folder / "show", fs::copy_options::recursive);
    std::string show = contentsOf(folder / "show/show.yaml");
    replace(show, "      right: [{source: moonlight}]", "      rihgt: [{source: moonlight}]");
    std::ofstream(folder / "show/show.yaml") << show;
    EXPECT_THAT(refused({"show", "--seconds", "1"}),
                testing::AllOf(HasSubstr("show.yaml:"), HasSubstr("rihgt"), HasSubstr("right")));
}

TEST(Rehearsal, wrong_usage_has_its_own_exit_status) {
    const ScratchFolder folder;
    EXPECT_THAT(runProgram({"rehearse", "--secnds", "5"}, folder.path()), exits(2));
    EXPECT_THAT(runProgram({"rehears"}, folder.path()), exits(2));
    EXPECT_THAT(runProgram({}, folder.path()), exits(2));
    EXPECT_THAT(runProgram({"rehearse", "--help"}, folder.path()), exits(0));
}

}  // namespace
}  // namespace fantascope
