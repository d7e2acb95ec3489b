#include "pattern/search/pattern_settings.h"

#include "pattern/search/search_bounds.h"
#include "pattern/shape/elemental_shape.h"
#include "pattern/shape/motion_file.h"

#include "core/file.h"
#include "media/image.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <map>
#include <numbers>
#include <string>

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
    EXPECT_FALSE(settings->compare) << "each method has its own";
}

TEST(PatternSettings, every_section_is_read_with_angles_in_degrees) {
    const auto settings = read(
        "guide_transfer: linear\n"
        "compare: stored\n"
        "search: {rows: 200}\n"
        "paper: {lambda_create: 0.4, lambda_delete: -0.6, candidates: 3}\n"
        "refined: {tone_weight: 2, polish: 0.2}\n"
        "shapes: {instances: 77, size: [0.02, 0.04], tilt: 90, turn: 45}\n"
        "colours: [{from: [0, 0.5, 1]}, {from: [0, 0, 0], to: [1, 1, 1]}]\n"
        "motion: {frames: 600, local_turn: {range: 10}}\n");
    ASSERT_TRUE(settings) << settings.error().message();
    EXPECT_EQ(settings->guideTransfer, GuideTransfer::Linear);
    EXPECT_EQ(settings->compare, CompareSpace::Stored);
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

// A folder with a drawing of a shape, a mesh and a picture of colours.
struct SettingsFolder : ScratchFolder {
    SettingsFolder() {
        file("shapes/leaf.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><path d='M1 1 h6 v3 h-6 z'/></svg>");
        file("roof.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        EXPECT_TRUE(writePng(path() / "autumn.png", RgbaImage(3000, 20, {200, 100, 0, 255})));
    }
    Result<PatternSettings> read(const std::string& body) const {
        return readPatternSettings(file("light.pattern-settings.yaml", "fantascope: pattern-settings\nversion: 1\n" + body));
    }
    std::string refusal(const std::string& body) const {
        const auto settings = read(body);
        return settings ? "accepted" : relative(settings.error().message());
    }
};

TEST(PatternSettings, shapes_have_settings_of_their_own) {
    const SettingsFolder folder;
    const auto settings = folder.read(
        "colours: [{picture: autumn.png}]\n"
        "shapes:\n"
        "  tilt: 30\n"
        "  each:\n"
        "    - {builtin: maple-leaf, share: 3, size: [0.02, 0.04], tilt: 10, turn: [150, 210], colours: [{from: [1, 0, 0]}, "
        "{picture: autumn.png}]}\n"
        "    - {file: shapes/leaf.svg, tilt: [5, 10], turn: 20}\n"
        "    - {builtin: letter-A}\n");
    ASSERT_TRUE(settings) << settings.error().message();
    EXPECT_EQ(settings->search.tilt, radians(30));
    ASSERT_EQ(settings->shapes.size(), 3u);
    const auto& [maple, mapleOwn] = settings->shapes[0];
    EXPECT_EQ(maple.name, "maple-leaf");
    EXPECT_EQ(mapleOwn.share, 3);
    EXPECT_EQ(mapleOwn.size, glm::dvec2(0.02, 0.04));
    EXPECT_EQ(mapleOwn.tilt, glm::dvec2(radians(-10), radians(10)));
    EXPECT_EQ(mapleOwn.turn, glm::dvec2(radians(150), radians(210)));
    ASSERT_EQ(mapleOwn.colours.size(), 2u);
    EXPECT_EQ(mapleOwn.colours[0].to, glm::dvec3(1, 0, 0));
    EXPECT_EQ(mapleOwn.colours[1].picture->at(0, 0).g, 100);
    EXPECT_LE(mapleOwn.colours[1].picture->width(), 1024) << "a large picture is not kept whole";
    const auto& [leaf, leafOwn] = settings->shapes[1];
    EXPECT_EQ(leaf.file, folder / "shapes/leaf.svg");
    EXPECT_EQ(leafOwn.tilt, glm::dvec2(radians(5), radians(10)));
    EXPECT_EQ(leafOwn.turn, glm::dvec2(radians(-20), radians(20)));
    const auto& letter = settings->shapes[2].own;
    EXPECT_EQ(letter.share, 1);
    EXPECT_FALSE(letter.size || letter.tilt || letter.turn);
    EXPECT_TRUE(letter.colours.empty());
    EXPECT_TRUE(settings->search.colours[0].picture);
}

// The command line may name the same shapes in another order and the files by another path.
TEST(PatternSettings, a_shapes_own_settings_are_found_by_name_or_file) {
    const SettingsFolder folder;
    const auto settings = folder.read(
        "shapes: {each: [{builtin: leaf, share: 2}, {file: shapes/leaf.svg, share: 3}, {file: roof.obj, share: 4}]}\n");
    ASSERT_TRUE(settings) << settings.error().message();
    EXPECT_EQ(settings->ownOf(loadShape("leaf").value()).share, 2);
    EXPECT_EQ(settings->ownOf(loadShape("circle").value()).share, 1);
    EXPECT_EQ(settings->ownOf(loadShape((folder / "shapes/../shapes/leaf.svg").string()).value()).share, 3);
    EXPECT_EQ(settings->ownOf(loadShape((folder / "roof.obj").string()).value()).share, 4);
    folder.file("other/roof.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(settings->ownOf(loadShape((folder / "other/roof.obj").string()).value()).share, 1) << "another file of that name";
}

TEST(PatternSettings, what_is_wrong_with_a_shape_is_refused_with_its_place) {
    const SettingsFolder folder;
    const auto refusal = [&](const std::string& shape) { return folder.refusal("shapes: {each: [" + shape + "]}\n"); };
    const std::string at = "light.pattern-settings.yaml:3:";
    EXPECT_THAT(refusal(""), HasSubstr("at least 1"));
    EXPECT_THAT(refusal("{share: 1}"), HasSubstr(at + "17: shapes.each[0]: exactly one of 'builtin' and 'file' is needed"));
    EXPECT_THAT(refusal("{builtin: mapel-leaf}"), HasSubstr("shapes.each[0].builtin: 'mapel-leaf' is no built-in shape"));
    EXPECT_THAT(refusal("{builtin: mapel-leaf}"), HasSubstr("did you mean 'maple-leaf'?"));
    EXPECT_THAT(refusal("{file: none.svg}"), HasSubstr("none.svg: cannot be read"));
    EXPECT_THAT(refusal("{file: ../leaf.svg}"), HasSubstr("shapes.each[0].file: "));
    EXPECT_THAT(refusal("{builtin: leaf, shares: 2}"), HasSubstr("did you mean 'share'?"));
    EXPECT_THAT(refusal("{builtin: leaf, share: 0}"), HasSubstr("shapes.each[0].share: 0 is out of range"));
    EXPECT_THAT(refusal("{builtin: leaf, size: [0.2, 0.1]}"), HasSubstr(at + "17: shapes.each[0]: size = [0.2, 0.1]"));
    EXPECT_THAT(refusal("{builtin: leaf, turn: [50, 20]}"),
                HasSubstr("turn = [50, 20] degrees must be [from, to] with -360 <= from <= to <= 360"));
    EXPECT_THAT(refusal("{builtin: leaf, turn: [-200, 200]}"), HasSubstr("to - from <= 360"));
    EXPECT_THAT(refusal("{builtin: leaf, turn: -5}"), HasSubstr("0 .. 180 degrees"));
    EXPECT_THAT(refusal("{builtin: leaf, tilt: [0, 200]}"), HasSubstr("-180 .. 180 degrees"));
    EXPECT_THAT(refusal("{builtin: leaf, colours: []}"), HasSubstr("at least 1"));
    EXPECT_THAT(refusal("{builtin: leaf, colours: [{picture: none.png}]}"), HasSubstr("none.png: cannot be read"));
    EXPECT_THAT(refusal("{builtin: leaf, colours: [{picture: autumn.png, from: [1, 1, 1]}]}"),
                HasSubstr("'picture' excludes 'from' and 'to'"));
    EXPECT_THAT(refusal("{builtin: leaf}, {builtin: leaf}"), HasSubstr("shapes.each[1]: leaf is given twice"));
    EXPECT_THAT(refusal("{file: roof.obj}, {file: shapes/../roof.obj}"), HasSubstr("twice"));
}

// A file that sets one amplitude is taken to have set them all on purpose.
TEST(PatternSettings, movement_is_fitted_unless_an_amplitude_is_named) {
    EXPECT_TRUE(read("")->fitMotion);
    EXPECT_TRUE(read("motion: {direction: 20, local_turn: {beta: 2, damping: 0.5}}\n")->fitMotion);
    EXPECT_FALSE(read("motion: {local_turn: {range: 10}}\n")->fitMotion);
    EXPECT_FALSE(read("motion: {group_minor: {magnitude: 0.1}}\n")->fitMotion);
}

// The numbers of options, by their keys.
struct Collected {
    std::map<std::string, double> numbers;

    void number(const char* key, double value, double, double) { numbers[key] = value; }
    void integer(const char* key, double value, double, double) { numbers[key] = value; }
    void angle(const char* key, double value, double, double) { numbers[key] = value; }
};
std::map<std::string, double> numbersOf(PatternSearch::Options options) {
    Collected collected;
    declareSearch(collected, options);
    declareRefined(collected, options.refined);
    declarePaper(collected, options.paper);
    declareShapes(collected, options);
    return collected.numbers;
}

// People copy from this file. Example failure: a default was changed, or a new number is missing
// from the file.
TEST(PatternSettings, the_file_of_defaults_holds_every_number_and_changes_nothing) {
    const std::string file = sourceFolder() + "/assets/defaults.pattern-settings.yaml";
    const auto settings = readPatternSettings(file);
    ASSERT_TRUE(settings) << settings.error().message();
    const auto numbers = numbersOf(PatternSearch::Options());
    EXPECT_EQ(numbersOf(settings->search), numbers);
    EXPECT_EQ(motionText(settings->motion), motionText(MotionSettings()));
    EXPECT_TRUE(settings->fitMotion);
    EXPECT_FALSE(settings->search.size);
    EXPECT_FALSE(settings->seconds);
    EXPECT_FALSE(settings->compare);
    EXPECT_EQ(settings->search.colours.size(), 1u);
    EXPECT_EQ(settings->search.colours[0].from, PatternSearch::Options::Colours().from);
    const std::string text = readFile(file).value();
    for (const auto& [key, value] : numbers) EXPECT_THAT(text, HasSubstr(key));
}

TEST(PatternSettings, what_is_wrong_is_refused_with_its_place) {
    EXPECT_THAT(refusal("serach: {}\n"), HasSubstr(":3:1: serach: unknown key (did you mean 'search'?)"));
    EXPECT_THAT(refusal("paper: {lambda_creat: 0.2}\n"), HasSubstr("did you mean 'lambda_create'?"));
    EXPECT_THAT(refusal("paper: {candidates: 0}\n"), HasSubstr(":3:21: paper.candidates: 0 is out of range"));
    EXPECT_THAT(refusal("paper: {lambda_reduce: -0.5}\n"), HasSubstr(":3:8: paper: -1 < lambda_delete <= lambda_reduce"));
    EXPECT_THAT(refusal("shapes: {size: [0.2, 0.1]}\n"), HasSubstr(":3:9: shapes: size"));
    EXPECT_THAT(refusal("shapes: {tilt: 200}\n"), HasSubstr("0 .. 180 degrees is allowed"));
    EXPECT_THAT(refusal("colours: []\n"), HasSubstr("at least 1"));
    EXPECT_THAT(refusal("colours: [{to: [1, 1, 1]}]\n"), HasSubstr("'from' or 'picture' is missing"));
    EXPECT_THAT(refusal("motion: {group_major: {damping: two}}\n"), HasSubstr("motion.group_major.damping: a number"));
}

TEST(PatternSettings, the_documents_examples_load) {
    const std::string document = readFile(std::filesystem::path(sourceFolder()) / "docs/pattern-settings.md").value();
    const SettingsFolder folder;
    int examples = 0;
    for (std::size_t at = 0; (at = document.find("```yaml\n", at)) != std::string::npos; ++examples) {
        at += 8;
        const std::size_t end = document.find("```\n", at);
        const auto settings = readPatternSettings(folder.file("example.yaml", document.substr(at, end - at)));
        EXPECT_TRUE(settings) << settings.error().message();
        at = end;
    }
    EXPECT_EQ(examples, 2);
}

}  // namespace
}  // namespace fantascope::pattern
