// Prints of people in T-poses, whose shadows and places are known.

#include "theatre/print/fabrication.h"

#include "theatre/a_scene.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::Field;
using testing::Gt;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Small and coarse: what holds here holds for a finer one.
constexpr Fabrication::Options kOptions{.height = 40, .plate = 3, .margin = 6, .wall = 1, .cell = 0.3};

struct Scene {
    PoseProblem problem;
    std::vector<double> poses;
};
// Of 1.7 m each, at these x, their feet this high above the floor.
Scene aScene(const std::vector<double>& x, const std::vector<double>& heights) {
    Scene scene{theatre::aScene(std::vector<double>(x.size(), 1.7)), {}};
    scene.problem.buildSkins();
    scene.poses = aRow(scene.problem, x, 2);
    for (std::size_t i = 0; i < heights.size(); ++i) scene.poses[scene.problem.firstDof(i) + 1] += heights[i];
    makeTarget(scene.problem, scene.poses);
    return scene;
}
Fabrication print(const Scene& scene, const Fabrication::Options& options = kOptions) {
    auto made = fabricate(scene.problem, scene.poses, options, {});
    EXPECT_TRUE(made) << made.error().message();
    return std::move(made).value();
}
std::string refusal(const Scene& scene, const Fabrication::Options& options, const FabricationWatch& watch = {}) {
    const auto made = fabricate(scene.problem, scene.poses, options, watch);
    return made ? "made" : made.error().message();
}

// The area of a section across z, by the segments in which the triangles cut it.
double sectionOf(const TriangleMesh& mesh, float z) {
    double twice = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        std::vector<glm::dvec2> ends(2);
        std::size_t cuts = 0;
        for (int i = 0; i < 3; ++i) {
            const glm::vec3 &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
            if ((a.z < z) == (b.z < z)) continue;
            ends[a.z < z ? 0 : 1] = glm::mix(glm::dvec2(a), glm::dvec2(b), double(z - a.z) / (b.z - a.z));
            ++cuts;
        }
        if (cuts == 2) twice += ends[0].x * ends[1].y - ends[0].y * ends[1].x;
    }
    return 0.5 * std::abs(twice);
}

TEST(Fabrication, a_person_becomes_one_solid_with_the_same_shadow) {
    const Fabrication made = print(aScene({0.2}, {}));
    EXPECT_TRUE(made.check.isSound());
    EXPECT_EQ(made.check.pieces, 1u);
    glm::vec3 least(std::numeric_limits<float>::max()), most(-least);
    for (const glm::vec3& v : made.mesh.vertices) least = glm::min(least, v), most = glm::max(most, v);
    EXPECT_NEAR(least.z, -3, 0.1) << "the plate";
    EXPECT_NEAR(most.z, 40, 0.3);
    EXPECT_GT(made.shadowIou, 0.96) << "with hands of a millimetre, at four centimetres";
    EXPECT_EQ(made.posesIou, 1);
    EXPECT_THAT(made.rods, IsEmpty());
    // The lamp, 7 m in front of the screen.
    EXPECT_NEAR(made.screen - made.light.y, 7 * made.scale, 1e-9);
    EXPECT_NEAR(made.light.z, 0.1 * made.scale, 1e-9);
    // Its origin is in the plate's middle.
    glm::dvec2 low(1e9), high(-1e9);
    for (const glm::dvec2& p : made.plate) low = glm::min(low, p), high = glm::max(high, p);
    EXPECT_NEAR(glm::length(low + high), 0, 1e-6);
    for (const glm::vec3& v : made.mesh.vertices)
        if (v.z < -1) {
            EXPECT_GT(v.x, low.x - 0.2);
            EXPECT_LT(v.y, high.y + 0.2);
        }
    // Both feet stand.
    ASSERT_THAT(made.contacts, SizeIs(2));
    EXPECT_NE(made.contacts[0].who, made.contacts[1].who);
}

TEST(Fabrication, a_larger_print_has_the_shadow_to_a_hundredth) {
    Fabrication::Options options = kOptions;
    options.height = 90;
    EXPECT_GT(print(aScene({0.2}, {}), options).shadowIou, 0.99);
}

// The distance that poses are found to is not one that a print can leave open.
TEST(Fabrication, feet_that_hover_a_little_are_joined_to_the_plate) {
    const Fabrication made = print(aScene({0}, {0.02}));
    EXPECT_EQ(made.check.pieces, 1u);
    EXPECT_THAT(made.rods, IsEmpty());
    EXPECT_THAT(made.warnings, IsEmpty());
    ASSERT_THAT(made.contacts, SizeIs(2));
    for (const auto& contact : made.contacts) EXPECT_NEAR(contact.gap, 0.02 * made.scale, 0.002 * made.scale);
}

