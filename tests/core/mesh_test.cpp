#include "core/mesh.h"

#include "scratch_folder.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace fantascope {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view kCube = R"(
v 0 0 0
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

// The volume inside, by the divergence theorem: negative if the triangles' corners run clockwise as seen from outside.
double volume(const TriangleMesh& mesh) {
    double sum = 0;
    for (const glm::uvec3 t : mesh.triangles)
        sum +=
            glm::dot(glm::dvec3(mesh.vertices[t.x]), glm::cross(glm::dvec3(mesh.vertices[t.y]), glm::dvec3(mesh.vertices[t.z]))) /
            6;
    return sum;
}

class MeshTest : public testing::Test {
protected:
    TriangleMesh mesh(const std::string& name, std::string_view text) { return readMesh(folder_.file(name, text)).value(); }
    std::string refusal(const std::string& name, std::string_view text) {
        const auto mesh = readMesh(folder_.file(name, text));
        return mesh ? "accepted" : mesh.error().message();
    }
    // A glTF of the one triangle (0, 0, 0), (1, 0, 0), (0, 1, 0), its node moved by `transform`.
    static std::string gltf(const std::string& transform) {
        return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, )" +
               transform + R"(}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
    }

    ScratchFolder folder_;
};

TEST_F(MeshTest, polygons_are_cut_into_triangles_that_share_their_vertices) {
    const TriangleMesh cube = mesh("cube.obj", kCube);
    EXPECT_EQ(cube.vertices.size(), 8u);
    EXPECT_EQ(cube.triangles.size(), 12u);
    EXPECT_NEAR(volume(cube), 8, 1e-6);
}

TEST_F(MeshTest, normals_and_texture_coordinates_do_not_split_vertices) {
    const TriangleMesh square = mesh("square.obj", R"(
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vn 0 0 1
vn 0 1 0
vt 0 0
vt 1 1
f 1/1/1 2/2/1 3/1/1
f 1/2/2 3/2/2 4/1/2
)");
    EXPECT_EQ(square.vertices.size(), 4u);
    EXPECT_EQ(square.triangles.size(), 2u);
}

TEST_F(MeshTest, all_parts_of_a_file_become_one_mesh) {
    const TriangleMesh two =
        mesh("two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\no one\nf 1 2 3\no two\nf 4 5 6\n");
    ASSERT_EQ(two.triangles.size(), 2u);
    float right = 0;
    for (const glm::uvec3 triangle : two.triangles) right = std::max(right, two.vertices[triangle.y].x);
    EXPECT_EQ(right, 6) << "the second part's indices are counted from its own vertices";
}

TEST_F(MeshTest, triangles_without_an_area_are_dropped) {
    EXPECT_EQ(mesh("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n").triangles.size(), 1u);
}

TEST_F(MeshTest, node_transforms_are_applied) {
    const TriangleMesh moved = mesh("a.gltf", gltf(R"("translation": [10, 0, 0], "scale": [2, 3, 1])"));
    ASSERT_EQ(moved.vertices.size(), 3u);
    glm::vec3 most(0);
    for (const glm::vec3 vertex : moved.vertices) most = glm::max(most, vertex);
    EXPECT_EQ(most, glm::vec3(12, 3, 0));
}

// glTF 2.0, section 3.7.4: a negative determinant turns the winding round, so that the outside stays outside.
TEST_F(MeshTest, a_mirrored_node_keeps_its_outside_outside) {
    for (const char* scale : {"1, 1, 1", "-1, 1, 1"}) {
        const TriangleMesh mirrored = mesh("a.gltf", gltf(R"("scale": [)" + std::string(scale) + "]"));
        const glm::uvec3 triangle = mirrored.triangles[0];
        const glm::vec3 a = mirrored.vertices[triangle.x], b = mirrored.vertices[triangle.y], c = mirrored.vertices[triangle.z];
        EXPECT_EQ(glm::cross(b - a, c - a), glm::vec3(0, 0, 1)) << scale;
    }
}

TEST_F(MeshTest, a_file_without_triangles_is_refused_with_advice) {
    EXPECT_THAT(refusal("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n"),
                AllOf(HasSubstr("points.obj"), HasSubstr("no triangles")));
    EXPECT_THAT(refusal("line.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), HasSubstr("no triangles"));
    EXPECT_THAT(refusal("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), HasSubstr("no triangles"));
}

TEST_F(MeshTest, coordinates_that_are_no_numbers_are_refused) {
    EXPECT_THAT(refusal("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("not a finite number"));
    EXPECT_THAT(refusal("inf.obj", "v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("not a finite number"));
}

TEST_F(MeshTest, what_is_no_mesh_is_refused_with_its_name_and_advice) {
    EXPECT_THAT(refusal("guide.png", "\x89PNG"), AllOf(HasSubstr("guide.png: not a mesh"), HasSubstr("export it as")));
    EXPECT_THAT(refusal("empty.obj", ""), HasSubstr("empty.obj: not a mesh"));
    EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 2 3\n"), HasSubstr("a.obj: "));
    EXPECT_THAT(refusal("a.gltf", gltf("").substr(0, 200)), HasSubstr("a.gltf: not a mesh"));
    EXPECT_THAT(readMesh(folder_ / "none.obj").error().message(), HasSubstr("none.obj: cannot be read: No such file"));
    EXPECT_THAT(readMesh(folder_ / "").error().message(), HasSubstr("is a folder"));
}

}  // namespace
}  // namespace fantascope
