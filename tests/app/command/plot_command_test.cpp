#include "theatre/stage/cast.h"

#include "core/file.h"
#include "media/image.h"
#include "program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace fantascope {
namespace {

using testing::HasSubstr;

// A folder with a small pattern, its drawing and the report of its search.
class PlotCommand : public testing::Test {
protected:
    PlotCommand() {
        GreyImage guide(64, 36);
        for (int y = 8; y < 28; ++y)
            for (int x = 8; x < 40; ++x) guide.at(x, y) = 1;
        EXPECT_TRUE(writePng(folder_ / "guide.png", guide));
        EXPECT_EQ(
            run({"pattern", "guide.png", "-o", "p.pattern.yaml", "--instances", "40", "--iterations", "3", "--report", "p.json"})
                .status,
            0);
    }
    Outcome run(const std::vector<std::string>& arguments) const { return runProgram(arguments, folder_ / "."); }
    int width(const std::string& picture) const { return readRgba(folder_ / picture).value().width(); }

    const ScratchFolder folder_;
};

TEST_F(PlotCommand, draws_a_pattern_or_a_report_by_what_it_is) {
    for (const char* figure : {"difference", "trajectories", "spectrum"})
        EXPECT_THAT(run({"plot", "p.pattern.yaml", "--figure", figure, "-o", std::string(figure) + ".png"}), exits(0)) << figure;
    EXPECT_THAT(run({"plot", "p.json", "--figure", "search", "-o", "search.png"}), exits(0));
    EXPECT_THAT(run({"plot", "p.pattern.yaml", "-o", "pattern.png"}), exits(0));
    EXPECT_THAT(run({"plot", "p.json", "-o", "report.svg"}), exits(0));
    EXPECT_EQ(readFile(folder_ / "pattern.png").value(), readFile(folder_ / "difference.png").value());
    EXPECT_NE(readFile(folder_ / "trajectories.png").value(), readFile(folder_ / "spectrum.png").value());
    EXPECT_GT(width("search.png"), 500);
    EXPECT_THAT(readFile(folder_ / "report.svg").value(), HasSubstr("<svg"));
}

// Two people in T-poses, the first as in the first frame, the second raised in the second one.
theatre::Cast aCast(const std::filesystem::path& target) {
    theatre::Cast cast{{{target, 1.8}}, {}, {}, 10, 1, {}};
    for (const double x : {-0.6, 0.6}) {
        const theatre::Body body = theatre::humanBody(1.7);
        const glm::dvec3 root(x, body.joints[0].offset.y, 1.5);
        cast.actors.push_back({1.7, {}});
        for (const double height : {0.0, x > 0 ? 0.3 : 0.0})
            cast.actors.back().poses.push_back(
                theatre::poseOf(body, body.restPose(root + glm::dvec3(0, height, 0), {1, 0, 0, 0})));
    }
    return cast;
}

TEST_F(PlotCommand, draws_a_cast) {
    ASSERT_TRUE(theatre::writeCast(folder_ / "c.cast.yaml", aCast(folder_ / "guide.png")));
    for (const char* figure : {"stage", "side", "shadow", "actors"})
        EXPECT_THAT(run({"plot", "c.cast.yaml", "--figure", figure, "-o", std::string(figure) + ".png"}), exits(0)) << figure;
    EXPECT_THAT(run({"plot", "c.cast.yaml", "-o", "cast.png"}), exits(0));
    const auto height = [&](const std::string& picture) { return readRgba(folder_ / picture).value().height(); };
    EXPECT_EQ(height("cast.png"), height("stage.png") + height("shadow.png") + height("actors.png"));
    EXPECT_NE(readFile(folder_ / "stage.png").value(), readFile(folder_ / "side.png").value());
    EXPECT_THAT(run({"plot", "c.cast.yaml", "--frame", "1", "-o", "second.png"}), exits(0));
    EXPECT_NE(readFile(folder_ / "second.png").value(), readFile(folder_ / "cast.png").value());
    EXPECT_THAT(run({"plot", "c.cast.yaml", "--frame", "2", "-o", "x.png"}).errors,
                HasSubstr("--frame 2 is beyond the last frame, 1"));
    EXPECT_THAT(run({"plot", "c.cast.yaml", "--figure", "search", "-o", "x.png"}).errors, HasSubstr("needs the report"));
    EXPECT_THAT(run({"plot", "p.pattern.yaml", "--figure", "stage", "-o", "x.png"}).errors, HasSubstr("needs a cast"));
}

TEST_F(PlotCommand, draws_the_report_of_a_run) {
    const std::string cues = R"("seconds": 10, "frames": 300, "late_frames": 0, "cues": [{"name": "Full", "entered": 1}])";
    const std::string scores = R"("z_camera": {"left": [[1, 0.1], [2, null], [3, 0.1]]}, "tone_camera": {"left": []})";
    const std::string watch = R"("watch": {"left": [{"at": 1, "drift_px": null, "sigma_px": null, "moved_px": 0},
                                                    {"at": 2, "drift_px": 3, "sigma_px": null, "moved_px": 0}]})";
    const std::string causes = R"("causes": [{"output": "left", "from": 2, "to": null, "cause": "out of place"}])";
    const std::string faults = R"("faults": [{"at": 3, "what": "unplugged", "device": "camera"}])";
    EXPECT_TRUE(writeFile(folder_ / "r.json", fmt::format("{{{}, {}, {}, {}, {}}}", cues, scores, watch, causes, faults)));
    EXPECT_TRUE(writeFile(folder_ / "blind.json", fmt::format("{{{}, {}}}", cues, faults)));
    EXPECT_THAT(run({"plot", "r.json", "-o", "r.png"}), exits(0));
    EXPECT_THAT(run({"plot", "r.json", "--figure", "night", "-o", "night.png"}), exits(0));
    EXPECT_THAT(run({"plot", "blind.json", "-o", "blind.png"}), exits(0));
    const std::string shadows = R"("iou_camera": {"left": [[1, 0.9], [2, 0.8]], "right": []})";
    EXPECT_TRUE(writeFile(folder_ / "shadows.json", fmt::format("{{{}, {}, {}}}", cues, faults, shadows)));
    EXPECT_THAT(run({"plot", "shadows.json", "-o", "shadows.png"}), exits(0));
    const std::string lamps = R"("lamps": [{"at": 1, "excess": 0, "ambient": 0, "share": 1, "relays_off": 0},
                                           {"at": 2, "excess": null, "ambient": 0.1, "share": 0.5, "relays_off": 1},
                                           {"at": 3, "excess": 0.02, "ambient": 0.1, "share": 0.5, "relays_off": 0}])";
    const std::string patterns = R"("patterns": [{"source": "drawing", "at": 4, "applied": true},
                                                 {"source": "other", "at": 5, "applied": false}])";
    EXPECT_TRUE(writeFile(folder_ / "done.json", fmt::format("{{{}, {}, {}, {}}}", cues, faults, lamps, patterns)));
    EXPECT_THAT(run({"plot", "done.json", "-o", "done.png"}), exits(0));
    EXPECT_EQ(readFile(folder_ / "r.png").value(), readFile(folder_ / "night.png").value());
    const auto height = [&](const std::string& picture) { return readRgba(folder_ / picture).value().height(); };
    EXPECT_GT(height("r.png"), height("blind.png") + 300) << "z and drift, but no tone";
    EXPECT_GT(height("shadows.png"), height("blind.png") + 150) << "the IoU alone";
    EXPECT_EQ(height("done.png"), height("blind.png") + 2 * (170 + 26 + 8) + 2 * 32) << "light, lamps, and two actions";

    EXPECT_THAT(
        run({"plot", "r.json", "--figure", "search", "-o", "x.png"}).errors,
        HasSubstr("r.json: is the report of a run, whose figures are: night; --figure search needs the report of a search, "
                  "made by 'fantascope pattern' with --report"));
    EXPECT_THAT(run({"plot", "p.json", "--figure", "night", "-o", "x.png"}).errors,
                HasSubstr("--figure night needs the report of a run"));
    EXPECT_TRUE(writeFile(folder_ / "damaged.json", R"({"cues": [], "faults": [{"at": "late", "what": "unplugged"}]})"));
    EXPECT_THAT(run({"plot", "damaged.json", "-o", "x.png"}).errors,
                HasSubstr("damaged.json: is damaged, or is not the report of a run"));
}

