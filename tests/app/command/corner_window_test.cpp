// A person at the window in which a canvas's place is chosen, on a screen in memory.

#include "app/calibrate/corner_picture.h"

#include "contract/eventually.h"
#include "contract/x_server.h"
#include "program.h"
#include "running_program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <array>
#include <csignal>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::app {
namespace {

using contract::eventually;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Corners = std::array<glm::dvec2, 4>;
using Arguments = std::vector<std::string>;
using Button = XServer::Button;
using Held = XServer::Held;

// Two outputs side by side, with a canvas each, and small.
constexpr std::string_view kTwoCanvases = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {driver: headless}
    size: [160, 90]
    refresh_rate: 30
    corners: [[0, 0], [160, 0], [160, 90], [0, 90]]
    projector: {position: [-0.5, 1.5, 4], look_at: [-0.5, 1.5, 0], throw_ratio: 1.9}
    surface: {point: [0, 0, 0], normal: [0, 0, 1]}
  - name: right
    display: {driver: headless}
    size: [160, 90]
    refresh_rate: 30
    corners: [[0, 0], [160, 0], [160, 90], [0, 90]]
    projector: {position: [1.9, 1.5, 4], look_at: [1.9, 1.5, 0], throw_ratio: 1.9}
    surface: {point: [0, 0, 0], normal: [0, 0, 1]}
camera:
  device: {driver: simulated}
  size: [192, 96]
  field_of_view: 75
  position: [0.7, 1.7, 4]
  look_at: [0.7, 1.5, 0]
simulation:
  ambient: [0.7, 0.95, 1.6]
  objects:
    - {name: wall, rectangle: {corner: [-9, -2, 0], right: [18, 0, 0], up: [0, 8, 0]}, reflectance: [0.58, 0.57, 0.54]}
  camera: {white: 600, frame_rate: 15}
)";
constexpr const char* kWindow = "Fantascope: corners";

