// Two projectors side by side on one canvas, whose surveys are known exactly.

#include "app/site/light_correction.h"

#include "app/site/site_file.h"
#include "app/site/site_models.h"
#include "app/site/survey_file.h"

#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr glm::ivec2 kCamera{200, 100}, kProjector{320, 180};
constexpr double kLeftEnds = 0.6, kRightBegins = 0.4;  // in canvas widths

// The wall's reflectance at a place of the canvas.
double wall(glm::dvec2 canvas) { return 0.35 + 0.25 * std::sin(9 * canvas.x) * std::cos(7 * canvas.y); }

class LightOfASite : public testing::Test {
protected:
    show::Site site(const std::string& light, const std::string& more = "") {
        std::string text = "fantascope: site\nversion: 1\noutputs:\n";
        for (const auto& [name, part] : {std::pair("left", "[0, 0, 0.6, 1]"), {"right", "[0.4, 0, 1, 1]"}})
            text += fmt::format(
                "  - {{name: {}, canvas: wall, part: {}, display: {{driver: headless}}, size: [320, 180], refresh_rate: 30{}}}\n",
                name, part, more);
        text += fmt::format(
            "camera: {{device: {{driver: simulated}}, size: [200, 100], field_of_view: 60, position: [0, 2, 5], look_at: [0, 0, "
            "0]}}\ncorrections: {{light: {{{}}}}}\n",
            light);
        return readSite(folder_.file("site.yaml", text)).value();
    }
    // A camera that sees exactly the canvas.
    static OutputSurvey surveyOf(const show::Site& site, std::size_t output) {
        const bool isLeft = output == 0;
        OutputSurvey survey{{Image<glm::vec2>(kCamera.x, kCamera.y, glm::vec2(NAN)), GreyImage(kCamera.x, kCamera.y)},
                            GreyImage(kCamera.x, kCamera.y),
                            kProjector,
                            2.2,
                            Time{},
                            site.outputs[output].projection.warp.shape()};
        for (int y = 0; y < kCamera.y; ++y)
            for (int x = 0; x < kCamera.x; ++x) {
                const glm::dvec2 canvas = (glm::dvec2(x, y) + 0.5) / glm::dvec2(kCamera);
                if (isLeft ? canvas.x >= kLeftEnds : canvas.x <= kRightBegins) continue;
                const double across = (isLeft ? canvas.x : canvas.x - kRightBegins) / kLeftEnds;
                survey.map.at.at(x, y) = glm::vec2(glm::dvec2(across, canvas.y) * glm::dvec2(kProjector));
                survey.map.light.at(x, y) = static_cast<float>((isLeft ? 0.8 : 0.6) * wall(canvas));
                ++survey.map.lit, ++survey.map.known;
            }
        return survey;
    }
    void keep(const show::Site& site, bool both = true) {
        std::map<std::string, OutputSurvey> surveys{{"left", surveyOf(site, 0)}};
        if (both) surveys["right"] = surveyOf(site, 1);
        ASSERT_TRUE(writeSurvey(site, surveys));
    }
    // The light of a white canvas along a row through its middle.
    static std::vector<double> lightAcross(const show::Site& site, const std::vector<LightCorrection>& corrections) {
        const std::array blends = {blendOf(site, 0), blendOf(site, 1)};
        std::vector<double> light;
        for (double x = 0.02; x < 0.98; x += 0.01) {
            double sum = 0;
            for (const std::size_t output : {0u, 1u}) {
                const Projection& projection = site.outputs[output].projection;
                const glm::dvec2 pixel = projection.warp.projectorFromCanvas({x, 0.5});
                if (pixel.x < 0 || pixel.x >= kProjector.x) continue;
                const glm::ivec2 at(pixel);
                const auto gain = gainOf(corrections, output);
                sum += (output == 0 ? 0.8 : 0.6) * wall({x, 0.5}) * blends[output]->at(at.x, at.y).x *
                       (gain ? gain->at(at.x, at.y) : 1);
            }
            light.push_back(sum);
        }
        return light;
    }
    static double contrast(const std::vector<double>& light) {
        const auto [least, most] = std::ranges::minmax(light);
        return most / least;
    }
    const ScratchFolder folder_;
};

