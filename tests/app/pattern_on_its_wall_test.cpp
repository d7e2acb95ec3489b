// A pattern that is fitted to a stained wall while its show runs, as a person plays it.

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

namespace fantascope::app {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// {}: the mode.
constexpr std::string_view kWatchedSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {{driver: headless}}
    size: [320, 180]
    refresh_rate: 5
    corners: [[0, 0], [320, 0], [320, 180], [0, 180]]
    projector: {{position: [-1.6, 2.6, 6], look_at: [0, 1.5, 0], throw_ratio: 1.6}}
    surface: {{point: [0, 0, 0], normal: [0, 0, 1]}}
cue_controller: {{device: {{driver: simulated}}, buttons: {{go: 1}}}}
camera:
  device: {{driver: simulated}}
  size: [320, 180]
  field_of_view: 44
  position: [1.8, 1.7, 6]
  look_at: [0, 1.5, 0]
corrections: {{light: {{mode: off}}, pattern: {{mode: {}, fade: 2}}}}
simulation:
  ambient: [0.2, 0.25, 0.4]
  objects:
    - {{name: wall, rectangle: {{corner: [-4, -1, 0], right: [8, 0, 0], up: [0, 5, 0], texture: wall.png}}, reflectance: [1, 1, 1]}}
  camera: {{white: 110, latency: 0.05, frame_rate: 2.5}}
)";

class PatternOnItsWall : public testing::Test {
protected:
    PatternOnItsWall() {
        GreyImage guide(320, 180);
        for (int y = 0; y < guide.height(); ++y)
            for (int x = 0; x < guide.width(); ++x) {
                const double far = std::hypot((x - 160) / 130.0, (y - 90) / 75.0);
                guide.at(x, y) = static_cast<float>(std::clamp(1.6 - 1.6 * far, 0.0, 0.85));
            }
        EXPECT_TRUE(writePng(folder_ / "guide.png", guide));
        paint(1);
        folder_.file("few.pattern-settings.yaml",
                     "fantascope: pattern-settings\nversion: 1\nshapes: {instances: 300}\nsearch: {rows: 180}\n");
        folder_.file("show.yaml",
                     "fantascope: show\nversion: 1\ntitle: Stains\nsources: {drawing: {pattern: drawing.pattern.yaml}}\n"
                     "looks: {all: {outputs: {left: [{source: drawing}]}}}\ncues: [{name: one, look: all, fade: 0.1}]\n");
        folder_.file("site.yaml", fmt::format(kWatchedSite, "off"));
        EXPECT_THAT(run({"calibrate", ".", "--simulate", "--write"}), exits(0));
        EXPECT_THAT(run({"pattern", "guide.png", "-o", "drawing.pattern.yaml", "--iterations", "60", "--settings",
                         "few.pattern-settings.yaml"}),
                    exits(0));
    }
    // Gravel, on which a stain gives back a share of the light.
    void paint(double share) const {
        RgbaImage wall(400, 250);
        for (int y = 0; y < wall.height(); ++y)
            for (int x = 0; x < wall.width(); ++x) {
                const bool isStained = std::hypot((x - 210) / 50.0, (y - 120) / 40.0) < 1;
                const double light = (0.5 + 0.1 * std::sin(x * 0.9) * std::sin(y * 1.1)) * (isStained ? share : 1);
                const auto stored = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(static_cast<float>(light))));
                wall.at(x, y) = {stored, stored, stored, 255};
            }
        EXPECT_TRUE(writePng(folder_ / "wall.png", wall));
    }
    void setMode(const std::string& mode) const {
        std::string text = contentsOf(folder_ / "site.yaml");
        const std::size_t at = text.find("pattern: {mode: ") + 16;
        text.replace(at, text.find(',', at) - at, mode);
        folder_.file("site.yaml", text);
    }
    Outcome run(const std::vector<std::string>& arguments) const { return runProgram(arguments, folder_ / "."); }
    struct Played {
        nlohmann::json report;
        std::string told, film;
        // The mean of a score over some seconds.
        double mean(const char* key, double from, double to) const {
            double sum = 0;
            int count = 0;
            for (const auto& entry : report[key]["left"])
                if (entry[0] > from && entry[0] < to) sum += entry[1].get<double>(), ++count;
            EXPECT_GT(count, 10) << key;
            return sum / count;
        }
    };
    Played play() const {
        const Outcome outcome = run({"rehearse", ".", "--site", "site.yaml", "--from", "one", "--seconds", "56",
                                     "--as-fast-as-possible", "--report", "r.json", "--record", "film.mp4"});
        EXPECT_THAT(outcome, exits(0));
        return {nlohmann::json::parse(contentsOf(folder_ / "r.json")), outcome.out + outcome.errors,
                contentsOf(folder_ / "film.mp4")};
    }
    const ScratchFolder folder_;
};

// The stain came after the calibration.
TEST_F(PatternOnItsWall, reads_better_on_a_stain_that_the_camera_finds_during_the_show) {
    paint(0.45);
    const Played off = play();
    EXPECT_THAT(off.report["patterns"], IsEmpty());
    setMode("advise");
    const Played advised = play();
    EXPECT_EQ(advised.film, off.film) << "advice changes no byte";
    EXPECT_THAT(advised.told, HasSubstr("better on this wall (corrections: pattern: {mode: automatic})"));
    setMode("automatic");
    const Played fitted = play();
    EXPECT_THAT(fitted.told, HasSubstr("drawing: the pattern is fitted to this wall"));
    ASSERT_THAT(fitted.report["patterns"], SizeIs(1));
    const auto& exchange = fitted.report["patterns"][0];
    EXPECT_EQ(exchange["applied"], true);
    EXPECT_LT(exchange["tone_after"], 0.8 * exchange["tone_before"].get<double>());
    EXPECT_LT(exchange["at"], 50);
    EXPECT_EQ(fitted.mean("tone_camera", 2, 35), off.mean("tone_camera", 2, 35));
    EXPECT_LT(fitted.mean("tone_camera", 48, 56), 0.88 * off.mean("tone_camera", 48, 56));
    EXPECT_LT(fitted.mean("z_camera", 48, 56), off.mean("z_camera", 48, 56));
    for (const auto& cause : fitted.report["causes"]) EXPECT_LT(cause["from"], 40) << cause << ": the exchange names no cause";
    EXPECT_EQ(play().film, fitted.film) << "the same show, whatever time the search takes";
}

TEST_F(PatternOnItsWall, stays_as_it_is_on_the_wall_that_was_calibrated) {
    setMode("automatic");
    EXPECT_THAT(play().report["patterns"], IsEmpty());
}

}  // namespace
}  // namespace fantascope::app
