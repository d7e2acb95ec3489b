#include "theatre/stage/mesh_shadow.h"

#include "theatre/a_person.h"
#include "theatre/a_stage.h"
#include "theatre/random_turns.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::vec3;

const Stage kStage = aStage({0.2, 0.1, 7});

std::vector<vec3> randomSkin(Rng& rng, dvec3 place) {
    std::vector<double> pose = theBody().restPose(place, randomTurn(rng));
    for (std::size_t k = Body::kRootDofs; k < pose.size(); ++k) pose[k] = rng.uniform(-2, 2);
    theBody().limit(pose);
    PosedBody posed;
    posed.pose(theBody(), pose);
    std::vector<vec3> skin;
    theMesh().skin(theBody(), posed, skin);
    return skin;
}

// Triangle by triangle, pixel by pixel. `unsure`: pixels whose centres lie so near to an edge that
// rounding decides.
struct Raster {
    BitMask mask, unsure;
};
Raster rasterOf(const ScreenFrame& frame, const TriangleMesh& mesh, std::span<const vec3> vertices) {
    Raster raster{BitMask(frame.width(), frame.height()), BitMask(frame.width(), frame.height())};
    for (const glm::uvec3& t : mesh.triangles) {
        dvec2 p[3];
        for (int i = 0; i < 3; ++i) p[i] = frame.shadow(vertices[t[i]]);
        const auto cross = [](dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; };
        if (cross(p[1] - p[0], p[2] - p[0]) < 0) std::swap(p[1], p[2]);
        const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
        const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
        for (int y = std::max(0, static_cast<int>(top) - 1); y < std::min<double>(frame.height(), bottom + 1); ++y)
            for (int x = std::max(0, static_cast<int>(left) - 1); x < std::min<double>(frame.width(), right + 1); ++x) {
                const dvec2 centre(x + 0.5, y + 0.5);
                double inside = 1e9;  // the least distance from a side's line
                for (int i = 0; i < 3; ++i) {
                    const dvec2 side = p[(i + 1) % 3] - p[i];
                    inside = std::min(inside, cross(side, centre - p[i]) / std::max(1e-12, glm::length(side)));
                }
                if (inside > 1e-3)
                    raster.mask.fill(y, x, x + 1);
                else if (inside > -1e-3)
                    raster.unsure.fill(y, x, x + 1);
            }
    }
    return raster;
}
// The same pixels but for those that are unsure, and of which no triangle is sure.
void expectSame(const BitMask& got, const Raster& wanted) {
    std::int64_t different = 0;
    for (int y = 0; y < got.height(); ++y)
        for (int x = 0; x < got.width(); ++x)
            different += got.at(x, y) != wanted.mask.at(x, y) && !(wanted.unsure.at(x, y) && !wanted.mask.at(x, y));
    EXPECT_EQ(different, 0);
}

TEST(MeshShadow, is_the_union_of_all_triangles) {
    Rng rng(1);
    MeshShadow shadow;
    const ScreenFrame frame(kStage, -1.7, 2.8, 0.0125, 256, 256);
    for (int trial = 0; trial < 60; ++trial) {
        const auto skin = randomSkin(rng, {rng.uniform(-0.4, 0.4), 1, rng.uniform(1, 3)});
        BitMask mask(256, 256);
        ASSERT_TRUE(shadow.add(frame, theMesh(), skin, mask));
        EXPECT_GT(mask.count(), 1000);
        expectSame(mask, rasterOf(frame, theMesh().atRest, skin));
    }
}

// Beyond the left edge the outline still winds.
TEST(MeshShadow, is_cut_at_each_edge_of_the_frame) {
    Rng rng(2);
    MeshShadow shadow;
    const ScreenFrame frame(kStage, -0.6, 1.6, 0.01, 123, 97);
    int thrown = 0;
    for (const dvec3 place : {dvec3(-0.5, 1.1, 2), {0.6, 1.1, 2}, {0, 1.5, 2}, {0, 0.4, 2}, {0, 1, 4}, {-0.4, 0.5, 3}})
        for (int trial = 0; trial < 10; ++trial) {
            const auto skin = randomSkin(rng, place);
            BitMask mask(123, 97);
            ASSERT_TRUE(shadow.add(frame, theMesh(), skin, mask));
            thrown += mask.count() > 0;
            expectSame(mask, rasterOf(frame, theMesh().atRest, skin));
        }
    EXPECT_GT(thrown, 40);
    for (const dvec3 place : {dvec3(-9, 1, 2), {9, 1, 2}, {0, 9, 2}, {0, -9, 2}}) {
        BitMask mask(123, 97);
        ASSERT_TRUE(shadow.add(frame, theMesh(), randomSkin(rng, place), mask));
        EXPECT_EQ(mask.count(), 0);
    }
}