// What the figure shows is for GuideComparison's and WallFigure's tests; tests/e2e draws a
// rehearsal.
TEST_F(PlotCommand, says_what_it_needs_to_compare_a_camera_picture) {
    const std::string site = sourceFolder() + "/config/simulated";
    EXPECT_TRUE(writePng(folder_ / "dark.png", RgbaImage(480, 270)));
    EXPECT_TRUE(writePng(folder_ / "small.png", RgbaImage(48, 27)));
    const auto refusal = [&](std::vector<std::string> more) {
        more.insert(more.begin(), "plot");
        more.insert(more.end(), {"-o", "x.png"});
        return run(more).errors;
    };
    EXPECT_THAT(refusal({"dark.png"}), HasSubstr("--site SITE --output NAME --guide"));
    EXPECT_THAT(refusal({"dark.png", "--site", site, "--output", "left", "--guide", "p.pattern.yaml"}),
                HasSubstr("dark.png: shows nothing of 'left' that could be compared"));
    EXPECT_THAT(refusal({"dark.png", "--site", site, "--output", "left", "--guide", "guide.png"}),
                HasSubstr("dark.png: shows nothing"));
    EXPECT_THAT(refusal({"small.png", "--site", site, "--output", "left", "--guide", "guide.png"}),
                HasSubstr("small.png: has 48 x 27 pixels, but the camera of"));
    EXPECT_THAT(refusal({"dark.png", "--site", site, "--output", "lefd", "--guide", "guide.png"}),
                HasSubstr("did you mean 'left'"));
    EXPECT_THAT(refusal({"p.json", "--site", site}), HasSubstr("--before are for a picture of the site's camera"));
    EXPECT_THAT(refusal({"p.json", "--figure", "wall"}), HasSubstr("--figure wall needs a picture of the site's camera"));
}

