#include "app/site/site_models.h"

#include "app/site/site_file.h"

#include "core/file.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sstream>
#include <string>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

constexpr double kUnknown = 0;

// A site of one canvas, 640 x 360 px an output.
std::string siteOf(const std::vector<std::string>& outputs) {
    std::string text = "fantascope: site\nversion: 1\noutputs:\n";
    for (std::size_t i = 0; i < outputs.size(); ++i)
        text += fmt::format(
            "  - {{name: o{}, canvas: wall, display: {{driver: headless}}, size: [640, 360], refresh_rate: 30, {}}}\n", i,
            outputs[i]);
    return text;
}

const std::string kStraight = "corners: [[0, 0], [640, 0], [640, 360], [0, 360]]",
                  kKeystoned = "corners: [[123, 48], [545, 45], [538, 325], [128, 283]]";

class CanvasAspect : public testing::Test {
protected:
    Result<show::Site> read(const std::string& text) { return readSite(folder_.file("site.yaml", text)); }
    double of(const std::vector<std::string>& outputs) {
        const auto site = read(siteOf(outputs));
        EXPECT_TRUE(site) << site.error().message();
        return site ? site->outputs[0].projection.canvasAspect : -1;
    }
    const ScratchFolder folder_;
};

// Example failure: without the projectors' places, the default site's 16:9 pictures count as 1.62 :
// 1, get bars, and circles are flattened.
TEST_F(CanvasAspect, is_unknown_where_keystoned_corners_are_all_that_is_known) {
    EXPECT_EQ(of({kKeystoned}), kUnknown);
    EXPECT_EQ(of({kStraight, kKeystoned}), kUnknown);
    const std::string file = readFile(sourceFolder() + "/config/simulated/site.yaml").value();
    const std::string site = file.substr(0, file.find("\nsimulation:") + 1);
    std::string placeless;
    std::istringstream lines(site);
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with("    projector:") && !line.starts_with("    surface:")) placeless += line + "\n";
    const auto whole = read(site), without = read(placeless);
    ASSERT_TRUE(whole && without);
    EXPECT_NEAR(whole->outputs[0].projection.canvasAspect, 16.0 / 9, 0.02);
    EXPECT_EQ(without->outputs[0].projection.canvasAspect, kUnknown);
}

TEST_F(CanvasAspect, is_that_of_the_pixels_where_the_corners_form_a_rectangle) {
    EXPECT_NEAR(of({kStraight}), 640.0 / 360, 1e-9);
    EXPECT_NEAR(of({"corners: [[3, 2], [637, 0], [639, 358], [1, 360]]"}), 640.0 / 360, 0.02) << "set by hand";
    EXPECT_NEAR(of({"corners: [[100, 0], [460, 0], [460, 360], [100, 360]]"}), 1, 1e-9);
    EXPECT_NEAR(of({kStraight + ", part: [0, 0, 0.5, 1]", kStraight + ", part: [0.5, 0, 1, 1]"}), 2 * 640.0 / 360, 1e-9);
    EXPECT_EQ(of({"corners: [[100, 0], [640, 0], [540, 360], [0, 360]]"}), kUnknown) << "a parallelogram";
}

TEST_F(CanvasAspect, is_as_somebody_measured_it) {
    EXPECT_EQ(of({kKeystoned + ", canvas_size: [3, 2]"}), 1.5);
    EXPECT_EQ(of({kStraight, kKeystoned + ", canvas_size: [3, 2]"}), 1.5) << "one output tells it for its canvas";
    EXPECT_EQ(of({kStraight + ", canvas_size: [3, 2]", kKeystoned + ", canvas_size: [3, 2]"}), 1.5);
}

TEST_F(CanvasAspect, is_refused_where_two_outputs_measure_it_differently) {
    const auto site = read(siteOf({kStraight + ", canvas_size: [3, 2]", kStraight + ", canvas_size: [3, 2.5]"}));
    ASSERT_FALSE(site);
    EXPECT_THAT(site.error().message(),
                HasSubstr("site.yaml:5:5: outputs[1]: output 'o0' gives the canvas 'wall' another 'canvas_size'"));
}

}  // namespace
}  // namespace fantascope::app
