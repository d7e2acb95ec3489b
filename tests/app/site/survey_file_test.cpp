// What a calibration saw, written and read back, and held against the site.

#include "app/site/survey_file.h"

#include "app/site/site_file.h"

#include "core/file.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr glm::ivec2 kCamera{48, 36}, kProjector{1920, 1080};
const std::string kWhole = "[[0, 0], [1920, 0], [1920, 1080], [0, 1080]]",
                  kMoved = "[[0, 0], [1900, 0], [1920, 1080], [0, 1080]]";

class SurveyFile : public testing::Test {
protected:
    // A site of two outputs; `left`: the corners of the first.
    show::Site site(const std::string& left = kWhole, const std::string& more = "", glm::ivec2 camera = kCamera) {
        std::string text = "fantascope: site\nversion: 1\noutputs:\n";
        for (const auto& [name, corners] : {std::pair<std::string, std::string>("left", left), {"right", kWhole}})
            text += fmt::format(
                "  - {{name: {}, display: {{driver: headless}}, size: [1920, 1080], refresh_rate: 30, corners: {}{}}}\n", name,
                corners, more);
        text += fmt::format(
            "camera: {{device: {{driver: simulated}}, size: [{}, {}], field_of_view: 60, position: [0, 2, 5], look_at: [0, 0, "
            "0]}}\n",
            camera.x, camera.y);
        return readSite(folder_.file("site.yaml", text)).value();
    }
    // Light that reaches all but the left edge of the camera's picture, with a stripe that could
    // not be decoded. `shade`: tells surveys apart.
    static OutputSurvey survey(const show::Site& site, const std::string& output, float shade) {
        OutputSurvey survey{{Image<glm::vec2>(kCamera.x, kCamera.y, glm::vec2(NAN)), GreyImage(kCamera.x, kCamera.y)},
                            GreyImage(kCamera.x, kCamera.y),
                            kProjector,
                            2.13,
                            std::chrono::milliseconds(123),
                            {}};
        for (int y = 0; y < kCamera.y; ++y)
            for (int x = 0; x < kCamera.x; ++x) {
                survey.dark.at(x, y) = 0.002f + 0.001f * static_cast<float>(x);
                if (x == 0) continue;
                survey.map.light.at(x, y) =
                    shade + 0.3f * std::sin(0.7f * static_cast<float>(x)) * std::cos(0.3f * static_cast<float>(y));
                ++survey.map.lit;
                if (y == 7) continue;
                ++survey.map.known;
                survey.map.at.at(x, y) = {39.61f * static_cast<float>(x) + 0.37f * static_cast<float>(y),
                                          29.77f * static_cast<float>(y)};
            }
        for (const show::Output& one : site.outputs)
            if (one.name == output) survey.warp = one.projection.warp.shape();
        return survey;
    }
    static float shadeOf(const Survey& survey, const std::string& output) { return survey.outputs.at(output).map.light.at(1, 5); }
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_ / "site.survey")) names.push_back(entry.path().filename());
        std::ranges::sort(names);
        return names;
    }
    const ScratchFolder folder_;
};

TEST_F(SurveyFile, reads_back_what_was_written) {
    const show::Site bent = site(kMoved,
                                 ", part: [0.125, 0, 1, 1], flip: horizontal, turn: 180, mesh: {points: [2, 2], offsets: [[1, "
                                 "2], [0.1, 0], [0, -3.25], [0, 0]]}");
    const OutputSurvey written = survey(bent, "left", 0.4f);
    ASSERT_TRUE(writeSurvey(bent, {{"left", written}}));
    const auto read = readSurvey(bent);
    ASSERT_TRUE(read) << read.error().message();
    ASSERT_TRUE(*read && (*read)->outputs.contains("left")) << (*read)->unfit.at("left");
    const OutputSurvey& left = (*read)->outputs.at("left");
    EXPECT_EQ(left.warp, written.warp);
    EXPECT_EQ(left.projector, kProjector);
    EXPECT_EQ(left.gamma, 2.13);
    EXPECT_EQ(left.latency, written.latency);
    EXPECT_EQ(left.map.lit, written.map.lit);
    EXPECT_EQ(left.map.known, written.map.known);
    for (int y = 0; y < kCamera.y; ++y)
        for (int x = 0; x < kCamera.x; ++x) {
            ASSERT_EQ(left.map.isKnown(x, y), written.map.isKnown(x, y));
            if (left.map.isKnown(x, y)) {
                ASSERT_LT(glm::distance(left.map.at.at(x, y), written.map.at.at(x, y)), 1 / 32.0);
            }
            ASSERT_NEAR(left.map.light.at(x, y), written.map.light.at(x, y), 1e-4);
            ASSERT_NEAR(left.dark.at(x, y), written.dark.at(x, y), 1e-5);
        }
}

TEST_F(SurveyFile, is_nothing_where_none_was_made) {
    const auto read = readSurvey(site());
    ASSERT_TRUE(read);
    EXPECT_FALSE(*read);
}

