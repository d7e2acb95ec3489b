// What goes wrong with a calibration is told by its cause, with what to do, and nothing is written.

#include "core/file.h"
#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Arguments = std::vector<std::string>;

// Two pictures side by side in a lit street, on a wall that the camera faces. {0}: of each output,
// what it falls on; {1}: the faults.
constexpr std::string_view kNightSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {{driver: headless}}
    size: [160, 90]
    refresh_rate: 30
    corners: [[0, 0], [160, 0], [160, 90], [0, 90]]
    projector: {{position: [-0.5, 1.5, 4], look_at: [-0.5, 1.5, 0], throw_ratio: 1.9}}{0}
  - name: right
    display: {{driver: headless}}
    size: [160, 90]
    refresh_rate: 30
    corners: [[0, 0], [160, 0], [160, 90], [0, 90]]
    projector: {{position: [0.7, 1.5, 4], look_at: [0.7, 1.5, 0], throw_ratio: 1.9}}{0}
camera:
  device: {{driver: simulated}}
  size: [192, 96]
  field_of_view: 60
  position: [0.1, 1.7, 4]
  look_at: [0.1, 1.5, 0]
simulation:
  ambient: [60, 60, 60]
  objects:
    - {{name: wall, rectangle: {{corner: [-9, -2, 0], right: [18, 0, 0], up: [0, 8, 0]}}, reflectance: [0.58, 0.57, 0.54]}}
  camera: {{white: 600, frame_rate: 15, read_noise: {2}}}
  faults: [{1}]
)";
const std::string kWall = "\n    surface: {point: [0, 0, 0], normal: [0, 0, 1]}";

class CalibrationTroubles : public testing::Test {
protected:
    void makeSite(const std::string& faults, const std::string& surface = kWall, double noise = 0.002) const {
        folder_.file("site.yaml", fmt::format(kNightSite, surface, faults, noise));
    }
    Outcome calibrate(const Arguments& more = {}) const {
        Arguments arguments = {"calibrate", ".", "--simulate", "--write"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runProgram(arguments, folder_.path());
    }
    // Calibrates a site with a fault: it fails and says all of `messages`, and the site is as it
    // was.
    void expectRefusal(const std::string& faults, const std::vector<std::string>& messages) const {
        SCOPED_TRACE(faults);
        makeSite(faults);
        const std::string before = contentsOf(folder_ / "site.yaml");
        const Outcome outcome = calibrate();
        EXPECT_THAT(outcome, exits(1));
        for (const std::string& message : messages) EXPECT_THAT(outcome.out + outcome.errors, HasSubstr(message));
        EXPECT_EQ(contentsOf(folder_ / "site.yaml"), before);
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"site.yaml"});
    }
    const ScratchFolder folder_;
};

TEST_F(CalibrationTroubles, do_not_come_by_themselves) {
    makeSite("");
    const Outcome outcome = calibrate();
    EXPECT_THAT(outcome, exits(0));
    EXPECT_THAT(outcome.out, Not(HasSubstr("note")));
}

TEST_F(CalibrationTroubles, of_a_camera_that_is_not_there) {
    expectRefusal("{kind: unplug, device: camera, at: 0}", {"the camera gave 0 pictures in 5 s: unplugged", "plug it in again"});
    // While the delay is measured, as soon as the first output is, and later.
    for (const char* at : {"3", "7.5", "8.5"})
        expectRefusal(fmt::format("{{kind: unplug, device: camera, at: {}}}", at),
                      {"the camera stopped: unplugged in the simulated site; plug it in again"});
}

TEST_F(CalibrationTroubles, of_a_camera_that_sees_nothing) {
    expectRefusal("{kind: blind, level: 0, at: 0}", {"error: the camera's pictures are black; take the cap off its lens"});
    expectRefusal("{kind: blind, level: 0, at: 8}",
                  {"left: the camera's pictures are black", "right: the camera's pictures are"});
    expectRefusal("{kind: blind, level: 1, at: 0}", {"error: the camera's pictures are white, even while the outputs are dark"});
    expectRefusal("{kind: blind, level: 1, at: 8}", {"left: the camera's pictures are white", "lower its exposure or gain"});
}

TEST_F(CalibrationTroubles, of_a_camera_that_is_saturated) {
    expectRefusal(
        "{kind: exposure, gain: 30, at: 0}",
        {"left: the camera is saturated by its light; lower the camera's exposure or gain", "right: the camera is satu"});
}

