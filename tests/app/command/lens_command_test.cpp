// Measures lenses as a person does: from recorded pictures, and with a simulated camera.

#include "app/lens/lens_file.h"
#include "app/site/site_file.h"
#include "app/site/site_models.h"

#include "vision/board_pictures.h"

#include "core/file.h"
#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <numbers>

namespace fantascope::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using vision::BoardCamera;
using vision::BoardPose;
using vision::CameraModel;
using Arguments = std::vector<std::string>;

MATCHER_P(refuses, message, "") { return arg.status == 1 && ExplainMatchResult(message, arg.errors, result_listener); }

constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs: [{name: a, display: {driver: headless}, size: [64, 64], refresh_rate: 30, projector: {position: [0, 0, 5], look_at: [0, 0, 0], throw_ratio: 1}}]
camera:
  device: {driver: simulated}
  size: [480, 360]
  field_of_view: 52   # from its leaflet
  position: [0, 0, 5]
  look_at: [0, 0, 0]
  k1: -0.12
  k2: 0.02
simulation:
  objects: [{name: wall, rectangle: {corner: [-2, -2, 0], right: [4, 0, 0], up: [0, 4, 0]}}]
  camera: {read_noise: 0.004, blur: 0.5}
)";

class LensCommand : public testing::Test {
protected:
    LensCommand() { folder_.file("site.yaml", kSite); }
    Outcome run(Arguments arguments) const {
        arguments.insert(arguments.begin(), "lens");
        return runProgram(arguments, folder_ / ".", {{"XDG_DATA_HOME", (folder_ / "data").string()}});
    }
    std::string text(const std::string& file) const { return readFile(folder_ / file).value(); }
    nlohmann::json report() const { return nlohmann::json::parse(text("r.json")); }
    void save(const std::string& name, const RgbaImage& picture) const {
        ASSERT_TRUE(writePng(folder_ / "pictures" / name, picture));
    }
    void savePoses(const BoardCamera& camera, const std::vector<BoardPose>& poses) {
        for (std::size_t i = 0; i < poses.size(); ++i) save(fmt::format("{:02}.png", i), camera.picture(poses[i], rng_));
    }

    const CameraModel truth_ = *CameraModel::fromFieldOfView(Pose(), {480, 360}, 70 * std::numbers::pi / 180, -0.15, 0.03);
    Rng rng_{9};
    const ScratchFolder folder_;
};

TEST_F(LensCommand, finds_the_lens_of_recorded_pictures_and_writes_it) {
    const BoardCamera camera(truth_);
    savePoses(camera, camera.poses(20, rng_));
    save("no-board.png", RgbaImage(480, 360, {90, 90, 90, 255}));
    folder_.file("pictures/readme.txt", "taken on the roof");
    const Outcome outcome = run({".", "--pictures", "pictures", "--report", "r.json", "--write"});
    ASSERT_THAT(outcome, exits(0));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("no board in 1 other"), HasSubstr("field of view "), HasSubstr("not kept")));
    const CameraModel found = cameraOf(readSite(folder_ / "site.yaml").value()).value();
    EXPECT_NEAR(found.fieldOfView(), truth_.fieldOfView(), 0.005);
    EXPECT_NEAR(found.k1, truth_.k1, 0.01);
    EXPECT_LT(glm::distance(found.centre, truth_.centre), 2);
    EXPECT_THAT(text("site.yaml"), HasSubstr("# from its leaflet"));
    EXPECT_EQ(text("site.yaml.previous"), kSite);
    EXPECT_NEAR(report()["field_of_view"].get<double>(), 70, 0.3);
    EXPECT_EQ(report()["written"], true);
    EXPECT_LT(report()["rms_px"], 0.2);

    ASSERT_THAT(run({".", "--undo"}), exits(0));
    EXPECT_EQ(text("site.yaml"), kSite);
    // A site is not needed to look at pictures, and without --write nothing is written.
    ASSERT_THAT(run({"--pictures", "pictures"}), exits(0));
    ASSERT_THAT(run({".", "--pictures", "pictures"}), exits(0));
    EXPECT_EQ(text("site.yaml"), kSite);
}

