// A show on a simulated wall with stains, from the calibration to the camera's judgement, as a
// person plays it.

#include "media/image.h"
#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

// A wall seen and lit at a slant. {}: the light correction's mode.
constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {{driver: headless}}
    size: [640, 360]
    refresh_rate: 30
    corners: [[0, 0], [640, 0], [640, 360], [0, 360]]
    projector: {{position: [-1.6, 2.6, 6], look_at: [0, 1.5, 0], throw_ratio: 1.6}}
    surface: {{point: [0, 0, 0], normal: [0, 0, 1]}}
cue_controller: {{device: {{driver: simulated}}, buttons: {{go: 1}}}}
camera:
  device: {{driver: simulated}}
  size: [320, 180]
  field_of_view: 44
  position: [1.8, 1.7, 6]
  look_at: [0, 1.5, 0]
corrections: {{light: {{mode: {}, least: 0.1}}}}
simulation:
  ambient: [0.2, 0.25, 0.4]
  objects:
    - {{name: wall, rectangle: {{corner: [-4, -1, 0], right: [8, 0, 0], up: [0, 5, 0], texture: stains.png}}, reflectance: [1, 1, 1]}}
  camera: {{white: 110, latency: 0.05, frame_rate: 10}}
)";

class LightOnAStainedWall : public testing::Test {
protected:
    LightOnAStainedWall() {
        RgbaImage stains(400, 250);
        for (int y = 0; y < stains.height(); ++y)
            for (int x = 0; x < stains.width(); ++x) {
                const double light = 0.38 + 0.28 * std::sin(x / 23.0) * std::cos(y / 19.0);
                const auto stored = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(static_cast<float>(light))));
                stains.at(x, y) = {stored, stored, stored, 255};
            }
        GreyImage guide(320, 180);
        for (int y = 0; y < guide.height(); ++y)
            for (int x = 0; x < guide.width(); ++x) {
                const double far = std::hypot((x - 160) / 130.0, (y - 90) / 75.0);
                guide.at(x, y) = static_cast<float>(std::clamp(1.6 - 1.6 * far, 0.0, 0.85));
            }
        EXPECT_TRUE(writePng(folder_ / "stains.png", stains) && writePng(folder_ / "guide.png", guide));
        folder_.file("few.pattern-settings.yaml",
                     "fantascope: pattern-settings\nversion: 1\nshapes: {instances: 400}\nsearch: {rows: 180}\n");
        folder_.file("show.yaml",
                     "fantascope: show\nversion: 1\ntitle: Stains\nsources: {drawing: {pattern: drawing.pattern.yaml}}\n"
                     "looks: {all: {outputs: {left: [{source: drawing}]}}}\ncues: [{name: one, look: all, fade: 0.1}]\n");
        folder_.file("site.yaml", fmt::format(kSite, "off"));
        EXPECT_THAT(run({"calibrate", ".", "--simulate", "--write"}), exits(0));
    }
    // Sets the light correction's mode. The warp that the calibration wrote stays.
    void setMode(const std::string& mode) const {
        std::string text = contentsOf(folder_ / "site.yaml");
        const std::size_t at = text.find("mode: ") + 6;
        text.replace(at, text.find(',', at) - at, mode);
        folder_.file("site.yaml", text);
    }
    Outcome run(const std::vector<std::string>& arguments) const { return runProgram(arguments, folder_ / "."); }
    // Searches for the drawing's pattern.
    void search(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments = {
            "pattern", "guide.png", "-o",           "drawing.pattern.yaml", "--iterations",
            "60",      "--report",  "pattern.json", "--settings",           "few.pattern-settings.yaml"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_THAT(run(arguments), exits(0));
    }
    struct Played {
        nlohmann::json light;    // what the report says of the light correction
        double z = 1, tone = 1;  // means once the correction is faded in
        std::string told, film;
    };
    Played play() const {
        const Outcome outcome = run({"rehearse", ".", "--site", "site.yaml", "--from", "one", "--seconds", "6.5",
                                     "--as-fast-as-possible", "--report", "r.json", "--record", "film.mp4"});
        EXPECT_THAT(outcome, exits(0));
        const auto report = nlohmann::json::parse(contentsOf(folder_ / "r.json"));
        const auto mean = [&](const char* key) {
            double sum = 0;
            int count = 0;
            for (const auto& entry : report[key]["left"])
                if (entry[0].get<double>() > 5.2) sum += entry[1].get<double>(), ++count;
            EXPECT_GT(count, 5) << key;
            return sum / count;
        };
        return {report["light_correction"], mean("z_camera"), mean("tone_camera"), outcome.out + outcome.errors,
                contentsOf(folder_ / "film.mp4")};
    }
    const ScratchFolder folder_;
};

TEST_F(LightOnAStainedWall, is_nearer_to_the_drawing_if_it_is_evened_out_and_nearest_if_the_pattern_knows_the_wall) {
    search({});
    const Played off = play();
    EXPECT_TRUE(off.light.empty());
    setMode("advise");
    const Played advised = play();
    EXPECT_EQ(advised.film, off.film) << "advice changes no byte";
    EXPECT_THAT(advised.told, HasSubstr("the light of 'left' could be evened out"));
    EXPECT_EQ(advised.light["left"]["applied"], false);

    setMode("automatic");
    const Played evened = play();
    EXPECT_THAT(evened.told, HasSubstr("the light of 'left' is evened out"));
    EXPECT_EQ(evened.light["left"]["applied"], true);
    EXPECT_LT(evened.light["left"]["kept"], 0.9);
    EXPECT_LT(evened.tone, 0.7 * off.tone);
    EXPECT_LT(evened.z, 0.7 * off.z);

    search({"--surface", "site.yaml:left"});
    const Played both = play();
    EXPECT_LT(both.tone, evened.tone);
    setMode("off");
    search({"--surface", "site.yaml:left"});
    EXPECT_LT(play().tone, 0.7 * off.tone);
    const auto report = nlohmann::json::parse(contentsOf(folder_ / "pattern.json"));
    EXPECT_LT(report["tone_surface"], report["tone"]) << "on plain white it is the pattern of a stained wall";
}

TEST_F(LightOnAStainedWall, is_left_alone_and_told_if_the_picture_was_moved_by_hand) {
    search({});
    setMode("automatic");
    std::string text = contentsOf(folder_ / "site.yaml");
    text.replace(text.find("corners: [["), 11, "corners: [[1");  // ten pixels and more to the right
    folder_.file("site.yaml", text);
    const Played moved = play();
    EXPECT_THAT(moved.told, HasSubstr("the light of 'left' is not evened out: output 'left': its picture was moved since"));
    EXPECT_EQ(moved.light["left"]["applied"], false);
    EXPECT_THAT(run({"pattern", "guide.png", "-o", "x.pattern.yaml", "--iterations", "1", "--surface", "site.yaml:left"}),
                exits(1));
}

}  // namespace
}  // namespace fantascope::app
