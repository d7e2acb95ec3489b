// Calibrates simulated sites as a person does, and holds the site file's warps against where
// projector, wall and camera stand.

#include "app/site/site_file.h"
#include "app/site/site_models.h"
#include "app/site/survey_file.h"

#include "vision/camera_model.h"

#include "core/file.h"
#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace fantascope::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Arguments = std::vector<std::string>;

MATCHER_P(refuses, message, "") { return arg.status == 1 && ExplainMatchResult(message, arg.errors, result_listener); }

// A wall at z = 0 with two projectors whose pictures overlap, and a camera with a bent lens.
constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - name: left   # on the ladder
    display: {{driver: headless}}
    size: [640, 360]
    refresh_rate: 60
    canvas: wall
    part: [0, 0, 0.6, 1]
    corners: [[0, 0], [640, 0], [640, 360], [0, 360]]
    projector: {{position: [-2.2, 2.9, 6], look_at: [-0.9, 1.5, 0], throw_ratio: 1.6}}
    surface: {{point: [0, 0, 0], normal: [0, 0, 1]}}
  - name: right
    display: {{driver: headless}}
    size: [640, 360]
    refresh_rate: 60
    canvas: wall
    part: [0.4, 0, 1, 1]
    corners: [[0, 0], [640, 0], [640, 360], [0, 360]]
    projector: {{position: [2.0, 2.7, 6.2], look_at: [0.9, 1.5, 0], throw_ratio: 1.5}}
    surface: {{point: [0, 0, 0], normal: [0, 0, 1]}}
camera:
  device: {{driver: simulated}}
  size: [320, 240]
  field_of_view: 58
  position: [0.4, 1.7, 7.5]
  look_at: [0, 1.4, 0]
  k1: -0.06
  k2: 0.01
simulation:
  ambient: [0.7, 0.95, 1.6]
  objects:
    - {{name: wall, rectangle: {{corner: [-9, -2, 0], right: [18, 0, 0], up: [0, 8, 0]}}, reflectance: [0.58, 0.57, 0.54]}}
  projectors: {{left: {{gamma: 2.4}}, right: {{gamma: 2}}}}
  camera: {{white: {}, read_noise: 0.004, shot_noise: 0.012, latency: 0.12, frame_rate: 30}}
{})";

