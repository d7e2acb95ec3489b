#include "pattern/motion/pattern_motion.h"
#include "pattern/shape/motion_file.h"
#include "pattern/shape/shape_pattern.h"
#include "show/replaced.h"

#include "core/config/config.h"
#include "core/file.h"
#include "core/random.h"
#include "media/image.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <set>

namespace fantascope::pattern {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view kMesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

constexpr std::string_view kPattern = R"(fantascope: pattern
version: 1
guide: guides/tree.png
guide_transfer: linear
compare: light
size: [640, 360]
seed: 9
groups: 2
shapes:
  - {builtin: triangle}
  - {file: shapes/sculpture.obj}
motion:
  direction: 30
  local_tilt: {beta: 0.5, range: 12}
instances:
  - {id: 3, shape: 1, group: 0, centre: [0.25, 0.5], size: 0.05, rotation: [10, -20, 180], colour: [1, 0.5, 0.1]}
  - {id: 7, shape: 0, group: 1, centre: [1.5, 1], size: 0.1, rotation: [0, 0, 0], colour: [0, 0, 0]}
)";

// A folder with the shape file of a pattern.
struct PatternFolder : ScratchFolder {
    PatternFolder() { file("shapes/sculpture.obj", kMesh); }
    std::filesystem::path pattern() const { return path() / "tree.pattern.yaml"; }
    std::string bytes() const { return readFile(pattern()).value(); }
};

// readPattern()'s error for the text.
std::string refusal(const std::string& text) {
    const PatternFolder folder;
    const auto pattern = readPattern(folder.file("tree.pattern.yaml", text));
    return pattern ? "accepted" : folder.relative(pattern.error().message());
}
std::string refusalAfter(std::string_view what, std::string_view by) {
    return refusal(replaced(std::string(kPattern), what, by));
}

ShapePattern sample(const PatternFolder& folder) { return readPattern(folder.file("tree.pattern.yaml", kPattern)).value(); }

// A pattern whose numbers are no short decimals.
ShapePattern randomPattern(const PatternFolder& folder, std::uint32_t instances) {
    ShapePattern pattern = sample(folder);
    pattern.instances.clear();
    Rng rng(5);
    for (std::uint32_t id = 0; id < instances; ++id) {
        const auto angle = [&] { return rng.uniform(-std::numbers::pi, std::numbers::pi); };
        const auto light = [&] { return static_cast<float>(rng.uniform()); };
        pattern.instances.push_back({id,
                                     rng.below(2),
                                     rng.below(2),
                                     {rng.uniform(0, 1.7), rng.uniform()},
                                     rng.uniform(0.001, 0.1),
                                     {angle(), angle(), angle()},
                                     {light(), light(), light()}});
    }
    return pattern;
}

// Example failure: an unquoted '#' begins a comment.
TEST(PatternFile, every_kind_of_shape_comes_back) {
    const PatternFolder folder;
    folder.file("leaf.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><path d='M1 1 h6 v3 h-6 z'/></svg>");
    GreyImage dark(40, 40, 1);
    for (int y = 10; y < 30; ++y)
        for (int x = 10; x < 30; ++x) dark.at(x, y) = 0;
    ASSERT_TRUE(writePng(folder / "shapes/leaf.png", dark));
    const std::string kinds =
        "  - {builtin: maple-leaf}\n  - {builtin: letter-A}\n  - {builtin: 'letter-#'}\n  - {builtin: \"letter-'\"}\n  - "
        "{builtin: letter-é}\n"
        "  - {file: leaf.svg}\n  - {file: shapes/leaf.png}\n";
    const std::string text = replaced(std::string(kPattern), "motion:", kinds + "motion:");
    const auto pattern = readPattern(folder.file("tree.pattern.yaml", text));
    ASSERT_TRUE(pattern) << pattern.error().message();
    ASSERT_EQ(pattern->shapes.size(), 9u);
    EXPECT_EQ(pattern->shapes[4].name, "letter-#");
    EXPECT_EQ(pattern->shapes[8].file, folder / "shapes/leaf.png");
    ASSERT_TRUE(writePattern(folder.pattern(), *pattern));
    const auto again = readPattern(folder.pattern());
    ASSERT_TRUE(again) << again.error().message();
    for (std::size_t i = 0; i < pattern->shapes.size(); ++i) {
        EXPECT_EQ(again->shapes[i].name, pattern->shapes[i].name);
        EXPECT_EQ(again->shapes[i].mesh.vertices, pattern->shapes[i].mesh.vertices) << pattern->shapes[i].name;
    }
}

