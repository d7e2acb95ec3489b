#include "theatre/stage/stage_file.h"

#include "theatre/energy/pose_hints.h"
#include "theatre/energy/pose_problem.h"
#include "theatre/stage/stage_set.h"

#include "core/file.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <utility>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A cube of 2 units from its origin to the right, up and towards +z.
constexpr std::string_view kCube = R"(v 0 0 0
v 2 0 0
v 2 2 0
v 0 2 0
v 0 0 2
v 2 0 2
v 2 2 2
v 0 2 2
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 3 4 8 7
f 1 5 8 4
f 2 3 7 6
)";

class StageFile : public testing::Test {
protected:
    StageFile() { EXPECT_TRUE(writeFile(folder_ / "cube.obj", kCube)); }
    Result<Stage> read(const std::string& rest) {
        EXPECT_TRUE(writeFile(folder_ / "a.stage.yaml", "fantascope: stage\nversion: 1\n" + rest));
        return readStage(folder_ / "a.stage.yaml");
    }
    std::string refusal(const std::string& rest) {
        const auto stage = read(rest);
        return stage ? "read" : stage.error().message();
    }
    ScratchFolder folder_;
};

TEST_F(StageFile, of_a_lamp_is_no_more_than_that) {
    const auto stage = read("light: [0.5, 0.1, 6]\n");
    ASSERT_TRUE(stage) << stage.error().message();
    EXPECT_EQ(stage->beams[0].light, glm::dvec3(0.5, 0.1, 6));
    EXPECT_FALSE(stage->beams[0].lit || stage->standing);
    EXPECT_TRUE(stage->platforms.empty() && stage->props.empty());
}

TEST_F(StageFile, says_all_of_a_stage) {
    const auto stage = read(R"(projector:
  lens: [0, 0.3, 7]
  picture: {x: [-2, 2.5], y: [0, 3]}
standing: {z: [0.5, 4]}
platforms:
  - {name: step, centre: [1, 0.2, 2], size: [1, 0.4, 0.5], turned: 30}
props:
  - {name: rock, mesh: cube.obj, scale: 0.5, at: [1, 0, 3], turned: [0, 90, 0]}
  - {name: hat, mesh: cube.obj, scale: 0.1, at: [0, 0.05, 0], held_by: {actor: 2, part: head}}
)");
    ASSERT_TRUE(stage) << stage.error().message();
    EXPECT_EQ(stage->beams[0].light, glm::dvec3(0, 0.3, 7));
    ASSERT_TRUE(stage->beams[0].lit && stage->standing);
    EXPECT_EQ(stage->beams[0].lit->from, glm::dvec2(-2, 0));
    EXPECT_EQ(stage->beams[0].lit->to, glm::dvec2(2.5, 3));
    EXPECT_EQ(stage->standing->outside({1000, 1}), 0) << "as far to the sides as one likes";
    EXPECT_NEAR(stage->standing->outside({0, 4.25}), 0.25, 1e-12);
    ASSERT_EQ(stage->platforms.size(), 1u);
    EXPECT_EQ(stage->platforms[0].centre, glm::dvec3(1, 0.2, 2));
    EXPECT_EQ(stage->platforms[0].size, glm::dvec3(1, 0.4, 0.5));
    EXPECT_EQ(stage->platforms[0].turn, radians(30));
    ASSERT_EQ(stage->props.size(), 2u);
    const Prop &rock = stage->props[0], &hat = stage->props[1];
    EXPECT_FALSE(rock.holder);
    // A cube of 1 m; its frame's +x is the stage's -z.
    EXPECT_LT(glm::distance(rock.place + rock.turn * glm::dvec3(1, 0, 0), {1, 0, 2}), 1e-9);
    glm::dvec3 outward;
    EXPECT_NEAR(rock.shape->distance.at({0.5, 0.5, 0.5}, outward), -0.5, 0.02);
    EXPECT_NEAR(rock.shape->distance.at({0.5, 0.5, 1.1}, outward), 0.1, 1e-3);
    ASSERT_TRUE(hat.holder);
    EXPECT_EQ(hat.holder->actor, 1u) << "people count from one";
    EXPECT_EQ(hat.holder->part, BodyPart::Head);
    EXPECT_EQ(hat.place, glm::dvec3(0, 0.05, 0));
}

