// The program as a person runs it: its exit statuses, its messages, and what it leaves behind.

#include "pattern/shape/shape_pattern.h"

#include "core/file.h"
#include "media/image.h"
#include "program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using Arguments = std::vector<std::string>;

// A folder with a small drawing, a mesh, and what the program leaves in out/.
class PatternCommand : public testing::Test {
protected:
    PatternCommand() {
        GreyImage guide(64, 36);
        for (int y = 8; y < 28; ++y)
            for (int x = 8; x < 40; ++x) guide.at(x, y) = 1;
        EXPECT_TRUE(writePng(folder_ / "guide.png", guide));
        fs::copy(sourceFolder() + "/shows/light-movement/shapes/sculpture.obj", folder_ / "sculpture.obj");
        fs::create_directory(folder_ / "out");
    }

    Outcome run(const Arguments& arguments) const { return runProgram(arguments, folder_ / "."); }
    // `pattern guide.png -o out/p.pattern.yaml`, a small one, and more.
    Outcome find(const Arguments& more) const {
        Arguments arguments = {"pattern", "guide.png", "-o", "out/p.pattern.yaml", "--instances", "40"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    std::string text(const std::string& file) const { return readFile(folder_ / file).value(); }
    nlohmann::json report() const { return nlohmann::json::parse(text("out/r.json")); }
    std::vector<std::string> written() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_ / "out")) names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    }

    const ScratchFolder folder_;
};