TEST(PatternFile, is_read_in_canvas_units_and_radians) {
    const PatternFolder folder;
    const ShapePattern pattern = sample(folder);
    EXPECT_EQ(pattern.guide, folder.path() / "guides/tree.png");
    EXPECT_EQ(pattern.guideTransfer, GuideTransfer::Linear);
    EXPECT_EQ(pattern.compare, CompareSpace::Light);
    EXPECT_EQ(pattern.width, 640);
    EXPECT_EQ(pattern.height, 360);
    EXPECT_EQ(pattern.seed, 9u);
    EXPECT_EQ(pattern.groups, 2u);
    ASSERT_EQ(pattern.shapes.size(), 2u);
    EXPECT_EQ(pattern.shapes[0].name, "triangle");
    EXPECT_TRUE(pattern.shapes[0].file.empty());
    EXPECT_EQ(pattern.shapes[1].name, "shapes/sculpture.obj");
    EXPECT_EQ(pattern.shapes[1].file, folder.path() / "shapes/sculpture.obj");
    EXPECT_EQ(pattern.shapes[1].mesh.triangles.size(), 1u);
    ASSERT_EQ(pattern.instances.size(), 2u);
    const ShapeInstance& first = pattern.instances[0];
    EXPECT_EQ(first.id, 3u);
    EXPECT_EQ(first.shape, 1u);
    EXPECT_EQ(first.group, 0u);
    EXPECT_EQ(first.centre, glm::dvec2(0.25, 0.5));
    EXPECT_EQ(first.size, 0.05);
    EXPECT_DOUBLE_EQ(first.rotation.x, std::numbers::pi / 18);
    EXPECT_DOUBLE_EQ(first.rotation.y, -std::numbers::pi / 9);
    EXPECT_DOUBLE_EQ(first.rotation.z, std::numbers::pi);
    EXPECT_EQ(first.colour, glm::vec3(1.0f, 0.5f, 0.1f));
    EXPECT_DOUBLE_EQ(pattern.motion.direction, std::numbers::pi / 6);
    EXPECT_DOUBLE_EQ(pattern.motion.localTilt.range, std::numbers::pi / 15);
    EXPECT_EQ(pattern.motion.localTilt.beta, 0.5);
}

// Patterns of earlier versions were compared in stored values.
TEST(PatternFile, without_a_space_was_compared_in_stored_values) {
    const PatternFolder folder;
    const auto pattern = readPattern(folder.file("tree.pattern.yaml", replaced(std::string(kPattern), "compare: light\n", "")));
    ASSERT_TRUE(pattern) << pattern.error().message();
    EXPECT_EQ(pattern->compare, CompareSpace::Stored);
}

// An absent key has the default of its own axis, not that of another one.
TEST(PatternFile, absent_motion_keeps_every_default) {
    const PatternFolder folder;
    const ShapePattern pattern = sample(folder);
    EXPECT_EQ(pattern.motion.localTilt.naturalFrequency, MotionSettings{}.localTilt.naturalFrequency);
    EXPECT_EQ(motionText(readMotion(ConfigNode::parse("{}", "settings.yaml").value()).value()), motionText(MotionSettings{}));
}

// Everything except angles is read back bit for bit. Angles are off by at most one unit in the last
// place, and exact from the second round on. Example failure: colours are written as doubles, or
// coordinates with six digits.
TEST(PatternFile, what_was_written_is_read_back) {
    const PatternFolder folder;
    const ShapePattern written = randomPattern(folder, 500);
    ASSERT_TRUE(writePattern(folder.pattern(), written));
    const std::string bytes = folder.bytes();
    const ShapePattern once = readPattern(folder.pattern()).value();
    ASSERT_TRUE(writePattern(folder.pattern(), once));
    EXPECT_EQ(folder.bytes(), bytes);
    const ShapePattern twice = readPattern(folder.pattern()).value();

    EXPECT_EQ(once.guide, written.guide);
    EXPECT_EQ(once.guideTransfer, written.guideTransfer);
    EXPECT_EQ(once.compare, written.compare);
    EXPECT_EQ(once.shapes[1].file, written.shapes[1].file);
    ASSERT_EQ(once.instances.size(), written.instances.size());
    for (std::size_t i = 0; i < once.instances.size(); ++i) {
        const ShapeInstance &a = written.instances[i], &b = once.instances[i];
        EXPECT_EQ(a.id, b.id);
        EXPECT_EQ(a.shape, b.shape);
        EXPECT_EQ(a.group, b.group);
        EXPECT_EQ(a.centre, b.centre);
        EXPECT_EQ(a.size, b.size);
        EXPECT_EQ(a.colour, b.colour);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_LE(std::abs(a.rotation[axis] - b.rotation[axis]),
                      std::abs(std::nextafter(a.rotation[axis], 2 * a.rotation[axis]) - a.rotation[axis]));
        EXPECT_EQ(b.rotation, twice.instances[i].rotation);
    }
}

