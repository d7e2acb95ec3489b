#pragma once
// A drawing as a light pattern on a simulated wall, from the calibration to the camera's judgement,
// as a person plays it.

#include "media/image.h"
#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/vec2.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::app {

class DrawingOnAWall : public testing::Test {
protected:
    struct Place {
        glm::ivec2 size;          // of the projector's picture, pixels
        double rate = 0;          // of the projector, Hz
        double cameraRate = 0;    // Hz
        std::string corrections;  // of the site, in YAML
        int instances = 0;        // of the pattern
    };

    // The wall is not painted yet, and there is no pattern.
    explicit DrawingOnAWall(const Place& place) {
        GreyImage guide(320, 180);
        for (int y = 0; y < guide.height(); ++y)
            for (int x = 0; x < guide.width(); ++x) {
                const double far = std::hypot((x - 160) / 130.0, (y - 90) / 75.0);
                guide.at(x, y) = static_cast<float>(std::clamp(1.6 - 1.6 * far, 0.0, 0.85));
            }
        EXPECT_TRUE(writePng(folder_ / "guide.png", guide));
        folder_.file("few.pattern-settings.yaml",
                     fmt::format("fantascope: pattern-settings\nversion: 1\nshapes: {{instances: {}}}\nsearch: {{rows: 180}}\n",
                                 place.instances));
        folder_.file("show.yaml",
                     "fantascope: show\nversion: 1\ntitle: Stains\nsources: {drawing: {pattern: drawing.pattern.yaml}}\n"
                     "looks: {all: {outputs: {left: [{source: drawing}]}}}\ncues: [{name: one, look: all, fade: 0.1}]\n");
        folder_.file("site.yaml",
                     fmt::format(kSite, place.size.x, place.size.y, place.rate, place.corrections, place.cameraRate));
    }

    // `light`: the share that the wall gives back at a pixel of its 400 x 250.
    template <class Light>
    void paint(const Light& light) const {
        RgbaImage wall(400, 250);
        for (int y = 0; y < wall.height(); ++y)
            for (int x = 0; x < wall.width(); ++x) {
                const auto stored = std::lround(255 * srgbFromLinear(static_cast<float>(light(x, y))));
                const auto grey = static_cast<std::uint8_t>(stored);
                wall.at(x, y) = {grey, grey, grey, 255};
            }
        EXPECT_TRUE(writePng(folder_ / "wall.png", wall));
    }
    void calibrate() const { EXPECT_THAT(run({"calibrate", ".", "--simulate", "--write"}), exits(0)); }
    // Sets a correction's mode. The warp that the calibration wrote stays.
    void setMode(const std::string& correction, const std::string& mode) const {
        std::string text = contentsOf(folder_ / "site.yaml");
        const std::string key = correction + ": {mode: ";
        const std::size_t at = text.find(key) + key.size();
        text.replace(at, text.find(',', at) - at, mode);
        folder_.file("site.yaml", text);
    }
    Outcome run(const std::vector<std::string>& arguments) const { return runProgram(arguments, folder_ / "."); }
    // Searches for the drawing's pattern.
    void search(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {
            "pattern", "guide.png", "-o",           "drawing.pattern.yaml", "--iterations",
            "60",      "--report",  "pattern.json", "--settings",           "few.pattern-settings.yaml"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_THAT(run(arguments), exits(0));
    }
    struct Played {
        nlohmann::json report;
        std::string told, film;
        // The mean of a score over some seconds, in which there are more than `count` of it.
        double mean(const char* key, double from, double to, int count = 10) const {
            double sum = 0;
            int found = 0;
            for (const auto& entry : report[key]["left"])
                if (entry[0] > from && entry[0] < to) sum += entry[1].get<double>(), ++found;
            EXPECT_GT(found, count) << key;
            return sum / found;
        }
    };
    Played play(const std::string& length) const {
        const Outcome outcome = run({"rehearse", ".", "--site", "site.yaml", "--from", "one", "--seconds", length,
                                     "--as-fast-as-possible", "--report", "r.json", "--record", "film.mp4"});
        EXPECT_THAT(outcome, exits(0));
        return {nlohmann::json::parse(contentsOf(folder_ / "r.json")), outcome.out + outcome.errors,
                contentsOf(folder_ / "film.mp4")};
    }
    const ScratchFolder folder_;

private:
    // Seen and lit at a slant. {0}, {1}: Place::size; {2}: rate; {3}: corrections; {4}: cameraRate.
    static constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {{driver: headless}}
    size: [{0}, {1}]
    refresh_rate: {2}
    corners: [[0, 0], [{0}, 0], [{0}, {1}], [0, {1}]]
    projector: {{position: [-1.6, 2.6, 6], look_at: [0, 1.5, 0], throw_ratio: 1.6}}
    surface: {{point: [0, 0, 0], normal: [0, 0, 1]}}
cue_controller: {{device: {{driver: simulated}}, buttons: {{go: 1}}}}
camera:
  device: {{driver: simulated}}
  size: [320, 180]
  field_of_view: 44
  position: [1.8, 1.7, 6]
  look_at: [0, 1.5, 0]
corrections: {3}
simulation:
  ambient: [0.2, 0.25, 0.4]
  objects:
    - {{name: wall, rectangle: {{corner: [-4, -1, 0], right: [8, 0, 0], up: [0, 5, 0], texture: wall.png}}, reflectance: [1, 1, 1]}}
  camera: {{white: 110, latency: 0.05, frame_rate: {4}}}
)";
};

}  // namespace fantascope::app
