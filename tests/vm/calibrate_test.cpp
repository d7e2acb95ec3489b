// Calibrations by cameras of the kernel's own, as a person does them. vivid shows pictures of its
// own, so it must be refused for the right reason. Through v4l2loopback, ffmpeg plays a camera: it
// looks at the X screen on which the output shows its picture, at a slant, a little late and with
// noise. tests/vm/calibrate.sh brings all this up, on a machine of its own; elsewhere every test
// here is skipped.

#include "app/site/site_file.h"

#include "core/clock.h"
#include "core/geometry.h"
#include "program.h"
#include "running_program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

// {0}: the display; {1}: the camera's name; {2}: the size of its pictures as the driver is asked
// for them; {3}: as the site believes it is.
constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {{driver: {0}}}
    size: [160, 90]
    refresh_rate: 5
    corners: [[0, 0], [160, 0], [160, 90], [0, 90]]
camera:
  device: {{driver: v4l2, card: {1}, size: {2}, rate: 15, exposure: 100, gain: 60}}
  size: {3}
  field_of_view: 60
  position: [0, 1.5, 4]
  look_at: [0, 1.5, 0]
)";
constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Test
sources: {white: {solid: [1, 1, 1]}}
looks: {lit: {outputs: {left: [{source: white}]}}}
cues: [{name: Lit, look: lit, fade: 0}]
)";
const fs::path kVivid = "/dev/video0", kLoopback = "/dev/video7";