TEST_F(LensCommand, tells_bad_pictures_apart) {
    const auto refused = [&](const std::string& message, const Arguments& more = {}) {
        Arguments arguments = {".", "--pictures", "pictures", "--write"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_THAT(run(arguments), refuses(HasSubstr(message)));
        EXPECT_EQ(text("site.yaml"), kSite);
    };
    refused("pictures: No such file");
    std::filesystem::create_directory(folder_ / "pictures");
    refused("there is no picture");
    for (int i = 0; i < 4; ++i) save(fmt::format("b{}.png", i), RgbaImage(480, 360));
    refused("the pictures are black; light the board");
    for (int i = 0; i < 4; ++i) save(fmt::format("b{}.png", i), RgbaImage(480, 360, {255, 255, 255, 255}));
    refused("the pictures are white; lower the exposure");
    for (int i = 0; i < 4; ++i) save(fmt::format("b{}.png", i), RgbaImage(480, 360, {90, 80, 90, 255}));
    refused("no board was found; print one");
    const BoardCamera camera(truth_);
    std::vector<BoardPose> poses = camera.poses(12, rng_);
    save("b0.png", camera.picture(poses[0], rng_));
    refused("in 1 picture only");
    for (int i = 0; i < 4; ++i) save(fmt::format("b{}.png", i), camera.picture(poses[std::size_t(i)], rng_));
    EXPECT_THAT(run({".", "--pictures", "pictures"}).out, HasSubstr("only 4 views fit together"));
    refused("not good enough");
    for (BoardPose& pose : poses) pose.turn = {0, 0, 0};
    savePoses(camera, poses);
    for (int i = 0; i < 4; ++i) std::filesystem::remove(folder_ / fmt::format("pictures/b{}.png", i));
    EXPECT_THAT(run({".", "--pictures", "pictures"}).out, HasSubstr("all views are alike"));
    refused("not good enough");
    save("x.png", RgbaImage(640, 360));
    refused("x.png has 640 x 360 pixels, the site file says 480 x 360");
    EXPECT_THAT(run({"--pictures", "pictures"}), refuses(HasSubstr("00.png has 480 x 360")));
    folder_.file("pictures/00.png", "\x89PNG");
    refused("00.png");
}

// The whole way, with a camera: measured, written, kept, and taken at another site.
TEST_F(LensCommand, measures_a_camera_and_keeps_its_lens_for_another_site) {
    const Outcome outcome = run({".", "--simulate", "--write", "--report", "r.json"});
    ASSERT_THAT(outcome, exits(0));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("written to"), HasSubstr("kept for other sites in"), HasSubstr("no serial number")));
    EXPECT_NEAR(report()["field_of_view"].get<double>(), 52, 0.3);
    EXPECT_NEAR(report()["k1"].get<double>(), -0.12, 0.02);
    EXPECT_THAT(text("site.yaml"), HasSubstr("lens_of: simulated"));
    ASSERT_TRUE(readLens(folder_ / "data/fantascope/lenses/simulated-480x360.lens.yaml"));

    folder_.file("other/site.yaml", kSite);
    ASSERT_THAT(run({"other", "--simulate", "--kept"}), exits(0));
    EXPECT_EQ(text("other/site.yaml"), kSite);
    ASSERT_THAT(run({"other", "--simulate", "--kept", "--write"}), exits(0));
    const auto camera = [&](const char* folder) { return cameraOf(readSite(folder_ / folder).value()).value(); };
    EXPECT_EQ(camera("other").focal, camera(".").focal);
    EXPECT_EQ(camera("other").centre, camera(".").centre);

    std::filesystem::remove_all(folder_ / "data");
    EXPECT_THAT(run({"other", "--simulate", "--kept"}), refuses(HasSubstr("no lens is kept for 'simulated' at 480 x 360")));
}

TEST_F(LensCommand, the_same_seed_is_the_same_to_the_byte) {
    std::vector<std::string> reports;
    for (const char* seed : {"3", "3", "4"}) {
        ASSERT_THAT(run({".", "--simulate", "--seed", seed, "--report", "r.json"}), exits(0));
        reports.push_back(text("r.json"));
    }
    EXPECT_EQ(reports[0], reports[1]);
    EXPECT_NE(reports[0], reports[2]);
}

TEST_F(LensCommand, makes_the_board_and_refuses_what_it_cannot_make) {
    EXPECT_THAT(run({"--board", "b.pdf"}), exits(0));
    EXPECT_THAT(text("b.pdf"), testing::StartsWith("%PDF"));
    EXPECT_THAT(run({"--board", "b.png", "--size", "800", "600"}), exits(0));
    EXPECT_EQ(*pictureSize(folder_ / "b.png"), glm::ivec2(800, 600));
    EXPECT_THAT(run({"--board", "b.png", "--size", "80", "60"}), refuses(HasSubstr("too small")));
    EXPECT_THAT(run({"--board", "b.jpg"}), refuses(HasSubstr("must end in .pdf, .svg or .png")));
    EXPECT_THAT(run({}), refuses(HasSubstr("a site is needed")));
    EXPECT_THAT(run({".", "--light", "--simulate"}), refuses(HasSubstr("stores sRGB")));
    folder_.file("site.yaml", std::string(kSite.substr(0, kSite.find("camera:"))));
    EXPECT_THAT(run({"."}), refuses(HasSubstr("there is no camera")));
}

}  // namespace
}  // namespace fantascope::app
