#include "theatre/body/body_mesh.h"

#include "theatre/a_person.h"
#include "theatre/a_stage.h"
#include "theatre/random_turns.h"
#include "theatre/stage/capsule_shadow.h"
#include "theatre/stage/mesh_shadow.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace fantascope::theatre {
namespace {

using glm::dquat;
using glm::dvec3;
using glm::vec3;

constexpr dquat kNoTurn{1, 0, 0, 0};

double volumeOf(std::span<const vec3> vertices, const std::vector<glm::uvec3>& triangles) {
    double volume = 0;
    for (const glm::uvec3& t : triangles)
        volume += glm::dot(dvec3(vertices[t.x]), glm::cross(dvec3(vertices[t.y]), dvec3(vertices[t.z]))) / 6;
    return volume;
}
std::vector<vec3> skinOf(const Body& body, const BodyMesh& mesh, std::span<const double> pose) {
    PosedBody posed;
    posed.pose(body, pose);
    std::vector<vec3> vertices;
    mesh.skin(body, posed, vertices);
    return vertices;
}
// Each joint anywhere within its limits, alike often.
std::vector<double> randomPose(const Body& body, Rng& rng) {
    std::vector<double> pose = body.restPose({0, 1, rng.uniform(1, 2.5)}, randomTurn(rng));
    for (std::size_t j = 1; j < body.joints.size(); ++j) {
        const Body::Joint& joint = body.joints[j];
        const auto own = std::span(pose).subspan(joint.first, joint.motion.size());
        std::vector<double> within;
        do {
            for (double& number : own) number = rng.uniform(-2.6, 2.6);
            within.assign(own.begin(), own.end());
            joint.motion.limit(within);
        } while (!std::equal(within.begin(), within.end(), own.begin()));
    }
    return pose;
}
double outsideOf(const PosedBody& posed, const dvec3& point) {
    double outside = 1e9;
    for (const PlacedCapsule& capsule : posed.capsules())
        outside = std::min(outside, -penetration(capsule, {{point, 0}, {point, 0}}));
    return outside;
}

TEST(HumanMesh, is_closed_and_in_one_piece_without_holes) {
    const BodyMesh& mesh = theMesh();
    const std::vector<glm::uvec3>& triangles = mesh.atRest.triangles;
    EXPECT_GE(triangles.size(), 4500u);
    EXPECT_LE(triangles.size(), 5500u);
    // Every edge once in each direction.
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const glm::uvec3& t : triangles)
        for (int i = 0; i < 3; ++i) EXPECT_TRUE(edges.insert({t[i], t[(i + 1) % 3]}).second);
    for (const auto& [from, to] : edges) EXPECT_TRUE(edges.contains({to, from}));
    EXPECT_EQ(mesh.edges.size() * 2, edges.size());
    // One piece: all vertices are reached from the first.
    std::vector<std::uint32_t> piece(mesh.atRest.vertices.size());
    for (std::uint32_t v = 0; v < piece.size(); ++v) piece[v] = v;
    for (bool isChanged = true; isChanged;) {
        isChanged = false;
        for (const MeshEdge& edge : mesh.edges) {
            const std::uint32_t least = std::min(piece[edge.from], piece[edge.to]);
            isChanged |= piece[edge.from] != least || piece[edge.to] != least;
            piece[edge.from] = piece[edge.to] = least;
        }
    }
    EXPECT_THAT(piece, testing::Each(0u));
    // Euler's characteristic of a ball: no handle. Around each vertex its triangles make one fan,
    // so that it is counted right.
    EXPECT_EQ(static_cast<int>(piece.size()) - static_cast<int>(mesh.edges.size()) + static_cast<int>(triangles.size()), 2);
    std::vector<std::size_t> corners(piece.size()), fan(piece.size());
    std::vector<glm::uvec3> first(piece.size());
    for (const glm::uvec3& t : triangles)
        for (int i = 0; i < 3; ++i) ++corners[t[i]], first[t[i]] = t;
    std::set<std::array<std::uint32_t, 3>> known;
    for (const glm::uvec3& t : triangles)
        for (int i = 0; i < 3; ++i) known.insert({t[i], t[(i + 1) % 3], t[(i + 2) % 3]});
    for (std::uint32_t v = 0; v < piece.size(); ++v) {
        const glm::uvec3& t = first[v];
        const int at = t.x == v ? 0 : t.y == v ? 1 : 2;
        const std::uint32_t begin = t[(at + 1) % 3];
        std::uint32_t spoke = begin;
        do {
            const auto next = known.lower_bound({v, spoke, 0});
            ASSERT_TRUE(next != known.end() && (*next)[0] == v && (*next)[1] == spoke);
            spoke = (*next)[2];
            ++fan[v];
        } while (spoke != begin && fan[v] < 100);
        EXPECT_EQ(fan[v], corners[v]);
    }
}

