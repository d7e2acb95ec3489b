#include "pattern/elemental_shape.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <map>

namespace fantascope::pattern {
namespace {

using testing::HasSubstr;

double radiusOf(const TriangleMesh& mesh) {
    double radius = 0;
    for (const glm::vec3& vertex : mesh.vertices) radius = std::max<double>(radius, glm::length(vertex));
    return radius;
}

std::string refusal(const Result<ElementalShape>& shape) { return shape ? "accepted" : shape.error().message(); }

TEST(ElementalShape, built_in_shapes_reach_to_radius_one_and_face_the_viewer) {
    for (const std::string& name : builtInShapeNames()) {
        const auto shape = loadShape(name);
        ASSERT_TRUE(shape) << shape.error().message();
        EXPECT_EQ(shape->name, name);
        EXPECT_NEAR(radiusOf(shape->mesh), 1, 1e-6) << name;
        for (const glm::uvec3& t : shape->mesh.triangles) {
            const auto& v = shape->mesh.vertices;
            EXPECT_GT(glm::cross(v[t.y] - v[t.x], v[t.z] - v[t.x]).z, 0) << name;
        }
    }
}

// The centre is that of the surface, whatever the points are. Example failure: a side with more points pulls the centre to it.
TEST(ElementalShape, is_centred_by_area_and_scaled_to_its_farthest_corner) {
    // A rectangle 4 x 2 with its lower left corner at (10, 20), its left half cut into more triangles.
    const TriangleMesh mesh{
        {{10, 20, 5}, {12, 20, 5}, {14, 20, 5}, {14, 22, 5}, {12, 22, 5}, {10, 22, 5}, {11, 21, 5}, {99, 99, 99}},
        {{0, 1, 6}, {1, 4, 6}, {4, 5, 6}, {5, 0, 6}, {1, 2, 3}, {1, 3, 4}}};
    const auto shape = makeShape("rectangle", mesh);
    ASSERT_TRUE(shape) << shape.error().message();
    const float scale = std::sqrt(5.0f);  // half of the diagonal; the point that no triangle uses does not count
    const glm::vec3 corner = shape->mesh.vertices[3];
    EXPECT_NEAR(corner.x, 2 / scale, 1e-6);
    EXPECT_NEAR(corner.y, 1 / scale, 1e-6);
    EXPECT_NEAR(corner.z, 0, 1e-6);
}

TEST(ElementalShape, a_mesh_without_a_front_view_is_refused_with_advice) {
    const TriangleMesh floor{{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}}, {{0, 1, 2}}};
    EXPECT_THAT(refusal(makeShape("leaf.obj", floor)), HasSubstr("leaf.obj: seen from the front"));
}

TEST(ElementalShape, an_unknown_name_is_answered_with_the_nearest) {
    EXPECT_THAT(refusal(loadShape("triangel")), HasSubstr("did you mean 'triangle'?"));
    EXPECT_THAT(refusal(loadShape("zzz")), HasSubstr("neither a file nor one of triangle, square, circle, leaf"));
    EXPECT_THAT(refusal(loadShape("nowhere/leaf.obj")), HasSubstr("nowhere/leaf.obj: cannot be read"));
}

// The renderer draws 330 of them on an output within 20,000 triangles, and both it and the search rely on a closed surface.
TEST(ElementalShape, the_sculpture_of_the_default_show_is_closed_and_of_few_triangles) {
    const auto mesh = readMesh(FANTASCOPE_SOURCE_DIR "/shows/light-movement/shapes/sculpture.obj");
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
