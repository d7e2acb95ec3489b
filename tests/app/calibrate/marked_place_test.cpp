// Glues the printed corner markers to a simulated wall, calibrates between them, and holds the warp
// against where projector, wall and markers are.

#include "app/site/site_file.h"
#include "app/site/site_models.h"

#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - name: wall
    display: {{driver: headless}}
    size: [640, 360]
    refresh_rate: 60
    projector: {{position: [-1.6, 2.6, 6], look_at: [0, 1.5, 0], throw_ratio: 1.4}}
camera: {{device: {{driver: simulated}}, size: [640, 400], field_of_view: 50, position: [1.2, 1.7, 6], look_at: [0, 1.5, 0], k1: -0.05}}
simulation:
  ambient: [0.7, 0.95, 1.6]
  objects:
    - {{name: wall, rectangle: {{corner: [-6, -2, 0], right: [12, 0, 0], up: [0, 8, 0]}}, reflectance: [0.5, 0.45, 0.4]}}
{}  camera: {{white: 130, read_noise: 0.004, shot_noise: 0.012, latency: 0.1, frame_rate: 30}}
)";
constexpr std::array<std::string_view, 4> kNames = {"top-left", "top-right", "bottom-right", "bottom-left"};
constexpr std::array<glm::dvec2, 4> kPlaces = {{{-1.2, 2.15}, {1.3, 2.2}, {1.25, 0.9}, {-1.15, 0.85}}};  // metres on the wall

class MarkedPlace : public testing::Test {
protected:
    MarkedPlace() { EXPECT_THAT(runProgram({"calibrate", "--markers", "m.png"}, folder_ / "."), exits(0)); }
    // Sheets of paper of 25 cm width, their middles at the places. `without`: this one is lost.
    void makeSite(std::string_view without = "") {
        constexpr double kWide = 0.25, kHigh = kWide * 842 / 595;
        std::string sheets;
        for (std::size_t i = 0; i < kPlaces.size(); ++i)
            if (kNames[i] != without)
                sheets += fmt::format(
                    "    - {{name: {0}, rectangle: {{corner: [{1}, {2}, 0.001], right: [{3}, 0, 0], up: [0, {4}, 0], texture: "
                    "m-{0}.png}}, reflectance: [0.8, 0.8, 0.8]}}\n",
                    kNames[i], kPlaces[i].x - kWide / 2, kPlaces[i].y - kHigh / 2, kWide, kHigh);
        folder_.file("site.yaml", fmt::format(kSite, sheets));
    }
    Outcome calibrate() const {
        return runProgram({"calibrate", ".", "--simulate", "--wanted", "markers", "--write", "--report", "r.json"},
                          folder_ / ".");
    }
    const ScratchFolder folder_;
};

TEST_F(MarkedPlace, is_between_the_middles_of_the_markers) {
    makeSite();
    ASSERT_THAT(calibrate(), exits(0));
    const show::Site site = readSite(folder_ / "site.yaml").value();
    const show::Output& output = site.outputs[0];
    const auto projector =
        vision::CameraModel::fromThrowRatio(output.projector->pose, output.size(), output.projector->throwRatio, glm::dvec2(0));
    double worst = 0;
    for (std::size_t i = 0; i < kPlaces.size(); ++i)
        worst = std::max(worst, glm::distance(output.projection.warp.projectorFromCanvas(rectangleCorners(1, 1)[i]),
                                              *projector.pixelFromWorld({kPlaces[i], 0})));
    std::printf("the corners lie at most %.2f projector pixels beside the markers' middles\n", worst);
    EXPECT_LT(worst, 1);
}

TEST_F(MarkedPlace, is_not_guessed_if_a_marker_is_missing) {
    makeSite("bottom-right");
    EXPECT_THAT(calibrate(), exits(1));
    const auto report = nlohmann::json::parse(contentsOf(folder_ / "r.json"));
    EXPECT_THAT(report["outputs"]["wall"]["trouble"].get<std::string>(), HasSubstr("these markers: bottom right;"));
}

TEST_F(MarkedPlace, is_of_one_canvas) {
    folder_.file("site.yaml",
                 "fantascope: site\nversion: 1\noutputs:\n"
                 "  - {name: a, display: {driver: headless}, size: [64, 36], refresh_rate: 30}\n"
                 "  - {name: b, display: {driver: headless}, size: [64, 36], refresh_rate: 30}\n");
    EXPECT_THAT(calibrate().errors, HasSubstr("markers show the corners of one canvas"));
    EXPECT_THAT(runProgram({"calibrate", "--markers", "m.jpg"}, folder_ / ".").errors,
                HasSubstr("must end in .pdf, .svg or .png"));
    EXPECT_THAT(runProgram({"calibrate"}, folder_ / ".").errors, HasSubstr("a site is needed"));
}

}  // namespace
}  // namespace fantascope::app