// Flesh weighs about as much as water.
TEST(HumanMesh, holds_what_the_body_weighs_and_looks_outward) {
    for (const double stature : {1.2, 1.75, 2.0}) {
        const Body body = humanBody(stature);
        const BodyMesh mesh = humanMesh(body);
        // The mass grows with the stature's square, a form with its cube: they agree for grown
        // people.
        const double water = humanBody(1.75).mass() / 1000 * std::pow(stature / 1.75, 3);
        EXPECT_NEAR(volumeOf(mesh.atRest.vertices, mesh.atRest.triangles), water, 0.1 * water) << stature;
    }
}

TEST(HumanMesh, scales_with_the_stature) {
    const BodyMesh large = humanMesh(humanBody(2)), small = humanMesh(humanBody(1));
    ASSERT_EQ(large.atRest.vertices.size(), small.atRest.vertices.size());
    EXPECT_EQ(large.joints, small.joints);
    for (std::size_t v = 0; v < small.atRest.vertices.size(); ++v)
        EXPECT_EQ(large.atRest.vertices[v], 2.0f * small.atRest.vertices[v]);
}

TEST(HumanMesh, stands_on_flat_soles_as_high_as_the_body) {
    const auto [least, most] = std::minmax_element(theMesh().atRest.vertices.begin(), theMesh().atRest.vertices.end(),
                                                   [](const vec3& a, const vec3& b) { return a.y < b.y; });
    PosedBody posed;
    posed.pose(theBody(), theBody().restPose(theBody().joints[0].offset, kNoTurn));
    EXPECT_NEAR(least->y, 0, 0.002);
    EXPECT_NEAR(least->y, posed.lowest(), 0.002);
    EXPECT_NEAR(most->y, 1.75, 0.01);
    // Each sole has an area: at heel and ball, to both sides.
    int touching = 0;
    for (const vec3& v : theMesh().atRest.vertices) touching += v.y < 0.002f;
    EXPECT_GE(touching, 20);
}

TEST(HumanMesh, has_vertices_that_follow_joints_that_are_neighbours) {
    const BodyMesh& mesh = theMesh();
    for (std::size_t v = 0; v < mesh.shares.size(); ++v) {
        float sum = 0;
        for (std::size_t i = 0; i < BodyMesh::kInfluences; ++i) {
            sum += mesh.shares[v][i];
            EXPECT_GE(mesh.shares[v][i == 0 ? 0 : i - 1], mesh.shares[v][i]);
            EXPECT_GE(mesh.shares[v][i], 0);
            const std::uint32_t main = mesh.joints[v][0], other = mesh.joints[v][i];
            EXPECT_TRUE(mesh.shares[v][i] == 0 || main == other || theBody().joints[main].parent == other ||
                        theBody().joints[other].parent == main);
        }
        EXPECT_NEAR(sum, 1, 1e-6f);
    }
}

TEST(BodyMesh, is_as_at_rest_in_the_rest_pose) {
    const auto skin = skinOf(theBody(), theMesh(), theBody().restPose(theBody().joints[0].offset, kNoTurn));
    for (std::size_t v = 0; v < skin.size(); ++v) EXPECT_LT(glm::distance(skin[v], theMesh().atRest.vertices[v]), 1e-6f);
}

