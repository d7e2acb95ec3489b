#include "media/mesh.h"

#include "scratch_folder.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>

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

// The enclosed volume by the divergence theorem; negative if the triangles run clockwise as seen
// from outside.
double volume(const TriangleMesh& mesh) {
    double sum = 0;
    for (const glm::uvec3 t : mesh.triangles)
        sum +=
            glm::dot(glm::dvec3(mesh.vertices[t.x]), glm::cross(glm::dvec3(mesh.vertices[t.y]), glm::dvec3(mesh.vertices[t.z]))) /
            6;
    return sum;
}

// An FBX as text, version 7.4: a square of side 2 in the first and third coordinate, as one
// polygon; `axes` are its global settings.
std::string fbx(const std::string& axes, const std::string& vertices = "0,0,0, 2,0,0, 2,0,2, 0,0,2") {
    return R"(; FBX 7.4.0 project file
FBXHeaderExtension:  {
    FBXHeaderVersion: 1003
    FBXVersion: 7400
}
GlobalSettings:  {
    Version: 1000
    Properties70:  {
)" + axes + R"(
    }
}
Objects:  {
    Geometry: 1001, "Geometry::square", "Mesh" {
        Vertices: *12 {
            a: )" +
           vertices + R"(
        }
        PolygonVertexIndex: *4 {
            a: 0,1,2,-4
        }
        GeometryVersion: 124
    }
    Model: 2001, "Model::square", "Mesh" {
        Version: 232
        Properties70:  {
            P: "Lcl Translation", "Lcl Translation", "", "A",10,0,0
        }
    }
}
Connections:  {
    C: "OO",2001,0
    C: "OO",1001,2001
}
)";
}
// The right, up and front axes, each with its sign.
std::string fbxAxes(std::array<int, 6> axes) {
    std::string text;
    const std::array<const char*, 6> names = {"CoordAxis", "CoordAxisSign", "UpAxis", "UpAxisSign", "FrontAxis", "FrontAxisSign"};
    for (std::size_t i = 0; i < axes.size(); ++i)
        text += "        P: \"" + std::string(names[i]) + "\", \"int\", \"Integer\", \"\"," + std::to_string(axes[i]) + "\n";
    return text;
}

std::string bytesOf(const auto& value) { return {reinterpret_cast<const char*>(&value), sizeof value}; }

// A binary glTF (2.0, section 4.4) of one triangle: its header, the scene as JSON, the points.
std::string glb(std::array<float, 9> points, const std::string& count = "3") {
    std::string json = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": )" +
                       count + R"(, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36}]})";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint32_t total = static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + 36);
    return "glTF" + bytesOf(std::uint32_t{2}) + bytesOf(total) + bytesOf(static_cast<std::uint32_t>(json.size())) + "JSON" +
           json + bytesOf(std::uint32_t{36}) + std::string("BIN\0", 4) + bytesOf(points);
}

glm::vec3 least(const TriangleMesh& mesh) {
    glm::vec3 least(1e9);
    for (const glm::vec3 vertex : mesh.vertices) least = glm::min(least, vertex);
    return least;
}
glm::vec3 most(const TriangleMesh& mesh) {
    glm::vec3 most(-1e9);
    for (const glm::vec3 vertex : mesh.vertices) most = glm::max(most, vertex);
    return most;
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
    EXPECT_EQ(most(moved), glm::vec3(12, 3, 0));
}

// glTF 2.0, section 3.7.4: a negative determinant reverses the winding, so that the outside stays
// outside.
TEST_F(MeshTest, a_mirrored_node_keeps_its_outside_outside) {
    for (const char* scale : {"1, 1, 1", "-1, 1, 1"}) {
        const TriangleMesh mirrored = mesh("a.gltf", gltf(R"("scale": [)" + std::string(scale) + "]"));
        const glm::uvec3 triangle = mirrored.triangles[0];
        const glm::vec3 a = mirrored.vertices[triangle.x], b = mirrored.vertices[triangle.y], c = mirrored.vertices[triangle.z];
        EXPECT_EQ(glm::cross(b - a, c - a), glm::vec3(0, 0, 1)) << scale;
    }
}

TEST_F(MeshTest, a_binary_gltf_is_read) {
    const TriangleMesh triangle = mesh("a.glb", glb({0, 0, 0, 4, 0, 0, 0, 3, 1}));
    ASSERT_EQ(triangle.triangles.size(), 1u);
    EXPECT_EQ(most(triangle), glm::vec3(4, 3, 1));
}