class CalibrateCommand : public testing::Test {
protected:
    void makeSite(double white = 150, const std::string& more = "") {
        folder_.file("site.yaml", fmt::format(kSite, white, more));
    }
    Outcome run(const Arguments& more) const {
        Arguments arguments = {"calibrate", ".", "--simulate", "--report", "r.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runProgram(arguments, folder_ / ".");
    }
    std::string text(const std::string& file) const { return readFile(folder_ / file).value(); }
    nlohmann::json report() const { return nlohmann::json::parse(text("r.json")); }
    show::Site site() const { return readSite(folder_ / "site.yaml").value(); }
    static vision::CameraModel projector(const show::Output& output) {
        return vision::CameraModel::fromThrowRatio(output.projector->pose, output.size(), output.projector->throwRatio,
                                                   glm::dvec2(0));
    }
    // Asks for a canvas whose corners lie at these places of the wall, metres.
    void want(glm::dvec2 low, glm::dvec2 high) {
        const vision::CameraModel camera = cameraOf(site()).value();
        std::string corners;
        for (const glm::dvec3 at :
             {glm::dvec3(low.x, high.y, 0), glm::dvec3(high, 0), glm::dvec3(high.x, low.y, 0), glm::dvec3(low, 0)}) {
            const glm::dvec2 pixel = *camera.pixelFromWorld(at);
            corners += fmt::format("{}[{}, {}]", corners.empty() ? "" : ", ", pixel.x, pixel.y);
        }
        folder_.file("wanted.yaml", fmt::format("fantascope: wanted\nversion: 1\noutputs:\n  left: {{camera: [{0}]}}\n"
                                                "  right: {{camera: [{0}]}}\n",
                                                corners));
    }
    // The greatest distance, in projector pixels, between where a warp sends places of its part of
    // the canvas and where the projector has to put them.
    static double worst(const show::Output& output, glm::dvec2 low, glm::dvec2 high) {
        double worst = 0;
        const CanvasPart part = output.projection.warp.shape().part;
        for (int i = 0; i < 25; ++i) {
            const glm::dvec2 canvas = part.low + (part.high - part.low) * glm::dvec2(i % 5, i / 5) / 4.0;
            const glm::dvec3 wall(low.x + (high.x - low.x) * canvas.x, high.y - (high.y - low.y) * canvas.y, 0);
            worst = std::max(worst, glm::distance(output.projection.warp.projectorFromCanvas(canvas),
                                                  *projector(output).pixelFromWorld(wall)));
        }
        return worst;
    }

    const ScratchFolder folder_;
};

TEST_F(CalibrateCommand, puts_both_parts_of_a_canvas_where_they_are_wanted) {
    makeSite();
    const glm::dvec2 low(-2, 0.5), high(2, 2.5);
    want(low, high);
    const std::string before = text("site.yaml");
    const Outcome outcome = run({"--wanted", "wanted.yaml", "--write"});
    ASSERT_THAT(outcome, exits(0));
    for (const show::Output& output : site().outputs) EXPECT_LT(worst(output, low, high), 0.3) << output.name;
    EXPECT_THAT(text("site.yaml"), HasSubstr("# on the ladder"));
    EXPECT_EQ(text("site.yaml.previous"), before);

    EXPECT_NEAR(report()["latency_ms"].get<double>(), 120, 40);
    EXPECT_EQ(report()["repeated_frames"], 0);
    for (const auto& [name, gamma] : {std::pair("left", 2.4), {"right", 2.0}}) {
        const nlohmann::json output = report()["outputs"][name];
        EXPECT_LT(output["rms_px"], 0.3);
        EXPECT_EQ(output["rms_px"], output["keystone_rms_px"]);
        EXPECT_GT(output["points"], 200);
        EXPECT_EQ(output["written"], true);
        EXPECT_NEAR(output["gamma"].get<double>(), gamma, 0.05);
    }
}

// Without a wanted place: upright on the wall, in the light of both projectors, and no smaller than
// need be.
TEST_F(CalibrateCommand, finds_the_largest_upright_place_by_itself) {
    makeSite();
    ASSERT_THAT(run({"--write"}), exits(0));
    std::array<glm::dvec2, 4> wall;
    for (const show::Output& output : site().outputs) {
        const CanvasPart part = output.projection.warp.shape().part;
        double beyond = -1000;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec2 corner = rectangleCorners(1, 1)[i];
            const glm::dvec2 pixel = output.projection.warp.projectorFromCanvas(part.low + (part.high - part.low) * corner);
            beyond = std::max({beyond, -pixel.x, -pixel.y, pixel.x - 640, pixel.y - 360});
            const auto hit =
                vision::Plane{}.hitBy(projector(output).rayThrough(output.projection.warp.projectorFromCanvas(corner)));
            ASSERT_TRUE(hit);
            if (output.name == "left") wall[i] = *hit;
            EXPECT_LT(glm::distance(wall[i], glm::dvec2(*hit)), 0.02) << "both have the same canvas";
        }
        EXPECT_LT(beyond, 1) << output.name;
    }
    EXPECT_NEAR(wall[0].y, wall[1].y, 0.02);
    EXPECT_NEAR(wall[3].y, wall[2].y, 0.02);
    EXPECT_NEAR(wall[0].x, wall[3].x, 0.02);
    EXPECT_NEAR(wall[1].x, wall[2].x, 0.02);
    EXPECT_GT(wall[0].y - wall[3].y, 1.6) << "a projector's light is two metres high there";
}

TEST_F(CalibrateCommand, goes_back_to_what_was_and_forth_again) {
    makeSite();
    EXPECT_THAT(run({"--undo"}), refuses(HasSubstr("nothing to go back to")));
    const std::string now = text("site.yaml"), before = now + "# as a person left it\n";
    folder_.file("site.yaml.previous", before);
    EXPECT_THAT(run({"--undo"}), exits(0));
    EXPECT_EQ(text("site.yaml"), before);
    EXPECT_EQ(text("site.yaml.previous"), now);
    EXPECT_THAT(run({"--undo"}), exits(0));
    EXPECT_EQ(text("site.yaml"), now);

    folder_.file("site.yaml.previous", "fantascope: site\nversion: 1\noutputs: []\n");
    EXPECT_THAT(run({"--undo"}), refuses(HasSubstr("site.yaml.previous:3")));
    EXPECT_EQ(text("site.yaml"), now);
}