TEST_F(LightOfASite, is_even_across_both_outputs_and_their_overlap) {
    const show::Site here = site("mode: automatic, least: 0.1, clipped: 0");
    keep(here);
    const auto corrections = lightCorrectionsOf(here);
    ASSERT_THAT(corrections, SizeIs(1));
    EXPECT_EQ(corrections[0].canvas, "wall");
    EXPECT_EQ(corrections[0].trouble, "");
    EXPECT_GT(contrast(lightAcross(here, {})), 3);
    EXPECT_LT(contrast(lightAcross(here, corrections)), 1.15);
    EXPECT_THAT(gainsToApply(here, corrections), SizeIs(2));
    EXPECT_NE(gainsToApply(here, corrections)[1], nullptr);
}

TEST_F(LightOfASite, is_judged_beneath_a_mask_too) {
    const show::Site bare = site("mode: automatic"),
                     masked = site("mode: automatic", ", masks: [{polygon: [[0, 0], [90, 0], [90, 180], [0, 180]]}]");
    keep(bare);
    const auto with = lightCorrectionsOf(masked), without = lightCorrectionsOf(bare);
    EXPECT_EQ(*gainOf(with, 0), *gainOf(without, 0));
}

TEST_F(LightOfASite, is_only_advised_where_the_site_file_says_so) {
    const show::Site advised = site("mode: advise");
    EXPECT_THAT(lightCorrectionsOf(advised), IsEmpty()) << "without a survey there is nothing to say";
    keep(advised);
    const auto corrections = lightCorrectionsOf(advised);
    ASSERT_THAT(corrections, SizeIs(1));
    EXPECT_EQ(gainsToApply(advised, corrections)[0], nullptr);
    EXPECT_FALSE(lightNewsOf(advised, corrections)[0].applied);
    EXPECT_LT(lightNewsOf(advised, corrections)[0].kept, 0.95);
    EXPECT_THAT(lightCorrectionsOf(site("mode: off")), IsEmpty());
}

TEST_F(LightOfASite, is_of_the_whole_canvas_or_not_corrected_at_all) {
    const show::Site here = site("mode: automatic");
    EXPECT_THAT(lightCorrectionsOf(here)[0].trouble, HasSubstr("there is no survey"));
    keep(here, false);
    const auto corrections = lightCorrectionsOf(here);
    EXPECT_THAT(corrections[0].trouble, HasSubstr("output 'right': it was not surveyed"));
    EXPECT_EQ(gainOf(corrections, 0), nullptr);
    EXPECT_THAT(canvasSurface(here, 0, 2, Fit::Contain, {64, 32}).error().message(), HasSubstr("output 'right'"));
}

// A picture that fills the canvas.
TEST_F(LightOfASite, is_what_the_search_for_a_pattern_gets) {
    const show::Site here = site("mode: off");
    keep(here);
    const double aspect = here.outputs[0].projection.canvasAspect;
    const GreyImage surface = canvasSurface(here, 1, aspect, Fit::Contain, {64, 32}).value().light();
    for (const glm::ivec2 at : {glm::ivec2(8, 10), {20, 16}, {50, 5}, {60, 28}}) {
        const glm::dvec2 canvas = (glm::dvec2(at) + 0.5) / glm::dvec2(64, 32);
        const double full = canvas.x < kRightBegins ? 0.8 : 0.6;
        EXPECT_NEAR(surface.at(at.x, at.y), full * wall(canvas), 0.02) << canvas.x << ", " << canvas.y;
    }
}

}  // namespace
}  // namespace fantascope::app