TEST(BodyMesh, moves_rigidly_with_the_root) {
    Rng rng(3);
    for (int trial = 0; trial < 10; ++trial) {
        const dquat turn = randomTurn(rng);
        const dvec3 place = randomVector(rng, 2);
        const auto skin = skinOf(theBody(), theMesh(), theBody().restPose(place, turn));
        for (std::size_t v = 0; v < skin.size(); v += 7) {
            const dvec3 expected = place + turn * (dvec3(theMesh().atRest.vertices[v]) - theBody().joints[0].offset);
            EXPECT_LT(glm::distance(dvec3(skin[v]), expected), 3e-6);
        }
    }
}

// Of two rods the second follows its own joint; what lies between on the hinge's circle keeps its
// distance from the hinge.
TEST(BodyMesh, bent_half_way_it_keeps_the_girth) {
    Body body;
    body.joints.resize(2);
    body.joints[0].offset = {0, 1, 0};
    body.joints[1].offset = {1, 0, 0};
    body.joints[1].motion = JointMotion::axial({0, 0, 1}, -3, 3);
    body.joints[1].first = Body::kRootDofs;
    body.dofs = Body::kRootDofs + 1;
    BodyMesh mesh;
    mesh.atRest.vertices = {{1, 1.5f, 0}, {2, 1, 0}, {0.5f, 1, 0}};
    mesh.joints = {{0, 1}, {1}, {0}};
    mesh.shares = {{0.5f, 0.5f}, {1}, {1}};
    const double bend = 2.4;
    const auto skin = skinOf(body, mesh, std::vector<double>{0, 1, 0, 0, 0, 0, bend});
    EXPECT_LT(glm::distance(dvec3(skin[0]), dvec3(1 - 0.5 * std::sin(bend / 2), 1 + 0.5 * std::cos(bend / 2), 0)), 1e-6);
    EXPECT_LT(glm::distance(dvec3(skin[1]), dvec3(1 + std::cos(bend), 1 + std::sin(bend), 0)), 1e-6);
    EXPECT_LT(glm::distance(dvec3(skin[2]), dvec3(0.5, 1, 0)), 1e-6);
}

// A knee or an elbow that is bent as far as it goes neither loses nor gains a tenth of the whole
// body's volume, and its skin keeps some distance from the joint.
TEST(BodyMesh, has_limbs_that_do_not_collapse_where_they_bend) {
    for (const auto& [name, radius] : {std::pair("left knee", 0.035), std::pair("right elbow", 0.025)}) {
        std::vector<double> pose = theBody().restPose(theBody().joints[0].offset, kNoTurn);
        const std::uint32_t joint = theBody().joint(name);
        pose[theBody().joints[joint].first] = 140 * std::numbers::pi / 180;
        PosedBody posed;
        posed.pose(theBody(), pose);
        const auto skin = skinOf(theBody(), theMesh(), pose);
        double nearest = 1e9;
        for (std::size_t v = 0; v < skin.size(); ++v)
            if (theMesh().joints[v][0] == joint || theMesh().joints[v][0] == theBody().joints[joint].parent)
                nearest = std::min(nearest, glm::distance(dvec3(skin[v]), posed.place(joint)));
        EXPECT_GT(nearest, 0.7 * radius * 1.75) << name;
        EXPECT_NEAR(volumeOf(skin, theMesh().atRest.triangles), volumeOf(theMesh().atRest.vertices, theMesh().atRest.triangles),
                    0.001);
    }
}

// What docs/benchmarks.md says of the gap between the skin and the capsules that stand for it. The
// search sees only these.
TEST(HumanBody, has_capsules_that_stand_for_the_skin) {
    Rng rng(5);
    PosedBody posed;
    posed.pose(theBody(), theBody().restPose(theBody().joints[0].offset, kNoTurn));
    std::size_t beyond = 0;
    for (const vec3& v : theMesh().atRest.vertices) {
        const double outside = outsideOf(posed, v);
        EXPECT_LT(outside, 0.015);
        beyond += outside > 0.005;
    }
    EXPECT_LT(beyond, theMesh().atRest.vertices.size() / 20) << "nearly all of the skin is no farther out than 5 mm";

    const ScreenFrame frame(aStage({0, 0, 7}), -2, 3, 0.0025, 1600, 1600);
    MeshShadow meshShadow;
    CapsuleShadow capsuleShadow;
    std::vector<vec3> skin;
    double sum = 0;
    constexpr int kPoses = 200;
    for (int i = 0; i < kPoses; ++i) {
        posed.pose(theBody(), randomPose(theBody(), rng));
        theMesh().skin(theBody(), posed, skin);
        BitMask ofSkin(1600, 1600), ofCapsules(1600, 1600);
        ASSERT_TRUE(meshShadow.add(frame, theMesh(), skin, ofSkin));
        for (const PlacedCapsule& capsule : posed.capsules()) ASSERT_TRUE(capsuleShadow.add(frame, capsule, ofCapsules));
        BitMask both = ofSkin;
        both.add(ofCapsules);
        const auto whole = static_cast<double>(both.count());
        const double overlap = (static_cast<double>(ofSkin.count() + ofCapsules.count()) - whole) / whole;
        EXPECT_GT(overlap, 0.945);
        sum += overlap;
        for (const vec3& v : skin) EXPECT_LT(outsideOf(posed, v), 0.025);
    }
    EXPECT_GT(sum / kPoses, 0.965);
}