TEST_F(PlotCommand, says_what_it_cannot_draw) {
    EXPECT_TRUE(writeFile(folder_ / "damaged.json", "{\"history\": 3}"));
    EXPECT_THAT(run({"plot", "damaged.json", "-o", "x.png"}).errors,
                HasSubstr("damaged.json: is damaged, or is not the report of a search"));
    EXPECT_TRUE(writeFile(folder_ / "other.json", "{\"rms_px\": 3}"));
    EXPECT_TRUE(writeFile(folder_ / "broken.json", "{"));
    for (const char* file : {"other.json", "broken.json"}) {
        const Outcome refused = run({"plot", file, "-o", "x.png"});
        EXPECT_THAT(refused, exits(1));
        EXPECT_THAT(refused.errors,
                    HasSubstr(std::string(file) + ": plot draws reports of searches ('fantascope pattern' with --report"));
    }
    EXPECT_THAT(run({"plot", "p.json", "--figure", "spectrum", "-o", "x.png"}).errors, HasSubstr("needs a pattern"));
    EXPECT_THAT(run({"plot", "p.pattern.yaml", "--figure", "search", "-o", "x.png"}).errors, HasSubstr("needs the report"));
    EXPECT_THAT(run({"plot", "absent.pattern.yaml", "-o", "x.png"}).errors, HasSubstr("absent.pattern.yaml"));
    EXPECT_THAT(run({"plot", "p.pattern.yaml", "-o", "x.jpg"}), exits(2));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "x.png"));
}

}  // namespace
}  // namespace fantascope
