#include "pattern/pattern_settings.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::pattern {
namespace {

using testing::HasSubstr;

Result<PatternSettings> read(const std::string& body) {
    const ScratchFolder folder;
    return readPatternSettings(folder.file("light.pattern-settings.yaml", "fantascope: pattern-settings\nversion: 1\n" + body));
}

std::string refusal(const std::string& body) {
    const auto settings = read(body);
    return settings ? "accepted" : settings.error().message();
}

TEST(PatternSettings, without_a_key_are_the_defaults) {
    const auto settings = read("");
    ASSERT_TRUE(settings) << settings.error().message();
    EXPECT_EQ(settings->search.paper.candidates, 12);
    EXPECT_EQ(settings->search.tilt, PatternSearch::Options().tilt);
    EXPECT_FALSE(settings->search.size.has_value());
    EXPECT_EQ(settings->motion.frames, 2000);
}

TEST(PatternSettings, every_section_is_read_with_angles_in_degrees) {
    const auto settings = read(
        "guide_transfer: linear\n"
        "search: {rows: 200}\n"
        "paper: {lambda_create: 0.4, lambda_delete: -0.6, candidates: 3}\n"
        "refined: {tone_weight: 2, polish: 0.2}\n"
        "shapes: {instances: 77, size: [0.02, 0.04], tilt: 90, turn: 45}\n"
        "colours: [{from: [0, 0.5, 1]}, {from: [0, 0, 0], to: [1, 1, 1]}]\n"
        "motion: {frames: 600, local_turn: {range: 10}}\n");
    ASSERT_TRUE(settings) << settings.error().message();
    EXPECT_EQ(settings->guideTransfer, GuideTransfer::Linear);
    EXPECT_EQ(settings->search.paper.lambdaCreate, 0.4);
    EXPECT_EQ(settings->search.paper.lambdaDelete, -0.6);
    EXPECT_EQ(settings->search.paper.candidates, 3);
    EXPECT_EQ(settings->search.refined.toneWeight, 2);
    EXPECT_EQ(settings->search.refined.polish, 0.2);
    EXPECT_EQ(settings->search.rows, 200);
    EXPECT_EQ(settings->search.instances, 77u);
    EXPECT_EQ(settings->search.size, glm::dvec2(0.02, 0.04));
    EXPECT_EQ(settings->search.tilt, std::numbers::pi / 2);
    EXPECT_EQ(settings->search.turn, std::numbers::pi / 4);
    ASSERT_EQ(settings->search.colours.size(), 2u);
    EXPECT_EQ(settings->search.colours[0].to, glm::dvec3(0, 0.5, 1));
    EXPECT_EQ(settings->search.colours[1].to, glm::dvec3(1));
    EXPECT_EQ(settings->motion.frames, 600);
    EXPECT_EQ(settings->motion.localTurn.range, radians(10));
    EXPECT_EQ(settings->motion.localTurn.magnitude, MotionSettings().localTurn.magnitude);
}

// A file that names one amplitude has thought of them.
TEST(PatternSettings, movement_is_fitted_unless_an_amplitude_is_named) {
    EXPECT_TRUE(read("")->fitMotion);
    EXPECT_TRUE(read("motion: {direction: 20, local_turn: {beta: 2, damping: 0.5}}\n")->fitMotion);
    EXPECT_FALSE(read("motion: {local_turn: {range: 10}}\n")->fitMotion);
    EXPECT_FALSE(read("motion: {group_minor: {magnitude: 0.1}}\n")->fitMotion);
}

TEST(PatternSettings, what_is_wrong_is_refused_with_its_place) {
    EXPECT_THAT(refusal("serach: {}\n"), HasSubstr(":3:1: serach: unknown key (did you mean 'search'?)"));
    EXPECT_THAT(refusal("paper: {lambda_creat: 0.2}\n"), HasSubstr("did you mean 'lambda_create'?"));
    EXPECT_THAT(refusal("paper: {candidates: 0}\n"), HasSubstr(":3:21: paper.candidates: 0 is out of range"));
    EXPECT_THAT(refusal("paper: {lambda_reduce: -0.5}\n"), HasSubstr(":3:8: paper: -1 < lambda_delete <= lambda_reduce"));
    EXPECT_THAT(refusal("shapes: {size: [0.2, 0.1]}\n"), HasSubstr(":3:9: shapes: size"));
    EXPECT_THAT(refusal("shapes: {tilt: 200}\n"), HasSubstr("0 .. 180 degrees is allowed"));
    EXPECT_THAT(refusal("colours: []\n"), HasSubstr("at least 1"));
    EXPECT_THAT(refusal("colours: [{to: [1, 1, 1]}]\n"), HasSubstr("'from' is missing"));
    EXPECT_THAT(refusal("motion: {group_major: {damping: two}}\n"), HasSubstr("motion.group_major.damping: a number"));
}

}  // namespace
}  // namespace fantascope::pattern