class CornerWindow : public testing::Test {
protected:
    void SetUp() override {
        auto server = XServer::start();
        ASSERT_TRUE(server) << server.error().message();
        server_ = std::move(server).value();
        folder_.file("site.yaml", kTwoCanvases);
    }
    static Arguments calibration(const Arguments& more) {
        Arguments arguments = {"calibrate", ".", "--simulate", "--write", "--report", "r.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    Outcome calibrate(const Arguments& more) const { return runProgram(calibration(more), folder_.path()); }
    // Starts a calibration, and waits until its window shows something.
    void start(const Arguments& more) {
        program_.emplace(calibration(more), folder_.path());
        eventually("the window shows a picture", [&] { return server_->hasWindow(kWindow) && isLit(server_->row(360)); });
    }
    static bool isLit(const std::vector<std::array<std::uint8_t, 3>>& row) {
        return std::ranges::any_of(row, [](const auto& pixel) { return pixel[0] > 60; });
    }
    // Its status when it has ended by itself.
    int end() { return program_->stop(0); }
    Corners corners(const std::string& output) const {
        const auto report = nlohmann::json::parse(contentsOf(folder_ / "r.json"));
        Corners corners;
        for (std::size_t i = 0; i < 4; ++i) {
            const auto& corner = report["outputs"][output]["camera"][i];
            corners[i] = {corner[0].get<double>(), corner[1].get<double>()};
        }
        return corners;
    }
    // Where the window shows a camera pixel.
    static glm::ivec2 at(glm::dvec2 pixel) { return glm::ivec2(glm::dvec2((1280 - 192 * kScale) / 2, 44) + pixel * kScale); }
    static constexpr double kScale = 568.0 / 96;

    const BrokenPipesIgnored ignored_;
    const ScratchFolder folder_;
    std::unique_ptr<XServer> server_;
    std::optional<RunningProgram> program_;
};

// With keys and pointer; and a wanted file with the same corners leads to the same site file.
TEST_F(CornerWindow, puts_a_canvas_where_a_person_wants_it_as_a_wanted_file_does) {
    ASSERT_THAT(calibrate({"left"}), exits(0));
    const Corners largest = corners("left");
    folder_.file("site.yaml", kTwoCanvases);
    start({"left", "--wanted", "window"});
    for (int i = 0; i < 3; ++i) server_->typeKey(kWindow, "Down");
    server_->typeKey(kWindow, "Tab");
    server_->typeKey(kWindow, "Down", Held::Control);
    server_->typeKey(kWindow, "Tab");
    server_->typeKey(kWindow, "Up");
    server_->typeKey(kWindow, "Up");
    server_->typeKey(kWindow, "BackSpace");
    const glm::ivec2 last = at(largest[3]);
    server_->movePointer(kWindow, last.x, last.y, Button::Pressed);
    server_->movePointer(kWindow, last.x + 12, last.y - 18);
    server_->movePointer(kWindow, last.x + 12, last.y - 18, Button::Released);
    server_->typeKey(kWindow, "Return");
    ASSERT_EQ(end(), 0) << program_->all();
    const Corners chosen = corners("left");
    const Corners moves = {glm::dvec2(0, 3), glm::dvec2(0, 0.1), glm::dvec2(0, -1), glm::dvec2(12, -18) / kScale};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(glm::distance(chosen[i], largest[i] + moves[i]), 0.1) << i;

    const std::string site = contentsOf(folder_ / "site.yaml"), report = contentsOf(folder_ / "r.json");
    EXPECT_NE(site, kTwoCanvases);
    folder_.file("site.yaml", kTwoCanvases);
    folder_.file("wanted.yaml", fmt::format("fantascope: wanted\nversion: 1\noutputs: {{left: {{camera: {}}}}}\n",
                                            nlohmann::json::parse(report)["outputs"]["left"]["camera"].dump()));
    ASSERT_THAT(calibrate({"left", "--wanted", "wanted.yaml"}), exits(0));
    EXPECT_EQ(contentsOf(folder_ / "site.yaml"), site);
    EXPECT_EQ(contentsOf(folder_ / "r.json"), report);
}

TEST_F(CornerWindow, asks_for_one_canvas_after_the_other) {
    start({"--wanted", "window"});
    const auto first = server_->row(20);
    server_->typeKey(kWindow, "Down");
    server_->pressKey(kWindow, "Return");
    eventually("the window asks for the next one", [&] { return server_->row(20) != first; });
    server_->pressKey(kWindow, "Return");  // it is still held, and repeats
    server_->typeKey(kWindow, "Down");
    server_->typeKey(kWindow, "Return");  // its release ends the repetition
    server_->typeKey(kWindow, "Return");
    ASSERT_EQ(end(), 0) << program_->all();
    const Corners left = corners("left"), right = corners("right");
    folder_.file("site.yaml", kTwoCanvases);
    ASSERT_THAT(calibrate({}), exits(0));
    EXPECT_NEAR(left[0].y, corners("left")[0].y + 1, 0.05);
    EXPECT_NEAR(right[0].y, corners("right")[0].y + 1, 0.05) << "a held Enter took the second place";
    EXPECT_EQ(right[1], corners("right")[1]) << "taken as it was proposed";
}

// However it ends without a place, the site is as it was, and the message says so.
TEST_F(CornerWindow, leaves_the_site_as_it_was_if_no_place_is_taken) {
    const auto expectEnd = [&](const std::string& message) {
        EXPECT_EQ(end(), 1);
        EXPECT_THAT(program_->all(), AllOf(HasSubstr(message), HasSubstr("nothing is changed")));
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"site.yaml"});
        EXPECT_EQ(contentsOf(folder_ / "site.yaml"), kTwoCanvases);
    };
    start({"left", "--wanted", "window"});
    server_->typeKey(kWindow, "Escape");
    expectEnd("given up by Escape");
    start({"left", "--wanted", "window"});
    server_->closeWindow(kWindow);
    expectEnd("the window was closed before a place was chosen");
    EXPECT_THAT(program_->all(), HasSubstr("--picture"));
    start({"left", "--wanted", "window"});
    EXPECT_EQ(program_->stop(SIGINT), 1) << "Ctrl-C";
    EXPECT_THAT(program_->all(), HasSubstr("ended before a place was chosen; nothing is changed"));
    start({"left", "--wanted", "window"});
    server_->crash();
    expectEnd("the X server has ended before a place was chosen");
}

// Before anything is measured, and with what to do instead.
TEST_F(CornerWindow, needs_a_display) {
    server_.reset();
    const Outcome outcome = runProgram(calibration({"--wanted", "window"}), folder_.path(), {{"DISPLAY", ""}});
    EXPECT_THAT(outcome, exits(1));
    EXPECT_THAT(outcome.errors, AllOf(HasSubstr("no window can be opened"), HasSubstr("--picture wall.png"),
                                      HasSubstr("--wanted FILE"), Not(HasSubstr("%"))));
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"site.yaml"});
}

// For whom has no window: the camera's picture with the light of all outputs, and the corners.
TEST_F(CornerWindow, can_be_replaced_by_a_picture_and_a_file) {
    server_.reset();
    const Outcome outcome = calibrate({"--picture", "wall.png"});
    ASSERT_THAT(outcome, exits(0));
    const GreyImage picture = readGrey(folder_ / "wall.png").value();
    ASSERT_EQ(glm::ivec2(picture.width(), picture.height()), glm::ivec2(192, 96));
    for (const char* output : {"left", "right"}) {
        const Corners place = corners(output);
        const glm::ivec2 middle((place[0] + place[1] + place[2] + place[3]) / 4.0);
        EXPECT_GT(picture.at(middle.x, middle.y), 0.7) << output;
        EXPECT_THAT(outcome.out, HasSubstr(fmt::format("the canvas '{}' has its corners at [[{:.1f}, {:.1f}], [", output,
                                                       place[0].x, place[0].y)));
    }
    EXPECT_LT(picture.at(3, 3), 0.3) << "no light falls there";
    EXPECT_THAT(calibrate({"--picture", "wall.jpg"}), exits(2));
    EXPECT_THAT(calibrate({"--picture", "site.yaml/wall.png"}).errors, HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace fantascope::app