// Example failure: a tool whose up is z declares that in the file, and its leaf lies on the floor.
TEST_F(MeshTest, an_fbx_stands_up_as_it_says) {
    const TriangleMesh plain = mesh("plain.fbx", fbx(""));
    EXPECT_EQ(plain.triangles.size(), 2u);
    EXPECT_EQ(least(plain), glm::vec3(10, 0, 0));
    EXPECT_EQ(most(plain), glm::vec3(12, 0, 2));
    const TriangleMesh yUp = mesh("y.fbx", fbx(fbxAxes({0, 1, 1, 1, 2, 1})));
    EXPECT_EQ(most(yUp), glm::vec3(12, 0, 2));
    const TriangleMesh zUp = mesh("z.fbx", fbx(fbxAxes({0, 1, 2, 1, 1, -1})));
    EXPECT_EQ(least(zUp), glm::vec3(10, 0, 0));
    EXPECT_EQ(most(zUp), glm::vec3(12, 2, 0));
    for (const glm::uvec3 t : zUp.triangles)  // as seen from the declared front
        EXPECT_GT(glm::cross(zUp.vertices[t.y] - zUp.vertices[t.x], zUp.vertices[t.z] - zUp.vertices[t.x]).z, 0);
    EXPECT_EQ(most(mesh("odd.fbx", fbx(fbxAxes({0, 1, 0, 1, 7, 1})))), glm::vec3(12, 0, 2)) << "axes that are none";
}

// Example failure: an area in single precision is infinity minus infinity.
TEST_F(MeshTest, a_giant_is_a_mesh) {
    EXPECT_EQ(mesh("giant.obj", "v 0 0 0\nv 1e30 1e30 0\nv -1e30 2e30 1e30\nf 1 2 3\n").triangles.size(), 1u);
}

TEST_F(MeshTest, a_written_mesh_reads_back_as_it_was) {
    const TriangleMesh mesh{{{0.1f, -1e-7f, 1 / 3.0f}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e6f}}, {{0, 1, 2}, {0, 2, 3}}};
    const ScratchFolder folder;
    ASSERT_TRUE(writeObj(folder / "a.obj", mesh));
    const TriangleMesh read = readMesh(folder / "a.obj").value();
    EXPECT_EQ(read.vertices, mesh.vertices);
    EXPECT_EQ(read.triangles, mesh.triangles);
    EXPECT_FALSE(writeObj(folder / "a.obj" / "b.obj", mesh));
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
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(refusal("nan.glb", glb({0, 0, 0, nan, 0, 0, 0, 3, 1})), HasSubstr("not a finite number"));
}

TEST_F(MeshTest, what_is_no_mesh_is_refused_with_its_name_and_advice) {
    EXPECT_THAT(refusal("guide.png", "\x89PNG"), AllOf(HasSubstr("guide.png: not a mesh"), HasSubstr("export it as")));
    EXPECT_THAT(refusal("empty.obj", ""), HasSubstr("empty.obj: not a mesh"));
    EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 2 3\n"), HasSubstr("a.obj: "));
    EXPECT_THAT(refusal("a.gltf", gltf("").substr(0, 200)), HasSubstr("a.gltf: not a mesh"));
    EXPECT_THAT(refusal("words.fbx", "This is no FBX."), HasSubstr("words.fbx: not a mesh"));
    EXPECT_THAT(refusal("half.fbx", fbx("").substr(0, 500)), HasSubstr("half.fbx: "));
    EXPECT_THAT(refusal("binary.fbx", std::string("Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0garbage", 34)),
                HasSubstr("binary.fbx: not a mesh"));
    const std::string whole = glb({0, 0, 0, 4, 0, 0, 0, 3, 1});
    for (const std::size_t size : {3u, 12u, 60u, 400u}) EXPECT_NE(refusal("half.glb", whole.substr(0, size)), "accepted") << size;
    EXPECT_THAT(refusal("more.glb", glb({0, 0, 0, 4, 0, 0, 0, 3, 1}, "300000000")), HasSubstr("more.glb: not a mesh"));
    EXPECT_THAT(readMesh(folder_ / "none.obj").error().message(), HasSubstr("none.obj: cannot be read: No such file"));
    EXPECT_THAT(readMesh(folder_ / "").error().message(), HasSubstr("is a folder"));
}

// Example failure: reading one file blocks forever on another file that it names.
TEST(Mesh, what_is_no_regular_file_is_refused_wherever_it_is_named) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe.obj").c_str(), 0600), 0);
    EXPECT_EQ(folder.relative(readMesh(folder / "pipe.obj").error().message()), "pipe.obj: is a pipe, a file is needed");
    const auto file =
        folder.file("a.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "pipe.obj", "byteLength": 36}]})");
    EXPECT_EQ(folder.relative(readMesh(file).error().message()), "pipe.obj: is a pipe, a file is needed");
}

}  // namespace
}  // namespace fantascope