TEST_F(SurveyFile, of_another_picture_is_told_and_not_used) {
    ASSERT_TRUE(writeSurvey(site(), {{"left", survey(site(), "left", 0.4f)}, {"right", survey(site(), "right", 0.5f)}}));
    const Survey moved = **readSurvey(site(kMoved));
    EXPECT_THAT(moved.unfit.at("left"), HasSubstr("its picture was moved since it was surveyed; calibrate it again"));
    EXPECT_FALSE(moved.outputs.contains("left"));
    EXPECT_TRUE(moved.outputs.contains("right"));
    const Survey another = **readSurvey(site(kWhole, "", {64, 48}));
    EXPECT_THAT(another.unfit.at("right"), HasSubstr("by a camera of 48 x 36 pixels"));
    EXPECT_THAT(another.outputs, IsEmpty());
}

// Whatever was written last when the power went: site and survey belong together.
TEST_F(SurveyFile, goes_with_the_site_file_forth_and_back) {
    const show::Site before = site(kWhole);
    ASSERT_TRUE(writeSurvey(before, {{"left", survey(before, "left", 0.4f)}, {"right", survey(before, "right", 0.5f)}}));
    const show::Site after = site(kMoved);
    ASSERT_TRUE(writeSurvey(after, {{"left", survey(after, "left", 0.45f)}}));
    const Survey newest = **readSurvey(after), old = **readSurvey(before);
    EXPECT_NEAR(shadeOf(newest, "left") - shadeOf(old, "left"), 0.05, 1e-3);
    EXPECT_THAT(newest.unfit, IsEmpty());
    EXPECT_THAT(old.unfit, IsEmpty());
    EXPECT_EQ(shadeOf(newest, "right"), shadeOf(old, "right")) << "it was not measured again";
}

TEST_F(SurveyFile, keeps_no_pictures_that_nothing_names) {
    for (const float shade : {0.4f, 0.45f, 0.5f}) ASSERT_TRUE(writeSurvey(site(), {{"left", survey(site(), "left", shade)}}));
    EXPECT_THAT(names(), ElementsAre("left.2.dark.png", "left.2.png", "left.3.dark.png", "left.3.png", "survey.yaml"));
}

// After a way back, or after a program that was killed before it wrote the site: the newest record
// is not that of the site as it stands.
TEST_F(SurveyFile, keeps_the_record_of_the_site_as_it_stands) {
    const show::Site standing = site(kWhole);
    ASSERT_TRUE(writeSurvey(standing, {{"left", survey(standing, "left", 0.4f)}}));
    const show::Site undone = site(kMoved);
    ASSERT_TRUE(writeSurvey(standing, {{"left", survey(undone, "left", 0.45f)}}));
    const show::Site next = site("[[0, 0], [1800, 0], [1920, 1080], [0, 1080]]");
    ASSERT_TRUE(writeSurvey(standing, {{"left", survey(next, "left", 0.5f)}}));
    EXPECT_NEAR(shadeOf(**readSurvey(next), "left"), 0.5, 0.02);
    ASSERT_TRUE((*readSurvey(standing))->outputs.contains("left"));
    EXPECT_NEAR(shadeOf(**readSurvey(standing), "left"), 0.4, 0.02);
}

// As a program that is killed while it writes leaves them. What is not ours stays.
TEST_F(SurveyFile, sweeps_up_what_was_left_half_done) {
    for (const char* name :
         {"left.7.png", "left.7.dark.png", "survey.yaml.123-0", "left.2.png.123-0", "notes.png", "notes.2.txt"})
        folder_.file(fs::path("site.survey") / name, "half");
    ASSERT_TRUE(writeSurvey(site(), {{"left", survey(site(), "left", 0.4f)}}));
    EXPECT_THAT(names(), ElementsAre("left.1.dark.png", "left.1.png", "notes.2.txt", "notes.png", "survey.yaml"));
}

TEST_F(SurveyFile, stays_whole_if_it_cannot_be_written) {
    ASSERT_TRUE(writeSurvey(site(), {{"left", survey(site(), "left", 0.4f)}, {"right", survey(site(), "right", 0.5f)}}));
    const std::string before = readFile(surveyFileOf(site().file)).value();
    fs::create_directories(folder_ / "site.survey" / "right.2.png" / "full");  // stands where a picture is to be
    EXPECT_FALSE(writeSurvey(site(), {{"left", survey(site(), "left", 0.45f)}, {"right", survey(site(), "right", 0.45f)}}));
    EXPECT_EQ(readFile(surveyFileOf(site().file)).value(), before);
    const auto read = readSurvey(site());
    ASSERT_TRUE(read);
    EXPECT_EQ((*read)->outputs.size(), 2u);
}

TEST_F(SurveyFile, says_which_picture_is_missing) {
    ASSERT_TRUE(writeSurvey(site(), {{"left", survey(site(), "left", 0.4f)}}));
    EXPECT_THAT(checkSurvey(surveyFileOf(site().file)).value(), ElementsAre("left"));
    fs::remove(folder_ / "site.survey" / "left.1.png");
    const auto read = readSurvey(site());
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message(), HasSubstr("left.1.png"));
    EXPECT_FALSE(checkSurvey(surveyFileOf(site().file)));
}

}  // namespace
}  // namespace fantascope::app