TEST_F(PatternCommand, writes_a_pattern_with_all_it_needs_beside_it) {
    const Outcome done =
        find({"--iterations", "20", "--shapes", "circle,sculpture.obj", "--image", "out/p.png", "--report", "out/r.json"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(written(), ElementsAre("p.guide.png", "p.pattern.yaml", "p.png", "p.sculpture.obj", "r.json"));
    fs::rename(folder_ / "out", folder_ / "moved");  // as a folder it can go anywhere
    const auto pattern = pattern::readPattern(folder_ / "moved/p.pattern.yaml");
    ASSERT_TRUE(pattern) << pattern.error().message();
    EXPECT_EQ(readFile(pattern->guide).value(), text("guide.png"));
    EXPECT_EQ(readFile(pattern->shapes[1].file).value(), text("sculpture.obj"));
}

// Example failure: a list of shapes takes the drawing for one more of them.
TEST_F(PatternCommand, takes_its_arguments_in_any_order) {
    const Outcome done =
        run({"pattern", "--iterations", "1", "-o", "out/p.pattern.yaml", "--shapes", "leaf,circle", "guide.png"});
    EXPECT_THAT(done, exits(0));
}

TEST_F(PatternCommand, refers_to_what_lies_beside_or_below_it) {
    const Outcome done = run({"pattern", "guide.png", "-o", "p.pattern.yaml", "--iterations", "2", "--shapes", "sculpture.obj"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(text("p.pattern.yaml"), HasSubstr("guide: guide.png"));
    EXPECT_THAT(text("p.pattern.yaml"), HasSubstr("file: sculpture.obj"));
    EXPECT_FALSE(fs::exists(folder_ / "p.guide.png"));
}

// The paper's black shapes on white: shapes stand where the drawing is dark, and the drawing of the
// shadows goes with the pattern.
TEST_F(PatternCommand, fills_what_the_drawing_leaves_dark_when_shapes_are_shadows) {
    const Outcome done = find({"--shadows", "--iterations", "300", "--image", "out/p.png"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(written(), ElementsAre("p.pattern.yaml", "p.png", "p.shadows.png"));
    const GreyImage guide = readGrey(folder_ / "guide.png").value(), shadows = readGrey(folder_ / "out/p.shadows.png").value();
    EXPECT_EQ(pattern::readPattern(folder_ / "out/p.pattern.yaml")->guide, folder_ / "out/p.shadows.png");
    const GreyImage shapes = readGrey(folder_ / "out/p.png").value();
    double onLight = 0, onDark = 0;
    for (std::size_t i = 0; i < guide.pixels().size(); ++i) {
        EXPECT_EQ(shadows.pixels()[i], 1 - guide.pixels()[i]);
        (guide.pixels()[i] > 0.5f ? onLight : onDark) += double{shapes.pixels()[i]};
    }
    EXPECT_GT(onDark, 10 * onLight);
}

// Anybody can compute z from the drawing and the picture.
TEST_F(PatternCommand, reports_the_figures_of_the_picture_that_it_writes) {
    for (const auto& [method, evaluations] : {std::pair("paper", 1 + 12 * 30), {"refined", 1000 * 30}}) {
        SCOPED_TRACE(method);
        ASSERT_THAT(find({"--method", method, "--iterations", "30", "--image", "out/p.png", "--report", "out/r.json"}), exits(0));
        const GreyImage guide = readGrey(folder_ / "guide.png").value(), image = readGrey(folder_ / "out/p.png").value();
        double sum = 0;
        for (std::size_t i = 0; i < guide.pixels().size(); ++i) sum += std::abs(guide.pixels()[i] - image.pixels()[i]);
        const nlohmann::json figures = report();
        EXPECT_NEAR(figures["z"].get<double>(), sum / (64 * 36), 1e-9);
        EXPECT_EQ(figures["z_bound"], 0);  // the guide is black and white
        EXPECT_GT(figures["loop_z"].get<double>(), 0);
        EXPECT_EQ(figures["iterations"], 30);
        EXPECT_EQ(figures["method"], method);
        EXPECT_EQ(figures["evaluations"], evaluations);
        EXPECT_EQ(figures["stop_reason"], "iterations");
        EXPECT_EQ(figures["seed"], 1);
        EXPECT_EQ(figures["guide_transfer"], "srgb");
        for (const char* column : {"z_min", "z_max", "accepted"}) EXPECT_EQ(figures["history"][column].size(), 30u);
        for (const char* key : {"tone", "overlap", "instances", "seconds"}) EXPECT_TRUE(figures[key].is_number()) << key;
    }
}

// From afar a wall that is half covered gives half its light, whose stored value is .74.
TEST_F(PatternCommand, covers_as_much_as_the_drawing_has_light) {
    constexpr float kGrey = 128.0f / 255;
    GreyImage drawing(192, 108, kGrey);
    for (int x = 0; x < 192; ++x) drawing.at(x, 0) = 0;  // a drawing of one grey is refused
    ASSERT_TRUE(writePng(folder_ / "grey.png", drawing));
    const auto covered = [&](const Arguments& more) {
        Arguments arguments = {"pattern",      "grey.png", "-o",      "out/p.pattern.yaml", "--instances", "200",
                               "--iterations", "200",      "--image", "out/p.png",          "--report",    "out/r.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_THAT(run(arguments), exits(0));
        const GreyImage image = readGrey(folder_ / "out/p.png").value();
        double sum = 0;
        for (const float value : image.pixels()) sum += value;
        return sum / static_cast<double>(image.pixels().size());
    };
    const auto space = [&] { return pattern::readPattern(folder_ / "out/p.pattern.yaml")->compare; };
    folder_.file("stored.yaml", "fantascope: pattern-settings\nversion: 1\ncompare: stored\n");
    folder_.file("light.yaml", "fantascope: pattern-settings\nversion: 1\ncompare: light\n");
    const double light = linearFromSrgb(kGrey);

    EXPECT_NEAR(covered({}), light, 0.03);
    EXPECT_EQ(space(), pattern::CompareSpace::Light);
    EXPECT_EQ(report()["compare"], "light");
    EXPECT_EQ(report()["z_light"], report()["z"]);
    EXPECT_EQ(report()["tone_light"], report()["tone"]);
    const double toneInLight = report()["tone_light"];

    EXPECT_NEAR(covered({"--settings", "stored.yaml"}), kGrey, 0.03);
    EXPECT_EQ(space(), pattern::CompareSpace::Stored);
    EXPECT_EQ(report()["compare"], "stored");
    EXPECT_NEAR(report()["tone_light"].get<double>(), kGrey - light, 0.03) << "too bright by so much";
    EXPECT_LT(toneInLight, report()["tone_light"].get<double>() / 2);

    covered({"--method", "paper"});
    EXPECT_EQ(space(), pattern::CompareSpace::Stored) << "as written";
    covered({"--method", "paper", "--settings", "light.yaml"});
    EXPECT_EQ(space(), pattern::CompareSpace::Light);

    EXPECT_NEAR(covered({"--shadows"}), 1 - light, 0.03) << "the light between the shapes is that of the drawing";
    EXPECT_NEAR(covered({"--shadows", "--settings", "stored.yaml"}), 1 - kGrey, 0.03);
}

// Example failure: the clock has a say in more than when to stop.
TEST_F(PatternCommand, a_run_that_stopped_by_time_is_replayed_byte_for_byte_by_its_iterations) {
    for (const char* method : {"paper", "refined"}) {
        SCOPED_TRACE(method);
        ASSERT_THAT(find({"--method", method, "--seconds", "0.2", "--threads", "2", "--seed", "5", "--report", "out/r.json"}),
                    exits(0));
        const nlohmann::json figures = report();
        EXPECT_EQ(figures["stop_reason"], "time");
        const std::string first = text("out/p.pattern.yaml"), count = figures["iterations"].dump();
        ASSERT_THAT(find({"--method", method, "--iterations", count, "--threads", "1", "--seed", "5"}), exits(0));
        EXPECT_EQ(text("out/p.pattern.yaml"), first);
    }
}

TEST_F(PatternCommand, gives_the_same_bytes_in_another_folder) {
    ASSERT_THAT(find({"--iterations", "10", "--shapes", "sculpture.obj"}), exits(0));
    const std::string guide = folder_ / "guide.png", mesh = folder_ / "sculpture.obj";
    ASSERT_EQ(
        run({"pattern", guide, "-o", "a/b/p.pattern.yaml", "--instances", "40", "--iterations", "10", "--shapes", mesh}).status,
        0);
    EXPECT_EQ(text("a/b/p.pattern.yaml"), text("out/p.pattern.yaml"));
}

TEST_F(PatternCommand, takes_its_numbers_from_a_settings_file_and_the_line_has_the_last_word) {
    folder_.file("s.yaml",
                 "fantascope: pattern-settings\nversion: 1\nguide_transfer: linear\nshapes: {instances: 500}\n"
                 "paper: {candidates: 3}\nmotion: {frames: 100}\n");
    ASSERT_THAT(find({"--method", "paper", "--iterations", "4", "--settings", "s.yaml", "--report", "out/r.json"}), exits(0));
    EXPECT_EQ(report()["evaluations"], 1 + 3 * 4);
    EXPECT_EQ(report()["guide_transfer"], "linear");
    EXPECT_LE(report()["instances"], 40);
    EXPECT_THAT(text("out/p.pattern.yaml"), HasSubstr("frames: 100"));
}

// A settings file can say it all; the line still selects. Example failure: its shape files are
// looked for where the program runs.
TEST_F(PatternCommand, takes_shapes_from_the_settings_unless_the_line_names_them) {
    folder_.file("in/leaf.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><path d='M1 1 h6 v3 h-6 z'/></svg>");
    folder_.file("in/s.yaml",
                 "fantascope: pattern-settings\nversion: 1\nshapes: {each: [{builtin: letter-A, colours: [{from: [1, 0, 0]}]}, "
                 "{file: leaf.svg, size: [0.05, 0.06]}]}\n");
    ASSERT_THAT(find({"--iterations", "5", "--settings", "in/s.yaml"}), exits(0));
    EXPECT_THAT(written(), ElementsAre("p.guide.png", "p.leaf.svg", "p.pattern.yaml"));
    auto pattern = pattern::readPattern(folder_ / "out/p.pattern.yaml").value();
    ASSERT_EQ(pattern.shapes.size(), 2u);
    EXPECT_EQ(pattern.shapes[0].name, "letter-A");
    for (const auto& instance : pattern.instances) {
        EXPECT_EQ(instance.colour, instance.shape == 0 ? glm::vec3(1, 0, 0) : glm::vec3(1));
        if (instance.shape == 1) {
            EXPECT_NEAR(instance.size, 0.055, 0.005001);
        }
    }
    ASSERT_THAT(find({"--iterations", "5", "--settings", "in/s.yaml", "--shapes", "circle,in/leaf.svg"}), exits(0));
    pattern = pattern::readPattern(folder_ / "out/p.pattern.yaml").value();
    EXPECT_EQ(pattern.shapes[0].name, "circle");
    for (const auto& instance : pattern.instances)
        if (instance.shape == 1) {
            EXPECT_NEAR(instance.size, 0.055, 0.005001);
        }
}

// A .gltf with its points in a second file would lose them on its way beside the pattern; one that
// holds them itself does not.
TEST_F(PatternCommand, copies_a_gltf_only_if_it_is_whole) {
    const auto gltf = [](const std::string& uri) {
        return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": ")" +
               uri + "\"}]}";
    };
    folder_.file("a.gltf", gltf("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"));
    folder_.file("b.gltf", gltf("b.bin"));
    folder_.file("b.bin", std::string("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0", 36));
    const Outcome whole = find({"--iterations", "2", "--shapes", "a.gltf"});
    EXPECT_THAT(whole, exits(0));
    const Outcome parted = find({"--iterations", "2", "--shapes", "b.gltf"});
    EXPECT_THAT(parted, exits(1));
    EXPECT_THAT(parted.errors, HasSubstr("export it as .glb"));
    EXPECT_THAT(run({"pattern", "guide.png", "-o", "p.pattern.yaml", "--iterations", "2", "--shapes", "b.gltf"}), exits(0))
        << "where it is it has all it needs";
}

// A surface that cannot be heeded is refused before the search. What one does is tested with a
// calibrated site.
TEST_F(PatternCommand, refuses_a_surface_that_it_cannot_heed) {
    const std::string site = sourceFolder() + "/config/simulated/site.yaml";
    const auto refusal = [&](const std::string& surface, Arguments more = {}) {
        more.insert(more.end(), {"--iterations", "1", "--surface", surface});
        const Outcome outcome = find(more);
        EXPECT_THAT(outcome, exits(1));
        EXPECT_THAT(written(), IsEmpty());
        return outcome.errors;
    };
    EXPECT_THAT(refusal(site + ":left", {"--method", "paper"}), HasSubstr("leave --method out"));
    EXPECT_THAT(refusal(site + ":left", {"--shadows"}), HasSubstr("leave --shadows or --surface out"));
    EXPECT_THAT(refusal("left"), HasSubstr("write SITE:OUTPUT"));
    EXPECT_THAT(refusal(site + ":lft"), HasSubstr("did you mean 'left'?"));
    EXPECT_THAT(refusal(site + ":left"), HasSubstr("there is no survey of the site"));
    folder_.file("stored.pattern-settings.yaml", "fantascope: pattern-settings\nversion: 1\ncompare: stored\n");
    EXPECT_THAT(refusal(site + ":left", {"--settings", "stored.pattern-settings.yaml"}), HasSubstr("write 'compare: light'"));
}

// The world refuses: one message, status 1, and nothing is written.
TEST_F(PatternCommand, bad_input_is_refused_with_one_message_and_leaves_nothing) {
    const auto refusal = [&](const std::string& guide, const Arguments& more = {}) {
        Arguments arguments = {"pattern", guide, "-o", "out/p.pattern.yaml", "--iterations", "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_THAT(outcome, exits(1));
        EXPECT_THAT(outcome.errors, StartsWith("fantascope: error: "));
        EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
        EXPECT_THAT(written(), IsEmpty());
        return outcome.errors;
    };
    EXPECT_THAT(refusal("nowhere.png"), HasSubstr("nowhere.png: cannot be read"));
    const std::string png = text("guide.png");
    folder_.file("half.png", png.substr(0, png.size() / 2));
    EXPECT_THAT(refusal("half.png"), HasSubstr("half.png: the picture is truncated"));
    folder_.file("words.png", "This is no picture.");
    EXPECT_THAT(refusal("words.png"), HasSubstr("words.png: not a picture"));

    // Before the search, not after it.
    EXPECT_THAT(run({"pattern", "guide.png", "-o", "guide.png/p.pattern.yaml"}).errors, HasSubstr("guide.png is not a folder"));

    folder_.file("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    EXPECT_THAT(refusal("guide.png", {"--shapes", "points.obj"}), HasSubstr("points.obj: "));
    folder_.file("floor.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    EXPECT_THAT(refusal("guide.png", {"--shapes", "floor.obj"}), HasSubstr("floor.obj: has no area seen from the front"));
    folder_.file("empty.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>");
    EXPECT_THAT(refusal("guide.png", {"--shapes", "empty.svg"}), HasSubstr("empty.svg: draws nothing that has an area"));
    ASSERT_TRUE(writePng(folder_ / "white.png", GreyImage(9, 9, 1)));
    EXPECT_THAT(refusal("guide.png", {"--shapes", "white.png"}), HasSubstr("white.png: is of one colour"));
    EXPECT_THAT(refusal("guide.png", {"--shapes", "circel"}), HasSubstr("did you mean 'circle'?"));
    EXPECT_THAT(refusal("guide.png", {"--shapes", "circle,circle"}), HasSubstr("given twice"));

    folder_.file("s.yaml", "fantascope: pattern-settings\nversion: 1\npaper: {candidates: none}\n");
    EXPECT_THAT(refusal("guide.png", {"--settings", "s.yaml"}), HasSubstr("s.yaml:3:21: paper.candidates: a whole number"));
    EXPECT_THAT(refusal("guide.png", {"--settings", "absent.yaml"}), HasSubstr("absent.yaml: cannot be read"));
}

TEST_F(PatternCommand, wrong_usage_has_a_status_of_its_own_and_points_to_the_help) {
    const std::vector<Arguments> wrong = {{"--instances", "0"},   {"--seconds", "-1"}, {"--iterations", "many"},
                                          {"--target-z", "2"},    {"--threads", "0"},  {"--seed", "-1"},
                                          {"--method", "refind"}, {"--nonsense"}};
    for (const Arguments& arguments : wrong) {
        const Outcome outcome = find(arguments);
        EXPECT_THAT(outcome, exits(2)) << arguments[0];
        EXPECT_THAT(outcome.errors, StartsWith("fantascope: error: "));
        EXPECT_THAT(outcome.errors, HasSubstr("See 'fantascope pattern --help'."));
    }
    EXPECT_THAT(find({"--method", "refind"}).errors, testing::AllOf(HasSubstr("refined"), HasSubstr("paper")));
    EXPECT_THAT(run({"pattern"}), exits(2));
    // A slip that would write the pattern over the drawing.
    EXPECT_THAT(run({"pattern", "guide.png", "-o", "guide.png"}), exits(2));
    EXPECT_THAT(run({"pattern", "--help"}), exits(0));
}

// The artist's stop: Ctrl-C keeps the best pattern so far. The signal is sent once the first line
// of progress says that the search runs.
TEST_F(PatternCommand, ctrl_c_keeps_the_best_so_far) {
    EXPECT_EQ(interruptProgram({"pattern", "guide.png", "-o", "out/p.pattern.yaml", "--instances", "40", "--seconds", "100000",
                                "--report", "out/r.json"},
                               folder_ / ".", 1),
              0);
    EXPECT_EQ(report()["stop_reason"], "interrupted");
    EXPECT_TRUE(pattern::readPattern(folder_ / "out" / "p.pattern.yaml"));
}

// Something stands before the right half; there the pattern changes, elsewhere it must not. Example
// failure: colours, groups or movement of what stays are drawn anew.
TEST_F(PatternCommand, goes_on_from_a_pattern_in_a_region) {
    ASSERT_TRUE(writeFile(folder_ / "linear.yaml", "fantascope: pattern-settings\nversion: 1\nguide_transfer: linear\n"));
    ASSERT_THAT(find({"--iterations", "20", "--seed", "5", "--shapes", "sculpture.obj", "--settings", "linear.yaml"}), exits(0));
    const pattern::ShapePattern before = pattern::readPattern(folder_ / "out" / "p.pattern.yaml").value();
    const Outcome outcome = run({"pattern", "guide.png", "-o", "out/q.pattern.yaml", "--start", "out/p.pattern.yaml", "--region",
                                 "0.9,0,1.8,1", "--iterations", "5"});
    ASSERT_THAT(outcome, exits(0));
    const pattern::ShapePattern after = pattern::readPattern(folder_ / "out" / "q.pattern.yaml").value();
    EXPECT_EQ(after.seed, 5u);
    EXPECT_EQ(after.groups, before.groups);
    EXPECT_EQ(after.guideTransfer, pattern::GuideTransfer::Linear);
    EXPECT_EQ(after.motion.localTurn.range, before.motion.localTurn.range);
    int elsewhere = 0;
    for (const pattern::ShapeInstance& instance : after.instances) {
        if (instance.centre.x >= 0.9) continue;
        ++elsewhere;
        const auto was = std::find_if(before.instances.begin(), before.instances.end(),
                                      [&](const auto& other) { return other.id == instance.id; });
        ASSERT_NE(was, before.instances.end());
        EXPECT_EQ(instance.centre, was->centre);
        EXPECT_EQ(instance.group, was->group);
    }
    EXPECT_GT(elsewhere, 5);

    const auto refused = [&](Arguments more) {
        Arguments arguments = {"pattern", "guide.png", "-o", "out/q.pattern.yaml", "--start", "out/p.pattern.yaml"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    };
    EXPECT_THAT(refused({"--method", "paper"}).errors, HasSubstr("leave --method out"));
    EXPECT_THAT(refused({"--shapes", "leaf"}).errors, HasSubstr("leave --shapes out"));
    EXPECT_THAT(refused({"--region", "1,0,0.5,1"}).errors, HasSubstr("must be the top left corner, then the bottom right one"));
    EXPECT_THAT(refused({"--region", "1,0,1.5"}), exits(2));
    EXPECT_THAT(find({"--region", "0,0,1,1"}), exits(2)) << "a region of what?";
    GreyImage square(36, 36);
    square.at(18, 18) = 1;
    EXPECT_TRUE(writePng(folder_ / "square.png", square));
    EXPECT_THAT(run({"pattern", "square.png", "-o", "out/q.pattern.yaml", "--start", "out/p.pattern.yaml"}).errors,
                HasSubstr("cannot be compared"));
}

}  // namespace
}  // namespace fantascope
