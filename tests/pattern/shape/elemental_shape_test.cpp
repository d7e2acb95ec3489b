#include "pattern/shape/elemental_shape.h"

#include "pattern/shape/built_in_shapes.h"

#include "media/image.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fantascope::pattern {
namespace {

using testing::AllOf;
using testing::HasSubstr;

double radiusOf(const TriangleMesh& mesh) {
    double radius = 0;
    for (const glm::vec3& vertex : mesh.vertices) radius = std::max<double>(radius, glm::length(vertex));
    return radius;
}

std::string refusal(const Result<ElementalShape>& shape) { return shape ? "accepted" : shape.error().message(); }

TEST(ElementalShape, built_in_shapes_reach_to_radius_one) {
    for (const std::string& name : builtInShapeNames()) {
        const auto shape = loadShape(name);
        ASSERT_TRUE(shape) << shape.error().message();
        EXPECT_EQ(shape->name, name);
        EXPECT_NEAR(radiusOf(shape->mesh), 1, 1e-6) << name;
    }
}

// The centre is the surface's centroid, wherever the vertices are. Example failure: a side with
// more vertices attracts the centre.
TEST(ElementalShape, is_centred_by_area_and_scaled_to_its_farthest_corner) {
    // A rectangle 4 x 2 with its lower left corner at (10, 20), its left half cut into more
    // triangles.
    const TriangleMesh mesh{
        {{10, 20, 5}, {12, 20, 5}, {14, 20, 5}, {14, 22, 5}, {12, 22, 5}, {10, 22, 5}, {11, 21, 5}, {99, 99, 99}},
        {{0, 1, 6}, {1, 4, 6}, {4, 5, 6}, {5, 0, 6}, {1, 2, 3}, {1, 3, 4}}};
    const auto shape = makeShape("rectangle", mesh);
    ASSERT_TRUE(shape) << shape.error().message();
    const float scale = std::sqrt(5.0f);  // half of the diagonal; a vertex that no triangle uses does not count
    const glm::vec3 corner = shape->mesh.vertices[3];
    EXPECT_NEAR(corner.x, 2 / scale, 1e-6);
    EXPECT_NEAR(corner.y, 1 / scale, 1e-6);
    EXPECT_NEAR(corner.z, 0, 1e-6);
}

TEST(ElementalShape, a_mesh_without_a_front_view_is_refused_with_advice) {
    const TriangleMesh floor{{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}}, {{0, 1, 2}}};
    EXPECT_THAT(refusal(makeShape("leaf.obj", floor)), HasSubstr("leaf.obj: has no area seen from the front"));
    EXPECT_THAT(refusal(makeShape("leaf.obj", {})), HasSubstr("leaf.obj: has no surface"));
}

// Example failure: a scan of a million triangles is accepted, and a thousand copies of it take a
// week to draw.
TEST(ElementalShape, a_huge_mesh_is_refused_with_advice) {
    TriangleMesh strip;
    for (std::uint32_t i = 0; i < 200'000; ++i) {
        strip.vertices.emplace_back(i / 2, i % 2, 0);
        if (i >= 2) strip.triangles.emplace_back(i - 2, i - 1, i);
    }
    EXPECT_THAT(refusal(makeShape("scan.obj", strip)),
                AllOf(HasSubstr("scan.obj: has 199998 triangles"), HasSubstr("reduce the mesh")));
}

// The front view is orthographic. The depth of a relief is kept, since it shows when the shape
// turns.
TEST(ElementalShape, of_a_mesh_in_space_the_front_is_seen) {
    const ScratchFolder folder;
    const auto roof = readShapeFile(
        folder.file("roof.obj", "v -1 0 0\nv 0 0 1\nv 1 0 0\nv -1 2 0\nv 0 2 1\nv 1 2 0\nf 1 2 5 4\nf 2 3 6 5\n"), "roof");
    ASSERT_TRUE(roof) << roof.error().message();
    EXPECT_EQ(roof->name, "roof");
    EXPECT_EQ(roof->file, folder / "roof.obj");
    float nearest = -1, farthest = 1;
    for (const glm::vec3 vertex : roof->mesh.vertices)
        nearest = std::max(nearest, vertex.z), farthest = std::min(farthest, vertex.z);
    EXPECT_NEAR(nearest - farthest, 1 / std::sqrt(1 + 1 + 0.25), 1e-6) << "deep as it was, in shares of its radius";
}

// Every kind of file gives the same shape, a plate twice as wide as high.
TEST(ElementalShape, meshes_svg_and_pictures_are_all_shapes) {
    const ScratchFolder folder;
    GreyImage picture(100, 80, 1);
    for (int y = 20; y < 50; ++y)
        for (int x = 20; x < 80; ++x) picture.at(x, y) = 0;
    ASSERT_TRUE(writePng(folder / "plate.PNG", picture));
    folder.file("plate.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><path d='M1 1 h6 v3 h-6 z'/></svg>");
    folder.file("plate.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n");
    for (const char* name : {"plate.PNG", "plate.svg", "plate.obj"}) {
        const auto shape = loadShape(folder / name);
        ASSERT_TRUE(shape) << shape.error().message();
        EXPECT_EQ(shape->file, folder / name);
        for (const glm::vec3 vertex : shape->mesh.vertices)
            if (glm::length(vertex) > 0.9) {
                EXPECT_NEAR(std::abs(vertex.x), 2 / std::sqrt(5.0), 0.04) << name;
                EXPECT_NEAR(std::abs(vertex.y), 1 / std::sqrt(5.0), 0.04) << name;
            }
    }
    folder.file("letter-form.svg", readFile(folder / "plate.svg").value());
    EXPECT_EQ(loadShape(folder / "letter-form.svg")->file, folder / "letter-form.svg") << "no letter";
}

TEST(ElementalShape, an_unknown_name_is_answered_with_the_nearest) {
    EXPECT_THAT(refusal(loadShape("triangel")), HasSubstr("did you mean 'triangle'?"));
    EXPECT_THAT(refusal(loadShape("zzz")),
                HasSubstr("neither a file nor built in: 'zzz' is no built-in shape; there are triangle, square, circle, leaf"));
    EXPECT_THAT(refusal(loadShape("nowhere/leaf.obj")), HasSubstr("nowhere/leaf.obj: cannot be read"));
}

// Renderer and search rely on a closed surface, and 330 of them must stay within 20,000 triangles
// on an output.
TEST(ElementalShape, the_sculpture_of_the_default_show_is_closed_and_of_few_triangles) {
    const auto mesh = readMesh(sourceFolder() + "/shows/light-movement/shapes/sculpture.obj");
    ASSERT_TRUE(mesh) << mesh.error().message();
    EXPECT_LE(mesh->triangles.size(), 60u);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
    for (const glm::uvec3& t : mesh->triangles)
        for (int i = 0; i < 3; ++i) ++ways[{t[i], t[(i + 1) % 3]}];
    for (const auto& [edge, count] : ways) {
        EXPECT_EQ(count, 1);
        EXPECT_EQ(ways.count({edge.second, edge.first}), 1u) << "edge " << edge.first << " - " << edge.second << " is open";
    }
}

}  // namespace
}  // namespace fantascope::pattern
