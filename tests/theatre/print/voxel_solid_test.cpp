// Whatever is put in, one closed solid comes out; that it is one is told by CGAL.

#include "theatre/print/voxel_solid.h"

#include "theatre/stage/stage_set.h"

#include "media/solid.h"
#include "meshes.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

constexpr double kCell = 0.1;

VoxelSolid aGrid() { return VoxelSolid({{-3.03, -3.03, -3.03}, {3, 3, 3}}, kCell, 3 * kCell); }
TriangleMesh aBox(const dvec3& centre, const dvec3& size, double turn = 0) {
    return meshOf(Stage::Platform{"", centre, size, turn});
}
double volumeOf(const VoxelSolid& solid) {
    const SolidCheck check = checkSolid(solid.surface());
    EXPECT_TRUE(check.isSound());
    return check.volume;
}

TEST(VoxelSolid, a_box_keeps_its_form) {
    VoxelSolid solid = aGrid();
    solid.add(aBox({0.1, 0.2, -0.1}, {1.5, 2, 1}, 0.4), 0);
    EXPECT_NEAR(volumeOf(solid), 3, 0.06);
}

// Two meshes, and one mesh that runs through itself.
TEST(VoxelSolid, what_overlaps_becomes_one) {
    const TriangleMesh one = aBox({-0.5, 0, 0}, {2, 1, 1}), other = aBox({0.5, 0, 0}, {2, 1, 1}, 0.0);
    VoxelSolid two = aGrid(), itself = aGrid();
    two.add(one, 0), two.add(other, 0);
    itself.add(both(one, other), 0);
    for (const VoxelSolid* const solid : {&two, &itself}) {
        EXPECT_NEAR(volumeOf(*solid), 3, 0.08);
        EXPECT_EQ(checkSolid(solid->surface()).pieces, 1u);
    }
}

TEST(VoxelSolid, boxes_that_touch_along_an_edge_are_still_a_solid) {
    VoxelSolid solid = aGrid();
    solid.add(aBox({-0.5, -0.5, 0}, {1, 1, 1}), 0), solid.add(aBox({0.5, 0.5, 0}, {1, 1, 1}), 0);
    EXPECT_NEAR(volumeOf(solid), 2, 0.08);
}

TEST(VoxelSolid, a_cavity_is_filled) {
    VoxelSolid solid = aGrid();
    solid.add(both(aBox({0, 0, 0}, {2, 2, 2}), insideOut(aBox({0, 0, 0}, {1, 1, 1}))), 0);
    EXPECT_EQ(checkSolid(solid.surface()).pieces, 2u) << "inside and outside of a hollow box";
    EXPECT_NEAR(volumeOf(solid), 7, 0.15);
    solid.fillCavities();
    EXPECT_EQ(checkSolid(solid.surface()).pieces, 1u);
    EXPECT_NEAR(volumeOf(solid), 8, 0.12);
}

TEST(VoxelSolid, what_lies_below_is_cut_off_flat) {
    VoxelSolid solid = aGrid();
    solid.add(aBox({0, 0, 0}, {2, 2, 2}, 0.3), 0);
    solid.cutBelow(-0.25);
    EXPECT_NEAR(volumeOf(solid), 5, 0.1);
    float least = 1;
    for (const glm::vec3& v : solid.surface().vertices) least = std::min(least, v.y);
    EXPECT_NEAR(least, -0.25, 0.01);
}

TEST(VoxelSolid, pieces_are_told_apart_and_joined_by_a_rod) {
    VoxelSolid solid = aGrid();
    solid.add(aBox({-1.5, 0, 0}, {1, 1, 1}), 0), solid.add(aBox({1.5, 0, 0}, {1.2, 1, 1}), 0),
        solid.add(aBox({0, 2, 0}, {0.3, 0.3, 0.3}), 0);
    auto pieces = solid.pieces();
    ASSERT_EQ(pieces.size(), 3u);
    EXPECT_GT(pieces[0].nodes, pieces[1].nodes) << "the largest first";
    for (const dvec3& place : pieces[2].some) EXPECT_LT(glm::distance(place, {0, 2, 0}), 0.4);
    solid.remove(pieces[2]);
    EXPECT_EQ(solid.pieces().size(), 2u);
    solid.addRod({-1.5, 0, 0}, {1.5, 0, 0}, 0.2);
    EXPECT_EQ(solid.pieces().size(), 1u);
    // What lies between them, by the form of a cylinder.
    EXPECT_NEAR(volumeOf(solid), 1 + 1.2 + 1.9 * std::numbers::pi * 0.2 * 0.2, 0.08);
}

// Example failure: every edge of a box is thin by the distance to the nearest surface alone.
TEST(VoxelSolid, a_rod_is_thin_and_a_box_is_not) {
    VoxelSolid rod = aGrid(), box = aGrid();
    rod.addRod({-1.513, 0.021, 0.037}, {1.42, 0.633, -0.29}, 0.25);
    const auto thin = rod.thinnerThan(0.8);
    ASSERT_FALSE(thin.empty());
    const dvec3 along = glm::normalize(dvec3(1.42, 0.633, -0.29) - dvec3(-1.513, 0.021, 0.037));
    double least = 1e9, most = -1e9;
    for (const VoxelSolid::Thin& at : thin) {
        EXPECT_NEAR(at.thickness, 0.5, 0.15) << "also at its round ends";
        const dvec3 from = at.middle - dvec3(-1.513, 0.021, 0.037);
        EXPECT_LT(glm::length(from - glm::dot(from, along) * along), 0.06) << "its middle is on the axis";
        least = std::min(least, glm::dot(from, along)), most = std::max(most, glm::dot(from, along));
    }
    EXPECT_LT(least, 0.2);
    EXPECT_GT(most, 2.8) << "from end to end";
    EXPECT_TRUE(rod.thinnerThan(0.4).empty());
    box.add(aBox({0, 0, 0}, {2, 1.1, 1.3}, 0.3), 0);
    EXPECT_TRUE(box.thinnerThan(0.8).empty());
    EXPECT_FALSE(box.thinnerThan(1.3).empty()) << "it is 1.1 thick";
}

// What artists draw for scenery has no thickness, or holes.
TEST(VoxelSolid, a_sheet_becomes_as_thick_as_it_is_told) {
    VoxelSolid solid = aGrid();
    const TriangleMesh sheet{{{-1, -1, 0.02f}, {1, -1, 0.02f}, {1, 1, 0.02f}, {-1, 1, 0.02f}}, {{0, 1, 2}, {0, 2, 3}}};
    solid.add(sheet, 0.4);
    // Round its edges: a half tube and balls at the corners.
    const double r = 0.2, expected = 4 * 2 * r + 8 * 0.5 * std::numbers::pi * r * r + 4 / 3.0 * std::numbers::pi * r * r * r;
    EXPECT_NEAR(volumeOf(solid), expected, 0.06);
}

TEST(VoxelSolid, a_hole_in_a_mesh_does_no_harm) {
    TriangleMesh open = aBox({0, 0, 0}, {2, 2, 2});
    open.triangles.pop_back();
    VoxelSolid solid = aGrid();
    solid.add(open, 0.3);
    EXPECT_NEAR(volumeOf(solid), 8, 0.4);
}

}  // namespace
}  // namespace fantascope::theatre
