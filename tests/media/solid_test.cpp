// What a slicer requires of a mesh, checked by CGAL; each defect is deliberate.

#include "media/solid.h"

#include "core/file.h"
#include "meshes.h"
#include "scratch_folder.h"

#include <glm/common.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

namespace fantascope {
namespace {

using testing::IsEmpty;
using testing::Not;

TEST(SolidCheck, a_box_is_sound) {
    const SolidCheck check = checkSolid(boxMesh({0, 0, 0}, {1, 2, 3}));
    EXPECT_TRUE(check.isSound());
    EXPECT_EQ(check.pieces, 1u);
    EXPECT_NEAR(check.volume, 6, 1e-9);
}

TEST(SolidCheck, a_hole_is_found) {
    TriangleMesh open = boxMesh({0, 0, 0}, {1, 1, 1});
    open.triangles.pop_back();
    const SolidCheck check = checkSolid(open);
    EXPECT_TRUE(check.isManifold);
    EXPECT_FALSE(check.isClosed);
    EXPECT_FALSE(check.isSound());
}

TEST(SolidCheck, what_is_inside_out_is_found) {
    const SolidCheck check = checkSolid(insideOut(boxMesh({0, 0, 0}, {1, 1, 1})));
    EXPECT_TRUE(check.isClosed);
    EXPECT_FALSE(check.facesOutward);
}

TEST(SolidCheck, what_runs_through_another_is_found) {
    const SolidCheck apart = checkSolid(both(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({2, 0, 0}, {3, 1, 1})));
    EXPECT_THAT(apart.crossings, IsEmpty());
    EXPECT_EQ(apart.pieces, 2u);
    const SolidCheck across = checkSolid(both(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({0.5f, 0.3f, 0.2f}, {3, 0.7f, 0.8f})));
    EXPECT_TRUE(across.isClosed);
    EXPECT_THAT(across.crossings, Not(IsEmpty()));
    EXPECT_FALSE(across.isSound());
}

// Two boxes that share an edge: four triangles at one edge.
TEST(SolidCheck, an_edge_of_four_triangles_is_found) {
    TriangleMesh two = both(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 1, 0}, {2, 2, 1}));
    for (glm::uvec3& t : two.triangles)
        for (int i = 0; i < 3; ++i)
            for (unsigned v = 0; v < 8; ++v)
                if (two.vertices[v] == two.vertices[t[i]]) t[i] = v;
    EXPECT_FALSE(checkSolid(two).isManifold);
}

TEST(SolidCheck, a_box_is_as_thick_as_it_is) {
    const std::vector<double> found = thicknesses(boxMesh({0, 0, 0}, {1, 2, 3}), 1);
    ASSERT_EQ(found.size(), 12u);
    const double expected[] = {3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1};  // faces across z, y, x
    for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(found[i], expected[i], 1e-9) << i;
    EXPECT_THAT(thicknesses(boxMesh({0, 0, 0}, {1, 2, 3}), 5), testing::ElementsAre(found[0], found[5], found[10]));
}

// By assimp, and by the bytes of the format.
TEST(Stl, comes_back_from_another_reader) {
    const ScratchFolder folder;
    const TriangleMesh given = boxMesh({-1, 0, 0.1f}, {1 / 3.0f, 2, 3});
    ASSERT_TRUE(writeStl(folder / "a.stl", given));
    const std::string bytes = readFile(folder / "a.stl").value();
    ASSERT_EQ(bytes.size(), 84 + 50 * given.triangles.size());
    EXPECT_FALSE(bytes.starts_with("solid"));
    float normal[3];
    std::memcpy(normal, bytes.data() + 84, sizeof normal);
    EXPECT_EQ(glm::vec3(normal[0], normal[1], normal[2]), glm::vec3(0, 0, -1));
    const TriangleMesh read = readMesh(folder / "a.stl").value();
    EXPECT_EQ(read.vertices.size(), 8u);
    EXPECT_TRUE(checkSolid(read).isSound());
    EXPECT_NEAR(checkSolid(read).volume, checkSolid(given).volume, 1e-6);
    EXPECT_FALSE(writeStl(folder / "a.stl" / "b.stl", given));
}

}  // namespace
}  // namespace fantascope