// Example failure: 0.7 degrees are written back as 0.7000000000000001.
TEST(PatternFile, angles_keep_the_digits_that_a_person_wrote) {
    for (int tenth = -3600; tenth <= 3600; ++tenth) {
        const double degrees = tenth / 10.0;
        EXPECT_EQ(shortestDegrees(degrees * std::numbers::pi / 180), shortest(degrees));
    }
}

// So a folder can be moved, and runs in different places can be compared byte by byte.
TEST(PatternFile, the_same_pattern_gives_the_same_bytes_in_whatever_folder) {
    const PatternFolder one, other;
    ASSERT_TRUE(writePattern(one.pattern(), randomPattern(one, 20)));
    ASSERT_TRUE(writePattern(other.pattern(), randomPattern(other, 20)));
    EXPECT_EQ(one.bytes(), other.bytes());
    EXPECT_THAT(one.bytes(), HasSubstr("guide: guides/tree.png\n"));
    EXPECT_THAT(one.bytes(), HasSubstr("  - file: shapes/sculpture.obj\n"));
}

TEST(PatternFile, what_is_wrong_is_refused_with_place_and_advice) {
    EXPECT_EQ(refusalAfter("seed:", "sead:"), "tree.pattern.yaml:7:1: sead: unknown key (did you mean 'seed'?)");
    EXPECT_EQ(refusalAfter("colour: [0, 0", "color: [0, 0"),
              "tree.pattern.yaml:17:83: instances[1].color: unknown key (did you mean 'colour'?)");
    EXPECT_EQ(refusalAfter("beta", "betta"),
              "tree.pattern.yaml:14:16: motion.local_tilt.betta: unknown key (did you mean 'beta'?)");
    EXPECT_EQ(refusalAfter("version: 1", "version: 2"),
              "tree.pattern.yaml:2:10: version: version 2 was written by a newer program, this one reads up to 1; update it");
    EXPECT_THAT(refusalAfter("fantascope: pattern", "fantascope: show"),
                HasSubstr("this is a show file, a pattern file is needed here"));
    EXPECT_EQ(refusalAfter("shape: 1", "shape: 2"),
              "tree.pattern.yaml:16:20: instances[0].shape: 2 is out of range, 0 .. 1 is allowed");
    EXPECT_EQ(refusalAfter("group: 1", "group: 2"),
              "tree.pattern.yaml:17:30: instances[1].group: 2 is out of range, 0 .. 1 is allowed");
    EXPECT_EQ(refusalAfter("id: 7", "id: 3"),
              "tree.pattern.yaml:17:5: instances[1]: id 3 is given twice; every instance needs its own");
    EXPECT_THAT(refusalAfter("size: 0.05", "size: .nan"),
                HasSubstr(":16:60: instances[0].size: a number in 1e-06 .. 10 canvas heights"));
    EXPECT_THAT(refusalAfter("size: 0.05", "size: nan"), HasSubstr("instances[0].size: a number"));
    EXPECT_THAT(refusalAfter("size: 0.05", "size: 0"), HasSubstr("instances[0].size: 0 is out of range"));
    EXPECT_THAT(refusalAfter("[1.5, 1]", "[1.8, 1]"), HasSubstr("instances[1].centre[0]: 1.8 is out of range"));
    EXPECT_THAT(refusalAfter("[1.5, 1]", "[1.5, 1.1]"), HasSubstr("instances[1].centre[1]: 1.1 is out of range"));
    EXPECT_THAT(refusalAfter("-20", "-361"), HasSubstr("instances[0].rotation[1]: -361 is out of range, -360 .. 360 degrees"));
    EXPECT_THAT(refusalAfter("0.1]}", "1.1]}"), HasSubstr("instances[0].colour[2]: 1.1 is out of range"));
    EXPECT_THAT(refusalAfter("[640, 360]", "[640, 0]"), HasSubstr("size[1]: 0 is out of range"));
    EXPECT_THAT(refusalAfter("groups: 2", "groups: 0"), HasSubstr("groups: 0 is out of range"));
    EXPECT_THAT(refusalAfter("seed: 9", "seed: -1"), HasSubstr("seed: -1 is out of range"));
}