// When the delay is measured, when greys are, and among the stripes; and if it comes back.
TEST_F(CalibrationTroubles, of_a_camera_that_is_frozen) {
    const std::string frozen = "the camera repeats one picture again and again; unplug it";
    for (const char* at : {"0", "5"})
        expectRefusal(fmt::format("{{kind: freeze, device: camera, at: {}}}", at), {"error: " + frozen});
    for (const char* at : {"8", "14"})
        expectRefusal(fmt::format("{{kind: freeze, device: camera, at: {}}}", at), {"left: " + frozen, "right: " + frozen});
    makeSite("{kind: freeze, device: camera, at: 14, until: 16}");
    const Outcome outcome = calibrate();
    EXPECT_THAT(outcome, exits(1));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("left: " + frozen), HasSubstr("right: rms")));
}

// Example failure: the outputs that were measured before the camera was pushed get warps for where
// it stood then.
TEST_F(CalibrationTroubles, of_what_is_pushed_between_two_outputs) {
    for (const char* fault : {"camera_bump, turn: [0, 0.4, 0]", "bump, output: left, turn: [0, 0, 1]"}) {
        makeSite(fmt::format("{{kind: {}, at: 22}}", fault));
        const Outcome outcome = calibrate();
        EXPECT_THAT(outcome, exits(1));
        EXPECT_THAT(outcome.out, AllOf(HasSubstr("left: the light of 'left' has moved by"), HasSubstr("right: rms")));
        const std::string site = contentsOf(folder_ / "site.yaml");
        EXPECT_THAT(site.substr(0, site.find("name: right")), HasSubstr("corners: [[0, 0], [160, 0], [160, 90], [0, 90]]"));
    }
}

TEST_F(CalibrationTroubles, of_outputs_that_are_not_in_view) {
    expectRefusal("{kind: camera_bump, at: 0, turn: [0, 70, 0]}",
                  {"error: the camera sees no light of the outputs", "turn the camera"});
    // Example failure: noise passes for the light of an output, and the camera for a slow one.
    makeSite("{kind: camera_bump, at: 0, turn: [0, 70, 0]}", kWall, 0.1);
    EXPECT_THAT(calibrate(),
                AllOf(exits(1), testing::Field(&Outcome::errors, HasSubstr("the camera sees no light of the outputs"))));
    makeSite("{kind: bump, output: right, at: 0, turn: [0, 60, 0]}");
    const Outcome outcome = calibrate();
    EXPECT_THAT(outcome, exits(1));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("left: rms"), HasSubstr("right: the camera sees its light on "),
                                   HasSubstr("see that the projector is on, turn it or the camera")));
}

// The camera sees the wall consistently whichever way up it is. Only the site file tells.
TEST_F(CalibrationTroubles, of_a_camera_that_stands_upside_down) {
    const std::string upsideDown = "{kind: upside_down, at: 0}";
    expectRefusal(upsideDown, {"left: ", "the camera sees its picture upside down, against what the site file says",
                               "turn the camera the right way up, or write 'turn: 180' if the projector hangs upside down"});

    // By hand a place may be anywhere.
    folder_.file("wanted.yaml",
                 "fantascope: wanted\nversion: 1\noutputs:\n"
                 "  left: {camera: [[120, 60], [170, 60], [170, 32], [120, 32]]}\n"
                 "  right: {camera: [[30, 60], [80, 60], [80, 32], [30, 32]]}\n");
    EXPECT_THAT(calibrate({"--wanted", "wanted.yaml"}), exits(0));

    // Where the site file does not say where the wall is.
    makeSite(upsideDown, "");
    const Outcome outcome = calibrate();
    EXPECT_THAT(outcome, exits(0));
    EXPECT_THAT(outcome.out,
                HasSubstr("; written; note: turned by half a turn from before; if it stands upside down on the wall"));
    makeSite("", "");
    EXPECT_THAT(calibrate().out, Not(HasSubstr("note")));
}

// A projector that hangs upside down is said to do so; then nobody can tell which way up it is.
TEST_F(CalibrationTroubles, of_one_projector_that_hangs_upside_down) {
    makeSite("{kind: bump, output: right, at: 0, turn: [0, 0, 180]}");
    const Outcome outcome = calibrate();
    EXPECT_THAT(outcome, exits(1));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("left: rms"), HasSubstr("right: "), HasSubstr("write 'turn: 180'")));
    std::string text = contentsOf(folder_ / "site.yaml");
    text.insert(text.rfind("    projector"), "    turn: 180\n");
    folder_.file("site.yaml", text);
    EXPECT_THAT(calibrate(), exits(0));
}

}  // namespace
}  // namespace fantascope::app