TEST_F(StageFile, is_refused_where_the_light_is_wrong) {
    EXPECT_THAT(refusal("light: [0, 0, -2]\n"), AllOf(HasSubstr("a.stage.yaml:3:8: light"), HasSubstr("2 m behind the screen")));
    EXPECT_THAT(refusal("light: [0, 0, 0.2]\n"), HasSubstr("nobody fits between"));
    EXPECT_THAT(refusal("light: [0, -0.5, 5]\n"), HasSubstr("0.5 m below the floor"));
    EXPECT_THAT(refusal("projector: {lens: [0, 1, -3], picture: {x: [-1, 1], y: [0, 2]}}\n"),
                AllOf(HasSubstr("projector.lens"), HasSubstr("behind")));
    EXPECT_THAT(refusal("projector: {lens: [0, 1, 3], picture: {x: [1, -1], y: [0, 2]}}\n"),
                AllOf(HasSubstr("projector.picture.x"), HasSubstr("smaller number comes first")));
    EXPECT_THAT(refusal("projector: {lens: [0, 1, 3]}\n"), HasSubstr("picture"));
    EXPECT_THAT(refusal("light: [0, 0, 5]\nprojector: {lens: [0, 1, 3], picture: {x: [-1, 1], y: [0, 2]}}\n"),
                HasSubstr("take either away"));
    EXPECT_THAT(refusal("standing: {z: [0.5, 4]}\n"), HasSubstr("no light"));
}

TEST_F(StageFile, is_refused_where_a_thing_cannot_be) {
    const std::string light = "light: [0, 0.5, 5]\n";
    EXPECT_THAT(refusal(light + "standing: {z: [1, 6]}\n"), AllOf(HasSubstr("standing.z"), HasSubstr("throws no shadow")));
    EXPECT_THAT(refusal(light + "standing: {z: [-1, 3]}\n"), HasSubstr("out of range"));
    EXPECT_THAT(refusal(light + "standing: {y: [0, 1]}\n"), HasSubstr("unknown key"));
    const auto platform = [&](const std::string& rest) {
        return refusal(light + "platforms:\n  - {name: step, " + rest + "}\n");
    };
    EXPECT_EQ(platform("centre: [0, 0.2, 2], size: [1, 0.4, 1]"), "read");
    EXPECT_THAT(platform("centre: [0, 0.1, 2], size: [1, 0.4, 1]"),
                AllOf(HasSubstr("a.stage.yaml:5:5: platforms[0]"), HasSubstr("'step' reaches 0.100 m below the floor"),
                      HasSubstr("0.2")));
    EXPECT_THAT(platform("centre: [0, 0.2, 0.3], size: [1, 0.4, 1]"), HasSubstr("0.200 m through the screen"));
    EXPECT_THAT(platform("centre: [0, 0.2, 0.6], size: [2, 0.4, 1], turned: 90"), HasSubstr("0.400 m through the screen"));
    EXPECT_THAT(platform("centre: [0, 0.5, 5], size: [1, 1, 1]"), HasSubstr("light is inside platform 'step'"));
    EXPECT_THAT(platform("centre: [0, 0.2, 2], size: [1, 0, 1]"), HasSubstr("size"));
    const auto prop = [&](const std::string& rest) { return refusal(light + "props:\n  - {name: rock, " + rest + "}\n"); };
    EXPECT_EQ(prop("mesh: cube.obj, at: [0, 0, 2]"), "read");
    EXPECT_THAT(prop("mesh: none.obj, at: [0, 0, 2]"), AllOf(HasSubstr("props[0].mesh"), HasSubstr("none.obj")));
    EXPECT_THAT(prop("mesh: cube.obj, scale: 100, at: [0, 0, 2]"),
                AllOf(HasSubstr("200 m long"), HasSubstr("0.01 for centimetres")));
    EXPECT_THAT(prop("mesh: cube.obj, at: [0, -0.25, 2]"), HasSubstr("0.250 m below the floor"));
    EXPECT_THAT(prop("mesh: cube.obj, at: [0, 0, -0.5]"), HasSubstr("0.500 m through the screen"));
    EXPECT_THAT(prop("mesh: cube.obj, at: [0, 0, 3.5]"), HasSubstr("reaches to z = 5.500 m, and the light is at 5 m"));
    EXPECT_THAT(prop("mesh: cube.obj, held_by: {actor: 0, part: head}"), HasSubstr("held_by.actor"));
    EXPECT_THAT(prop("mesh: cube.obj, held_by: {actor: 1, part: hands}"),
                AllOf(HasSubstr("held_by.part"), HasSubstr("left hand")));
    EXPECT_THAT(prop("mesh: cube.obj, at: [0, -4, 0], held_by: {actor: 1, part: head}"), HasSubstr("-3 .. 3 m"));
    EXPECT_THAT(refusal(light + "platforms:\n  - {name: rock, centre: [0, 0.2, 2], size: [1, 0.4, 1]}\n"
                                "props:\n  - {name: rock, mesh: cube.obj, at: [0, 0, 2]}\n"),
                HasSubstr("two things are called 'rock'"));
}