// What the camera saw lies beside the site file, and goes back with it.
TEST_F(CalibrateCommand, keeps_what_it_saw) {
    makeSite();
    want({-2, 0.5}, {2, 2.5});
    ASSERT_THAT(run({"--wanted", "wanted.yaml", "--write"}), exits(0));
    const Survey both = **readSurvey(site());
    ASSERT_THAT(both.unfit, testing::IsEmpty());
    for (const show::Output& output : site().outputs) {
        const OutputSurvey& seen = both.outputs.at(output.name);
        EXPECT_EQ(seen.projector, output.size());
        EXPECT_NEAR(seen.gamma, report()["outputs"][output.name]["gamma"].get<double>(), 1e-9);
        EXPECT_GT(seen.map.known, 2000u);
        EXPECT_NEAR(1000 * seconds(seen.latency), report()["latency_ms"].get<double>(), 1e-3);
        EXPECT_GT(seen.dark.at(160, 120), 0) << "the night is not black";
    }
    EXPECT_THAT(runProgram({"check", "site.yaml"}, folder_ / ".").out,
                HasSubstr("ok site.survey/survey.yaml: survey, 2 outputs"));
    want({-1.9, 0.6}, {1.9, 2.5});
    const Outcome left = run({"left", "--wanted", "wanted.yaml", "--write", "--seed", "2"});
    ASSERT_THAT(left, exits(0));
    EXPECT_THAT(left.out, HasSubstr("its white is not matched: other outputs of its canvas were not measured with it"));
    const Survey again = **readSurvey(site());
    EXPECT_EQ(again.outputs.at("right").map.light, both.outputs.at("right").map.light);
    EXPECT_NE(again.outputs.at("left").map.light, both.outputs.at("left").map.light);
    ASSERT_THAT(run({"--undo"}), exits(0));
    EXPECT_EQ((*readSurvey(site()))->outputs.at("left").map.light, both.outputs.at("left").map.light);
}

TEST_F(CalibrateCommand, writes_nothing_unless_asked) {
    makeSite();
    want({-2, 0.5}, {2, 2.5});
    const std::string before = text("site.yaml");
    ASSERT_THAT(run({"right", "--wanted", "wanted.yaml"}), exits(0));
    EXPECT_EQ(text("site.yaml"), before);
    EXPECT_FALSE(*readSurvey(site()));
    EXPECT_EQ(report()["outputs"].size(), 1u);
    EXPECT_EQ(report()["outputs"]["right"]["written"], false);
}

TEST_F(CalibrateCommand, the_same_seed_is_the_same_to_the_byte) {
    makeSite();
    want({-2, 0.5}, {2, 2.5});
    std::vector<std::string> reports;
    for (const char* seed : {"3", "3", "4"}) {
        ASSERT_THAT(run({"left", "--wanted", "wanted.yaml", "--seed", seed}), exits(0));
        reports.push_back(text("r.json"));
    }
    EXPECT_EQ(reports[0], reports[1]);
    EXPECT_NE(reports[0], reports[2]);
}

// Each refusal says what to do, and leaves the site as it was.
TEST_F(CalibrateCommand, tells_troubles_apart) {
    makeSite(2);
    const std::string before = text("site.yaml");
    EXPECT_THAT(run({"left", "right", "--write"}), refuses(HasSubstr("not calibrated: left, right")));
    EXPECT_THAT(report()["outputs"]["left"]["trouble"].get<std::string>(), HasSubstr("lower the camera's exposure"));
    EXPECT_EQ(text("site.yaml"), before);

    makeSite(150, "  faults: [{kind: unplug, device: camera, at: 0}]\n");
    EXPECT_THAT(run({}), refuses(AllOf(HasSubstr("the camera gave 0 pictures"), HasSubstr("plug it in"))));
    makeSite(150, "  faults: [{kind: freeze, device: camera, at: 0}]\n");
    EXPECT_THAT(run({}), refuses(HasSubstr("the camera repeats one picture")));
    makeSite(150, "  faults: [{kind: unplug, device: camera, at: 14}]\n");
    EXPECT_THAT(run({"--write"}), refuses(HasSubstr("not calibrated")));
    makeSite(150, "  faults: [{kind: unplug, device: right, at: 0}]\n");
    EXPECT_THAT(run({"--write"}), refuses(HasSubstr("not calibrated")));
    EXPECT_THAT(report()["outputs"]["right"]["trouble"].get<std::string>(), HasSubstr("plug it in"));
    makeSite(20000);
    EXPECT_THAT(run({}), refuses(HasSubstr("raise its exposure")));
    EXPECT_THAT(run({"midle"}), refuses(HasSubstr("no output 'midle'")));
    folder_.file("wanted.yaml", "fantascope: wanted\nversion: 1\noutputs: {left: {camera: [[0, 0], [9, 0], [0, 9], [9, 9]]}}\n");
    EXPECT_THAT(run({"--wanted", "wanted.yaml"}), refuses(HasSubstr("wanted.yaml:3")));
}

}  // namespace
}  // namespace fantascope::app