TEST(Fabrication, who_stands_on_nothing_is_named_and_held) {
    const Fabrication made = print(aScene({-0.9, 0.9}, {0, 0.5}));
    EXPECT_TRUE(made.check.isSound());
    EXPECT_EQ(made.check.pieces, 1u);
    EXPECT_THAT(made.warnings, Contains(AllOf(HasSubstr("actor 2"), HasSubstr("stands on nothing"))));
    ASSERT_THAT(made.rods, SizeIs(1));
    EXPECT_EQ(made.rods[0].who, "actor 2");
    // From 50 cm above the plate, and from the other's hand: no shorter than that, and hardly
    // longer.
    EXPECT_GT(made.rods[0].length, 0.5 * made.scale - 2 * made.cell);
    EXPECT_LT(made.rods[0].length, 0.6 * made.scale);
}

// Example failure: a hand below the plate, and the print rocks on the bed.
TEST(Fabrication, what_has_sunk_into_the_floor_does_not_come_out_below) {
    const Fabrication made = print(aScene({0}, {-0.3}));
    float least = 0;
    for (const glm::vec3& v : made.mesh.vertices) least = std::min(least, v.z);
    EXPECT_NEAR(least, -3, 0.1);
    EXPECT_EQ(made.check.pieces, 1u);
}

// What stands is joined by all that it stands on.
TEST(Fabrication, a_prop_that_hovers_a_little_is_joined) {
    Scene scene = aScene({0}, {});
    scene.problem.stage.props.push_back(aBox({0.6, 0.4, 0.4}, {1, 0.23, 2}));
    makeTarget(scene.problem, scene.poses);
    const Fabrication made = print(scene);
    EXPECT_THAT(made.rods, IsEmpty());
    double volume = 0;
    for (const bool isThere : {true, false}) {
        if (!isThere) scene.problem.stage.props.clear();
        volume += (isThere ? 1 : -1) * print(scene).check.volume;
    }
    // Down to the floor: 0.43 of its 0.4 m; the plate reaches farther for it.
    EXPECT_GT(volume, 0.6 * 0.425 * 0.4 * std::pow(made.scale, 3));
}

// Leaning forward, on the tips of the toes.
Scene onTiptoe() {
    Scene scene = aScene({0}, {});
    const glm::dvec3 turn = vectorOf(rotationOf({0, std::numbers::pi, 0}) * rotationOf({0.5, 0, 0}));
    for (int i = 0; i < 3; ++i) scene.poses[static_cast<std::size_t>(3 + i)] = turn[i];
    SceneEnergy energy(scene.problem);
    energy.pose(scene.poses);
    double lowest = 1;
    for (const glm::vec3& v : energy.skin(0)) lowest = std::min(lowest, double{v.y});
    scene.poses[1] -= lowest;
    makeTarget(scene.problem, scene.poses);
    return scene;
}

// A lamp on the floor sees all of the feet; in pixels of 4 mm.
void seenFromTheFloor(Scene& scene) {
    scene.problem.stage.beams[0].light.y = 0;
    scene.problem.targets[0] = {ScreenFrame(scene.problem.stage, -1.8, 2.8, 0.004, 1000, 720), BitMask(1000, 720), 0, {}, 2};
    makeTarget(scene.problem, scene.poses);
}

// Of the print's shadow, in pixels: what is outside the poses' between two heights above the floor,
// metres on the screen.
int beside(const Scene& scene, const Fabrication& made, double from, double to) {
    const ScreenFrame& frame = scene.problem.targets[0].frame;
    int count = 0;
    for (int y = static_cast<int>(frame.pixelAt(0, to).y); y < static_cast<int>(frame.pixelAt(0, from).y); ++y)
        for (int x = 0; x < frame.width(); ++x) count += made.shadow.at(x, y) && !scene.problem.targets[0].mask.at(x, y);
    return count;
}

// A foot of the print's own is seen close over the plate, and higher only where the poses hide it.
// What stands on a point hides nothing.
TEST(Fabrication, a_small_contact_is_reinforced_behind_the_poses) {
    Scene scene = aScene({0}, {});
    const TriangleMesh spike{{{0, 0, 0}, {-0.1f, 1, -0.1f}, {0.1f, 1, -0.1f}, {0.1f, 1, 0.1f}, {-0.1f, 1, 0.1f}},
                             {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {1, 4, 3}, {1, 3, 2}}};
    scene.problem.stage.props.push_back(
        {"spike", {}, std::make_shared<const Prop::Shape>(spike), std::nullopt, {1.2, 0, 2}, {1, 0, 0, 0}});
    seenFromTheFloor(scene);
    Fabrication::Options options = kOptions;
    options.height = 90, options.wall = 0.3;  // so that the spike itself stays as thin as it is
    const Fabrication made = print(scene, options);
    const auto contact =
        std::find_if(made.contacts.begin(), made.contacts.end(), [](const auto& c) { return c.who == "prop 'spike'"; });
    ASSERT_NE(contact, made.contacts.end());
    EXPECT_GT(contact->reinforcedBy, 2) << "16 square millimetres around a point";
    EXPECT_GT(beside(scene, made, 0.004, 0.014), 30);
    EXPECT_LT(beside(scene, made, 0.02, 0.05), 25) << "58 pixels if it stood in the light";
}