TEST_F(StageFile, says_all_of_further_beams_and_curved_screens) {
    const auto stage = read(R"(light: [0, 0, 7]
screen: {radius: 4}
further_beams:
  - {light: [-6, 0, 5], screen: {at: [2.5, 0, 5], turned: -90, radius: -5}}
  - {light: [1, 0, 6.3]}
  - projector: {lens: [-5, 0.3, 5], picture: {x: [-2, 2], y: [0, 3]}}
    screen: {at: [2.5, 0, 5], turned: -90, radius: -5}
)");
    ASSERT_TRUE(stage) << stage.error().message();
    EXPECT_EQ(stage->beams[0].light, glm::dvec3(0, 0, 7));
    ASSERT_EQ(stage->beams.size(), 4u);
    ASSERT_EQ(stage->screens.size(), 2u) << "the same screen once";
    EXPECT_EQ(stage->screens[0], (Screen{{0, 0}, 0, 4}));
    EXPECT_EQ(stage->screens[1], (Screen{{2.5, 5}, radians(-90), -5}));
    EXPECT_EQ(&stage->screenOf(2), &stage->screens[0]);
    EXPECT_EQ(&stage->screenOf(3), &stage->screens[1]);
    EXPECT_EQ(stage->beams[2].light, glm::dvec3(1, 0, 6.3));
    ASSERT_TRUE(stage->beams[3].lit);
    EXPECT_EQ(stage->beams[3].lit->to, glm::dvec2(2, 3));
    EXPECT_FALSE(stage->beams[1].lit || stage->beams[0].lit);
}

TEST_F(StageFile, is_refused_where_a_beam_cannot_be) {
    const std::string light = "light: [0, 0, 7]\n";
    const auto beam = [&](const std::string& rest) { return refusal(light + "further_beams:\n  - {" + rest + "}\n"); };
    EXPECT_EQ(beam("light: [-6, 0, 1.5], screen: {at: [2.5, 0, 1.5], turned: -90}"), "read");
    EXPECT_THAT(beam("light: [-6, 0, 1.5], screen: {at: [2.5, 0, 1.5], turned: 90}"),
                AllOf(HasSubstr("a.stage.yaml:5:5: further_beams[0]"), HasSubstr("8.5 m behind its screen"), HasSubstr("180")));
    EXPECT_THAT(beam("light: [2.2, 0, 1.5], screen: {at: [2.5, 0, 1.5], turned: -90}"),
                AllOf(HasSubstr("0.3 m in front of its screen"), HasSubstr("0.5 m or farther")));
    EXPECT_THAT(beam("light: [3, -1, 6]"), HasSubstr("1 m below the floor"));
    EXPECT_THAT(beam("light: [3, 0, -6]"), HasSubstr("behind its screen"));
    EXPECT_THAT(beam("light: [0, 0, 7]"), HasSubstr("beam 1 over again"));
    EXPECT_THAT(beam("screen: {at: [2.5, 0, 1.5], turned: -90}"), HasSubstr("no light"));
    EXPECT_THAT(beam("light: [-6, 0, 1.5], screen: {turned: -90}"), HasSubstr("at"));
    EXPECT_THAT(beam("light: [-6, 0, 1.5], screen: {at: [2.5, 1, 1.5], turned: -90}"), HasSubstr("a y of 0"));
    EXPECT_THAT(beam("light: [-6, 0, 1.5], screen: {at: [2.5, 0, 1.5], turned: -90, radius: 0.5}"),
                AllOf(HasSubstr("radius"), HasSubstr("a pillar")));
    EXPECT_THAT(beam("light: [-6, 0, 1.5], screen: {at: [-1, 0, 1.5], turned: -90}"),
                HasSubstr("the light of beam 1 is behind screen 2"));
    EXPECT_THAT(beam("light: [-6, 0, -3], screen: {at: [2.5, 0, 1.5], turned: -90}"),
                HasSubstr("the light of beam 2 is behind the screen, which is at z = 0"));
    EXPECT_THAT(refusal(light + "further_beams: []\n"), HasSubstr("further_beams"));
    EXPECT_THAT(refusal(light + "screen: {radius: 0}\n"), AllOf(HasSubstr("screen.radius"), HasSubstr("leave 'radius' out")));
    EXPECT_THAT(refusal(light + "screen: {at: [0, 0, 1]}\n"), HasSubstr("unknown key"));
    EXPECT_THAT(refusal("light: [4, 0, 2]\nscreen: {radius: 3}\n"), HasSubstr("in front of its screen"));
    const std::string corner = light + "further_beams: [{light: [-6, 0, 1.5], screen: {at: [2.5, 0, 1.5], turned: -90}}]\n";
    EXPECT_THAT(refusal(corner + "platforms:\n  - {name: step, centre: [2.3, 0.2, 2], size: [1, 0.4, 1]}\n"),
                HasSubstr("platform 'step' reaches 0.300 m through screen 2"));
    EXPECT_THAT(refusal(corner + "props:\n  - {name: rock, mesh: cube.obj, at: [1, 0, 2]}\n"),
                HasSubstr("prop 'rock' reaches 0.500 m through screen 2"));
    EXPECT_THAT(refusal(corner + "platforms:\n  - {name: step, centre: [-6, 0.2, 1.5], size: [1, 0.4, 1]}\n"),
                HasSubstr("the light of beam 2 is inside platform 'step'"));
    // A bulge that reaches the platform's back, not its corners.
    EXPECT_THAT(
        refusal(
            "light: [0, 0, 7]\nscreen: {radius: -2}\nplatforms:\n  - {name: step, centre: [0, 0.2, 0.3], size: [3, 0.4, 1]}\n"),
        HasSubstr("through the screen"));
}