// Whoever searches with the simpler skin finds poses for the whole one.
TEST(HumanMesh, throws_the_same_shadow_if_it_is_the_simpler_one) {
    ASSERT_TRUE(theMesh().simpler);
    const BodyMesh& simpler = *theMesh().simpler;
    EXPECT_LE(simpler.atRest.triangles.size(), 1500u);
    EXPECT_EQ(2 * simpler.edges.size(), 3 * simpler.atRest.triangles.size()) << "closed";
    EXPECT_FALSE(simpler.simpler);
    const Stage stage;
    const ScreenFrame frame(stage, -1.7, 2.6, 0.01, 340, 270);
    Rng rng(4);
    MeshShadow shadow;
    double mean = 0, worst = 1;
    constexpr int kPoses = 40;
    for (int i = 0; i < kPoses; ++i) {
        std::vector<double> pose = theBody().restPose({0, 1, 2}, randomTurn(rng));
        for (std::size_t k = Body::kRootDofs; k < pose.size(); ++k) pose[k] = rng.uniform(-1, 1);
        theBody().limit(pose);
        PosedBody posed;
        posed.pose(theBody(), pose);
        std::vector<glm::vec3> skin;
        BitMask whole(frame.width(), frame.height()), simple = whole;
        theMesh().skin(theBody(), posed, skin);
        shadow.add(frame, theMesh(), skin, whole);
        simpler.skin(theBody(), posed, skin);
        shadow.add(frame, simpler, skin, simple);
        const double different = static_cast<double>(differing(whole, simple));
        const double both = 0.5 * (static_cast<double>(whole.count() + simple.count()) - different);
        const double iou = both / (both + different);
        mean += iou / kPoses;
        worst = std::min(worst, iou);
    }
    RecordProperty("mean", std::to_string(mean));
    RecordProperty("worst", std::to_string(worst));
    EXPECT_GT(mean, 0.98);
    EXPECT_GT(worst, 0.97);
}

TEST(EdgesOf, are_the_two_sides_of_each_edge_of_a_closed_mesh) {
    TriangleMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    const std::vector<MeshEdge> edges = edgesOf(tetrahedron);
    EXPECT_EQ(edges.size(), 6u);
    for (const MeshEdge& edge : edges) {
        const auto runs = [&](std::uint32_t triangle, std::uint32_t from, std::uint32_t to) {
            const glm::uvec3& t = tetrahedron.triangles[triangle];
            return (t.x == from && t.y == to) || (t.y == from && t.z == to) || (t.z == from && t.x == to);
        };
        EXPECT_TRUE(runs(edge.left, edge.from, edge.to));
        EXPECT_TRUE(runs(edge.right, edge.to, edge.from));
    }
    TriangleMesh open = tetrahedron;
    open.triangles.pop_back();
    EXPECT_TRUE(edgesOf(open).empty());
    TriangleMesh turned = tetrahedron;
    std::swap(turned.triangles[0].x, turned.triangles[0].y);
    EXPECT_TRUE(edgesOf(turned).empty());
    TriangleMesh doubled = tetrahedron;
    doubled.triangles.push_back(doubled.triangles[0]);
    EXPECT_TRUE(edgesOf(doubled).empty());
}

}  // namespace
}  // namespace fantascope::theatre