// Feet of this print are some 5 mm long; one that leans on a toe has less.
TEST(Fabrication, a_small_contact_is_reinforced_and_the_shadow_stays) {
    const Scene scene = onTiptoe();
    const Fabrication made = print(scene);
    ASSERT_FALSE(made.contacts.empty());
    EXPECT_THAT(made.contacts, Each(Field(&Fabrication::Contact::reinforcedBy, Gt(0.0))));
    EXPECT_GT(made.shadowIou, 0.95);
    // Close over the plate the print is as wide as bears a figure of its height, not as the toes.
    const double firm = 20 * 0.4 * 0.4;
    for (const auto& contact : made.contacts) EXPECT_LT(contact.area, firm);
    EXPECT_GT(sectionOf(made.mesh, 0.1f), 0.8 * firm * static_cast<double>(made.contacts.size()));
}

TEST(Fabrication, what_is_thinner_than_a_wall_becomes_as_thick) {
    const Scene scene = aScene({0}, {});
    const Fabrication made = print(scene);
    EXPECT_THAT(made.thin, Contains(Field(&Fabrication::ThinPart::who, HasSubstr("wrist"))))
        << "fingers are half a millimetre thick";
    for (const auto& part : made.thin) {
        EXPECT_LT(part.thickness, kOptions.wall) << part.who;
        EXPECT_GT(part.height, kOptions.height) << part.who;
    }
    EXPECT_GT(made.thinnestWall, 0.9 * kOptions.wall);
    Fabrication::Options fine = kOptions;
    fine.wall = 0.25;
    const Fabrication thinWalled = print(scene, fine);
    EXPECT_THAT(thinWalled.thin, IsEmpty()) << "fingers are twice as thick";
    EXPECT_EQ(thinWalled.thinnestWall, 0.25);
}

TEST(Fabrication, platforms_and_props_are_printed_too) {
    Scene scene = aScene({0}, {0.3});
    scene.problem.stage.platforms.push_back({"step", {0, 0.15, 2}, {0.8, 0.3, 0.6}, 0.2});
    Prop box = aBox({0.3, 0.4, 0.2}, {0.1, 1.4, 2.5});  // in the air, before the breast
    scene.problem.stage.props.push_back(box);
    makeTarget(scene.problem, scene.poses);
    const Fabrication made = print(scene);
    EXPECT_EQ(made.check.pieces, 1u);
    EXPECT_THAT(made.contacts, Contains(Field(&Fabrication::Contact::who, "platform 'step'")));
    EXPECT_THAT(made.warnings, Contains(HasSubstr("prop 'box' touches nothing that stands")));
    EXPECT_GT(made.shadowIou, 0.96) << "the rod that holds it is hidden";
}

TEST(Fabrication, is_the_same_every_time) {
    const Scene scene = aScene({0}, {});
    const Fabrication one = print(scene), other = print(scene);
    EXPECT_EQ(one.mesh.vertices, other.mesh.vertices);
    EXPECT_EQ(one.mesh.triangles, other.mesh.triangles);
}

TEST(Fabrication, refuses_what_cannot_be_printed) {
    const Scene scene = aScene({0}, {});
    const auto with = [](auto change) {
        Fabrication::Options options = kOptions;
        change(options);
        return options;
    };
    EXPECT_THAT(refusal(scene, with([](auto& o) { o.height = 5; })), HasSubstr("height = 5 must be 20 .. 1000 mm"));
    EXPECT_THAT(refusal(scene, with([](auto& o) { o.wall = 0; })), HasSubstr("wall = 0 must be"));
    EXPECT_THAT(refusal(scene, with([](auto& o) { o.cell = 2; })), HasSubstr("plate = 3 mm is too thin"));
    EXPECT_THAT(refusal(scene, with([](auto& o) { o.height = 400, o.cell = 0.06; })), HasSubstr("coarser --detail"));
    EXPECT_THAT(refusal(scene, kOptions, {{}, [] { return true; }}), HasSubstr("interrupted"));
    Scene fallen = aScene({0}, {});
    fallen.poses[1] -= 3;
    EXPECT_THAT(refusal(fallen, kOptions), HasSubstr("nothing to print"));
}

}  // namespace
}  // namespace fantascope::theatre