// What is bounded by a mesh: each edge has one face on either side, and all look outwards.
bool isClosed(const TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double volume = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        for (const auto& edge : {std::pair(t.x, t.y), std::pair(t.y, t.z), std::pair(t.z, t.x)}) ++edges[edge];
        volume +=
            glm::dot(glm::dvec3(mesh.vertices[t.x]), glm::cross(glm::dvec3(mesh.vertices[t.y]), glm::dvec3(mesh.vertices[t.z])));
    }
    return volume > 0 && std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
               const auto back = edges.find({edge.first.second, edge.first.first});
               return edge.second == 1 && back != edges.end() && back->second == 1;
           });
}

// Example failure: a wheel whose tyre looks inwards pushes everybody into itself.
TEST(ProjectsProps, are_solids_and_their_hints_are_of_the_drawings) {
    const std::filesystem::path assets = sourceFolder() + "/assets";
    int standing = 0, held = 0, hints = 0;
    for (const auto& [name, played, height] : {std::tuple("car", "car", 1.6),
                                               {"airplane", "airplane", 2.3},
                                               {"airplane", "airplane-worn", 2.3},
                                               {"violin", "violin", 2.3}}) {
        const auto stage = readStage(assets / "props" / (std::string(played) + ".stage.yaml"));
        ASSERT_TRUE(stage) << stage.error().message();
        const auto target =
            PoseTarget::from(readGrey(assets / "silhouettes" / (std::string(name) + ".png")).value(), *stage, height, 512)
                .value();
        BitMask shadow(target.mask.width(), target.mask.height());
        for (const Prop& prop : stage->props) {
            EXPECT_TRUE(isClosed(prop.shape->mesh)) << prop.name;
            EXPECT_LT(prop.shape->mesh.triangles.size(), 700u) << prop.name;
            ++(prop.holder ? held : standing);
            if (!prop.holder) addShadow(target.frame, meshOf(PlacedProp{&prop, 0, prop.place, prop.turn}), shadow);
        }
        // What stands has its shadow where the drawing is white.
        EXPECT_GE(static_cast<double>(shared(shadow, target.mask)), 0.99 * static_cast<double>(shadow.count())) << played;
        const auto file = assets / "props" / (std::string(name) + ".hints.yaml");
        if (!std::filesystem::exists(file)) continue;
        const auto read = readHints(file, target, *stage);
        EXPECT_TRUE(read) << read.error().message();
        hints += static_cast<int>(read->size());
    }
    EXPECT_EQ(standing, 2);
    EXPECT_EQ(held, 5);
    EXPECT_EQ(hints, 10);
}

}  // namespace
}  // namespace fantascope::theatre