TEST(PatternFile, a_shape_or_guide_that_cannot_be_had_is_refused_with_the_patterns_place) {
    EXPECT_THAT(refusalAfter("sculpture.obj", "absent.obj"), StartsWith("tree.pattern.yaml:11:12: shapes[1].file: "));
    EXPECT_THAT(refusalAfter("sculpture.obj", "absent.obj"), HasSubstr("absent.obj"));
    EXPECT_THAT(refusalAfter("shapes/sculpture.obj", "/sculpture.obj"),
                HasSubstr(":11:12: shapes[1].file: '/sculpture.obj' is absolute"));
    EXPECT_THAT(refusalAfter("guides/tree.png", "/tree.png"), HasSubstr(":3:8: guide: '/tree.png' is absolute"));
    EXPECT_THAT(refusalAfter("guides/tree.png", "../tree.png"), HasSubstr("guide: '../tree.png' leaves this file's folder"));
    EXPECT_THAT(refusalAfter("{builtin: triangle}", "{builtin: triangel}"),
                HasSubstr(":10:15: shapes[0].builtin: 'triangel' is no built-in shape; there are "));
    EXPECT_THAT(refusalAfter("{builtin: triangle}", "{builtin: triangel}"), HasSubstr("(did you mean 'triangle'?)"));
    EXPECT_THAT(refusalAfter("{builtin: triangle}", "{}"),
                HasSubstr(":10:5: shapes[0]: exactly one of 'builtin' and 'file' is needed"));
    EXPECT_THAT(refusalAfter("{builtin: triangle}", "{builtin: square, file: shapes/sculpture.obj}"),
                HasSubstr(":10:5: shapes[0]: exactly one of 'builtin' and 'file' is needed"));

    const PatternFolder folder;
    folder.file("shapes/sculpture.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    const auto pattern = readPattern(folder.file("tree.pattern.yaml", kPattern));
    ASSERT_FALSE(pattern);
    EXPECT_THAT(pattern.error().message(), StartsWith(folder.pattern().string() + ":11:12: shapes[1].file: "));
    EXPECT_THAT(pattern.error().message(), HasSubstr("has no triangles"));
}

// A failed search must not destroy an earlier pattern.
TEST(PatternFile, what_could_not_be_read_again_is_not_written) {
    const PatternFolder folder;
    const ShapePattern good = sample(folder);
    const auto expectRefusal = [&](auto spoil, const std::string& why) {
        ShapePattern bad = good;
        spoil(bad);
        const auto written = writePattern(folder.pattern(), bad);
        ASSERT_FALSE(written) << why;
        EXPECT_THAT(written.error().message(), HasSubstr(why));
        EXPECT_EQ(folder.bytes(), kPattern);
    };
    expectRefusal([](ShapePattern& p) { p.instances[0].size = std::nan(""); }, "instances[0].size");
    expectRefusal([](ShapePattern& p) { p.instances[0].rotation.y = std::nan(""); }, "instances[0].rotation[1]");
    expectRefusal([](ShapePattern& p) { p.instances[1].id = 3; }, "id 3 is given twice");
    expectRefusal([](ShapePattern& p) { p.shapes.pop_back(); }, "instances[0].shape");
    expectRefusal([](ShapePattern& p) { p.guide = "/elsewhere/tree.png"; }, "lies outside its folder");
    expectRefusal([](ShapePattern& p) { p.shapes[1].file = "/elsewhere/sculpture.obj"; }, "lies outside its folder");
    expectRefusal([](ShapePattern& p) { p.guide.clear(); }, "lies outside its folder");
}

std::string motionRefusal(const std::string& motion) {
    const auto read = readMotion(ConfigNode::parse(motion, "m.yaml").value());
    return read ? "accepted" : read.error().message();
}

// The motion can be computed and is finite at both ends of every range, so no accepted file stops
// the program.
TEST(MotionFile, the_bounds_of_every_key_can_be_moved) {
    const PatternFolder folder;
    for (const std::string frames : {"4", "1000"})
        for (const std::string rest : {"rate: 1, deviation: 0, instances_per_group: 1, fuzziness: 1.01, direction: -360",
                                       "rate: 240, deviation: 1, instances_per_group: 100000, fuzziness: 10, direction: 360"})
            for (const std::string beta : {"0", "10"})
                for (const std::string frequency : {"0.01", "100"})
                    for (const std::string damping : {"0.001", "0.999"})
                        for (const std::string amounts : {"magnitude: 0, range: 0", "magnitude: 10, range: 1"}) {
                            std::string text = "{frames: " + frames + ", " + rest;
                            for (const std::string axis :
                                 {"group_major", "group_minor", "local_translation", "local_tilt", "local_turn"})
                                text += ", " + axis + ": {beta: " + beta + ", natural_frequency: " + frequency +
                                        ", damping: " + damping + ", " + amounts + "}";
                            ShapePattern pattern = sample(folder);
                            const auto motion = readMotion(ConfigNode::parse(text + "}", "m.yaml").value());
                            ASSERT_TRUE(motion) << motion.error().message();
                            pattern.motion = *motion;
                            const PatternMotion moved(pattern, 1);
                            std::vector<InstancePose> poses(pattern.instances.size());
                            moved.posesAt(moved.period() / 3, {}, poses);
                            for (const InstancePose& pose : poses)
                                EXPECT_TRUE(std::isfinite(pose.centre.x + pose.centre.y + pose.rotation.x + pose.rotation.y +
                                                          pose.rotation.z))
                                    << text;
                        }
}

TEST(MotionFile, what_lies_beyond_the_bounds_is_refused) {
    EXPECT_EQ(motionRefusal("frames: 7"), "m.yaml:1:9: frames: 7 is odd, must be even");
    EXPECT_EQ(motionRefusal("frames: 2"), "m.yaml:1:9: frames: 2 is out of range, 4 .. 20000 is allowed");
    EXPECT_EQ(motionRefusal("group_minor: {damping: 1}"),
              "m.yaml:1:24: group_minor.damping: 1 is out of range, 0.001 .. 0.999 is allowed");
    for (const std::string motion :
         {"frames: 20002", "rate: 0", "rate: 241", "deviation: -0.1", "deviation: 1.1", "direction: 361",
          "instances_per_group: 0", "fuzziness: 1", "group_major: {damping: 0}", "group_major: {beta: -1}",
          "group_major: {natural_frequency: 0}", "group_major: {magnitude: -1}", "group_major: {range: 1.1}",
          "local_turn: {range: 361}", "local_turn: {range: -1}"})
        EXPECT_THAT(motionRefusal(motion), HasSubstr("is out of range")) << motion;
    EXPECT_EQ(motionRefusal("local_turn: {range: 360}"), "accepted");
}

// All words between an opening and a closing mark.
std::set<std::string> keysBetween(const std::string& text, const std::string& open, const std::string& close) {
    std::set<std::string> keys;
    for (std::size_t end = 0; (end = text.find(close, end)) != std::string::npos; ++end) {
        const std::size_t begin = text.find_last_not_of("abcdefghijklmnopqrstuvwxyz_", end - 1) + 1;
        if (begin < end && begin >= open.size() && text.substr(begin - open.size(), open.size()) == open)
            keys.insert(text.substr(begin, end - begin));
    }
    return keys;
}

// A written pattern has every key, so the document must explain exactly its keys.
TEST(PatternDocs, explain_every_key_and_no_other) {
    const PatternFolder folder;
    ASSERT_TRUE(writePattern(folder.pattern(), sample(folder)));
    const std::string document = readFile(std::filesystem::path(sourceFolder()) / "docs/pattern-format.md").value();
    EXPECT_EQ(keysBetween(document, "\n| `", "`"), keysBetween(folder.bytes(), "", ":"));

    const std::size_t example = document.find("```yaml\n") + 8;
    EXPECT_EQ(refusal(document.substr(example, document.find("```\n", example) - example)), "accepted");
}

}  // namespace
}  // namespace fantascope::pattern