// Where a closed mesh turns its inside out, as skin does in a deep fold, its outline winds the
// other way.
TEST(MeshShadow, of_a_mesh_turned_inside_out_is_the_same) {
    Rng rng(3);
    const auto skin = randomSkin(rng, {0, 1, 2});
    BodyMesh turned = theMesh();
    for (glm::uvec3& t : turned.atRest.triangles) std::swap(t.y, t.z);
    turned.edges = edgesOf(turned.atRest);
    const ScreenFrame frame(kStage, -1.7, 2.8, 0.0125, 256, 256);
    BitMask mask(256, 256);
    ASSERT_TRUE(MeshShadow().add(frame, turned, skin, mask));
    expectSame(mask, rasterOf(frame, turned.atRest, skin));
}

// Example failure: rounding turns a needle's face over, and its winding is missing from a pixel far
// to the right.
TEST(MeshShadow, of_needles_stays_where_they_are) {
    Rng rng(6);
    const ScreenFrame frame(kStage, -1.7, 2.8, 0.0125, 256, 256);
    BodyMesh needle;
    needle.atRest.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    MeshShadow shadow;
    for (int trial = 0; trial < 3000; ++trial) {
        const vec3 from(rng.uniform(-1, 1), rng.uniform(0.5, 2), rng.uniform(1, 3));
        const vec3 along(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), 0);
        needle.atRest.vertices.clear();
        for (int i = 0; i < 4; ++i) {
            const vec3 aside(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
            needle.atRest.vertices.push_back(from + static_cast<float>(rng.uniform(0, 1)) * along + 1e-6f * aside);
        }
        needle.edges = edgesOf(needle.atRest);
        ASSERT_EQ(needle.edges.size(), 6u);
        dvec2 low(1e9), high(-1e9);
        for (const vec3& vertex : needle.atRest.vertices) {
            low = glm::min(low, frame.shadow(vertex));
            high = glm::max(high, frame.shadow(vertex));
        }
        BitMask mask(256, 256);
        ASSERT_TRUE(shadow.add(frame, needle, needle.atRest.vertices, mask));
        for (int y = 0; y < 256; ++y)
            for (int x = 0; x < 256; ++x)
                if (mask.at(x, y)) {
                    ASSERT_TRUE(x + 1 > low.x - 0.01 && x < high.x + 0.01 && y + 1 > low.y - 0.01 && y < high.y + 0.01) << trial;
                }
    }
}

TEST(MeshShadow, adds_to_what_is_there) {
    Rng rng(4);
    const auto skin = randomSkin(rng, {0, 1, 2});
    const ScreenFrame frame(kStage, -1.7, 2.8, 0.0125, 256, 256);
    BitMask alone(256, 256), onto(256, 256);
    onto.fill(3, 0, 256);
    MeshShadow shadow;
    ASSERT_TRUE(shadow.add(frame, theMesh(), skin, alone));
    ASSERT_TRUE(shadow.add(frame, theMesh(), skin, onto));
    alone.fill(3, 0, 256);
    EXPECT_EQ(onto, alone);
}

TEST(MeshShadow, reaching_the_light_it_throws_none) {
    Rng rng(5);
    const ScreenFrame frame(kStage, -1.7, 2.8, 0.0125, 256, 256);
    BitMask mask(256, 256);
    for (const double z : {6.9, 7.0, 9.0}) EXPECT_FALSE(MeshShadow().add(frame, theMesh(), randomSkin(rng, {0, 1, z}), mask));
    EXPECT_EQ(mask.count(), 0);
}

}  // namespace
}  // namespace fantascope::theatre