bool succeeds(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

class CalibrationInTheKernel : public testing::Test {
protected:
    void SetUp() override {
        ASSERT_TRUE(fs::exists(kVivid) && fs::exists(kLoopback)) << "tests/vm/calibrate.sh loads their drivers";
    }
    std::string makeSite(const std::string& display, const std::string& card, const std::string& size,
                         const std::string& declared) {
        const std::string text = fmt::format(kSite, display, card, size, declared);
        folder_.file("site.yaml", text);
        return text;
    }
    std::string makeVividSite(const std::string& declared = "[320, 180]") {
        return makeSite("headless", "vivid", "[320, 180]", declared);
    }
    Outcome run(const std::vector<std::string>& arguments) const { return runProgram(arguments, folder_.path()); }
    std::string text(const fs::path& file) const { return contentsOf(folder_ / file); }
    // Whether something becomes so; a machine in software takes its time.
    template <class Condition>
    static bool becomes(Condition condition) {
        SteadyClock clock;
        while (!condition()) {
            if (clock.now() > std::chrono::seconds(60)) return false;
            clock.sleepUntil(clock.now() + std::chrono::milliseconds(50));
        }
        return true;
    }
    const ScratchFolder folder_;
};

class Vivid : public CalibrationInTheKernel {
protected:
    void SetUp() override {
        CalibrationInTheKernel::SetUp();
        control("test_pattern=1,osd_text_mode=0");  // colour bars, and numbers that count the frames
    }
    static void control(const std::string& what) {
        EXPECT_TRUE(succeeds(fmt::format("v4l2-ctl -d {} -c {}", kVivid.string(), what))) << what;
    }
};

TEST_F(Vivid, is_seen_not_to_see_the_outputs) {
    const std::string before = makeVividSite();
    const Outcome outcome = run({"calibrate", ".", "--write"});
    EXPECT_THAT(outcome, exits(1));
    EXPECT_THAT(outcome.errors, AllOf(HasSubstr("'vivid': YUYV 320 x 180 at 15 Hz; exposure cannot be set"),
                                      HasSubstr("error: the camera sees no light of the outputs")));
    EXPECT_TRUE(succeeds("v4l2-ctl -d /dev/video0 -C gain_automatic,gain | tr '\\n' ' ' | grep 'gain_automatic: 0 gain: 60'"))
        << "what can be locked is";
    EXPECT_EQ(text("site.yaml"), before);
    EXPECT_THAT(folder_.names(), testing::ElementsAre("site.yaml"));
}

TEST_F(Vivid, of_another_size_is_told) {
    const std::string before = makeVividSite("[640, 360]");
    for (const char* command : {"calibrate", "lens"}) {
        const Outcome outcome = run({command, ".", "--write"});
        EXPECT_THAT(outcome, exits(1));
        EXPECT_THAT(outcome.errors,
                    HasSubstr("the camera's pictures have 320 x 180 pixels, the site file says 640 x 360; correct camera: size"));
    }
    EXPECT_EQ(text("site.yaml"), before);
    EXPECT_THAT(folder_.names(), testing::ElementsAre("site.yaml"));
}

TEST_F(Vivid, shows_no_board) {
    const std::string before = makeVividSite();
    RunningProgram lens({"lens", ".", "--write"}, folder_.path());
    while (const auto line = lens.line())
        if (line->find("show the board to the camera") != std::string::npos) break;
    EXPECT_EQ(lens.stop(SIGINT), 1);
    EXPECT_THAT(lens.all(), HasSubstr("no board was found; print one with 'fantascope lens --board'"));
    EXPECT_EQ(text("site.yaml"), before);
    EXPECT_THAT(folder_.names(), testing::ElementsAre("site.yaml"));
}

// What ffmpeg makes of the screen, as a camera would, and the same in our words: a border, corners
// that move by some pixels, and another size.
class ScreenCamera : public CalibrationInTheKernel {
protected:
    static constexpr glm::ivec2 kPadded{200, 120}, kBorder{20, 15}, kSize{192, 108};
    static constexpr std::array<glm::dvec2, 4> kSource = {{{4, 3}, {196, 0}, {199, 116}, {0, 120}}};

    void SetUp() override {
        CalibrationInTheKernel::SetUp();
        if (IsSkipped()) return;
        play();
        site_ = makeSite("glfw", "Loopback", "[192, 108]", "[192, 108]");
        folder_.file("show/show.yaml", kShow);
    }
    void TearDown() override { stop(); }

    // Plays the screen, and keeps what is played if there is a file to record it to.
    void play(const fs::path& recording = {}) {
        const std::string filter = fmt::format(
            "pad={}:{}:{}:{}:color=0x202020,perspective=x0={}:y0={}:x1={}:y1={}:x2={}:y2={}:x3={}:y3={}:interpolation=linear,"
            "scale={}:{},noise=alls=4:allf=t,format=yuyv422",
            kPadded.x, kPadded.y, kBorder.x, kBorder.y, kSource[0].x, kSource[0].y, kSource[1].x, kSource[1].y, kSource[3].x,
            kSource[3].y, kSource[2].x, kSource[2].y, kSize.x, kSize.y);
        std::vector<std::string> arguments{"-f",          "x11grab", "-framerate", "10",
                                           "-video_size", "160x90",  "-i",         std::getenv("DISPLAY")};
        const auto add = [&](std::vector<std::string> more) { arguments.insert(arguments.end(), more.begin(), more.end()); };
        if (recording.empty())
            add({"-vf", filter});
        else
            add({"-filter_complex", "[0:v]" + filter + ",split[kept][played]", "-map", "[kept]", "-f", "rawvideo", recording,
                 "-map", "[played]"});
        add({"-f", "v4l2", kLoopback});
        startPlayer(arguments);
    }
    // Plays the part of a recording in which all was lit, again and again.
    void playAgain(const fs::path& recording) {
        const std::string all = contentsOf(recording);
        const std::size_t picture = 2ul * kSize.x * kSize.y, pictures = all.size() / picture;
        ASSERT_GT(pictures, 50u);
        const fs::path part = folder_.file("part.yuv", all.substr(pictures / 2 * picture, pictures / 4 * picture));
        startPlayer({"-re", "-stream_loop", "-1", "-f", "rawvideo", "-pixel_format", "yuyv422", "-video_size",
                     fmt::format("{}x{}", kSize.x, kSize.y), "-framerate", "10", "-i", part, "-f", "v4l2", kLoopback});
    }
    void startPlayer(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"ffmpeg", "-nostdin", "-loglevel", "error"});
        std::vector<char*> raw;
        for (std::string& argument : arguments) raw.push_back(argument.data());
        raw.push_back(nullptr);
        player_ = ::fork();
        if (player_ == 0) {
            ::execvp("ffmpeg", raw.data());
            ::_exit(127);
        }
        ASSERT_TRUE(becomes([] { return succeeds("v4l2-ctl -d /dev/video7 --list-formats | grep YUYV"); }));
    }
    void stop() {
        if (player_ <= 0) return;
        ::kill(std::exchange(player_, -1), SIGKILL);
        ::wait(nullptr);
    }
    // Where the output's light comes from that a place of the camera's picture sees. ffmpeg counts
    // from the pixels' centres.
    static glm::dvec2 projectorAt(glm::dvec2 camera) {
        const auto slant = Homography::fromCorners(rectangleCorners(kPadded.x, kPadded.y), kSource).value();
        return slant(camera * glm::dvec2(kPadded) / glm::dvec2(kSize) - 0.5) + 0.5 - glm::dvec2(kBorder);
    }

    // The show runs, and the watch sees that nothing has moved.
    void expectQuietNight() {
        // The emulated machine may take half of that to load what the first look needs.
        ASSERT_THAT(run({"run", "show", "--site", ".", "--from", "Lit", "--seconds", "35", "--report", "r.json"}), exits(0));
        const json report = json::parse(text("r.json"));
        EXPECT_EQ(report["causes"], json::array()) << "nothing has moved";
        EXPECT_EQ(report["faults"], json::array());
        const json& watched = report["watch"]["left"];
        ASSERT_GE(watched.size(), 3u) << report;
        for (const json& entry : watched)
            EXPECT_LT(entry["drift_px"].get<double>(), 6 * entry["sigma_px"].get<double>()) << entry;
    }

    pid_t player_ = -1;
    std::string site_;
};

TEST_F(ScreenCamera, is_calibrated_and_watches_the_show) {
    const std::array<glm::dvec2, 4> wanted = {{{40, 28}, {150, 28}, {150, 84}, {40, 84}}};
    folder_.file("wanted.yaml",
                 "fantascope: wanted\nversion: 1\noutputs: {left: {camera: [[40, 28], [150, 28], [150, 84], [40, 84]]}}\n");
    const Outcome outcome = run({"calibrate", ".", "--wanted", "wanted.yaml", "--write", "--report", "c.json"});
    ASSERT_THAT(outcome, exits(0));
    const show::Site site = readSite(folder_ / "site.yaml").value();
    const auto& corners = site.outputs[0].projection.warp.shape().corners;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec2 truth = projectorAt(wanted[i]);
        EXPECT_LT(glm::distance(corners[i], truth), 0.7)
            << fmt::format("{}: {}, {} and not {}, {}", i, corners[i].x, corners[i].y, truth.x, truth.y);
    }
    json calibration = json::parse(text("c.json"));
    EXPECT_GT(calibration["latency_ms"], 0);
    EXPECT_NEAR(calibration["outputs"]["left"]["gamma"].get<double>(), 2.25, 0.3) << "the screen's values are taken for sRGB";
    EXPECT_LT(calibration["outputs"]["left"]["rms_px"], 0.3);

    stop();
    const fs::path recording = folder_ / "night.yuv";
    play(recording);
    expectQuietNight();
    // The same night from a recording; but that does not answer test pictures.
    stop();
    playAgain(recording);
    expectQuietNight();
    const std::string calibrated = text("site.yaml");
    const Outcome refused = run({"calibrate", ".", "--write"});
    EXPECT_THAT(refused, exits(1));
    EXPECT_THAT(refused.errors, HasSubstr("error: the camera sees no light of the outputs"));
    EXPECT_EQ(text("site.yaml"), calibrated);
}

TEST_F(ScreenCamera, that_dies_while_it_measures_is_told) {
    RunningProgram calibration({"calibrate", ".", "--write", "--report", "c.json"}, folder_.path());
    while (const auto line = calibration.line())
        if (line->find("looking for its light") != std::string::npos) break;
    stop();
    while (calibration.line()) continue;
    EXPECT_EQ(calibration.stop(), 1);
    EXPECT_THAT(calibration.all(), HasSubstr("not calibrated: left"));
    EXPECT_THAT(json::parse(text("c.json"))["outputs"]["left"]["trouble"].get<std::string>(), HasSubstr("the camera stopped: "));
    EXPECT_EQ(text("site.yaml"), site_);
    EXPECT_FALSE(fs::exists(folder_ / "site.survey"));
}

// Early on, mostly while the delay is measured: its driver is not yet sure that it is lost.
TEST_F(ScreenCamera, that_falls_silent_is_not_called_slow) {
    RunningProgram calibration({"calibrate", ".", "--write"}, folder_.path());
    while (const auto line = calibration.line())
        if (line->find("waiting for the camera") != std::string::npos) break;
    SteadyClock clock;
    clock.sleepUntil(clock.now() + std::chrono::seconds(4));
    stop();
    while (calibration.line()) continue;
    EXPECT_EQ(calibration.stop(), 1);
    EXPECT_THAT(calibration.all(), AnyOf(HasSubstr("error: the camera stopped: "), HasSubstr("error: the camera gave "),
                                         HasSubstr("error: not calibrated: left")));
    EXPECT_EQ(text("site.yaml"), site_);
}

}  // namespace
}  // namespace fantascope::app
