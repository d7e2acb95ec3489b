#include "media/mesh.h"

#include "core/file.h"

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace fantascope {
namespace {

// The files that assimp opens: the mesh, and those that it names, such as a glTF's buffers. Each is
// read whole, and refused as by readFile().
class Files : public Assimp::IOSystem {
public:
    std::optional<Error> refusal;  // of the first refused file

    bool Exists(const char* path) const override {
        std::error_code ignored;
        return std::filesystem::exists(path, ignored);
    }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* path, const char* mode) override {
        if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
        auto bytes = readFile(path, kMaxFileBytes);
        if (!bytes) {
            if (!refusal) refusal = bytes.error();
            return nullptr;
        }
        return new Stream(std::move(*bytes));
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

private:
    class Stream : public Assimp::IOStream {
    public:
        explicit Stream(std::string bytes) : bytes_(std::move(bytes)) {}
        std::size_t Read(void* to, std::size_t size, std::size_t count) override {
            if (size == 0) return 0;
            const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
            std::memcpy(to, bytes_.data() + at_, whole * size);
            at_ += whole * size;
            return whole;
        }
        std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
        aiReturn Seek(std::size_t offset, aiOrigin origin) override {
            const std::size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
            if (from + offset > bytes_.size()) return aiReturn_FAILURE;  // a negative offset wraps to a large number
            at_ = from + offset;
            return aiReturn_SUCCESS;
        }
        std::size_t Tell() const override { return at_; }
        std::size_t FileSize() const override { return bytes_.size(); }
        void Flush() override {}

    private:
        const std::string bytes_;
        std::size_t at_ = 0;
    };
};

// Appends the meshes of a node and its children in the scene's space. Points and lines have no
// surface and are left out.
void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4& sceneFromParent, TriangleMesh& mesh) {
    const aiMatrix4x4 sceneFromNode = sceneFromParent * node.mTransformation;
    const bool mirrored = aiMatrix3x3(sceneFromNode).Determinant() < 0;  // reverses the winding
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
        const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
        if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (unsigned v = 0; v < part.mNumVertices; ++v) {
            const aiVector3D position = sceneFromNode * part.mVertices[v];
            mesh.vertices.emplace_back(position.x, position.y, position.z);
        }
        for (unsigned f = 0; f < part.mNumFaces; ++f) {
            const unsigned* corner = part.mFaces[f].mIndices;
            const glm::uvec3 triangle = first + glm::uvec3(corner[0], corner[mirrored ? 2 : 1], corner[mirrored ? 1 : 2]);
            // In double, so that the area of a huge triangle is finite.
            const glm::dvec3 a = mesh.vertices[triangle.x], b = mesh.vertices[triangle.y], c = mesh.vertices[triangle.z];
            if (glm::length(glm::cross(b - a, c - a)) > 0) mesh.triangles.push_back(triangle);
        }
    }
    for (unsigned child = 0; child < node.mNumChildren; ++child) append(scene, *node.mChildren[child], sceneFromNode, mesh);
}

// An FBX declares its right, up and front axes; assimp reports them but does not apply them.
aiMatrix4x4 sceneFromFile(const aiScene& scene) {
    aiMatrix4x4 turned;
    constexpr std::pair<unsigned, const char*> kAxes[] = {{0, "CoordAxis"}, {1, "UpAxis"}, {2, "FrontAxis"}};
    for (const auto& [row, key] : kAxes) {
        int axis = 0, sign = 0;
        if (scene.mMetaData == nullptr || !scene.mMetaData->Get(key, axis) ||
            !scene.mMetaData->Get(std::string(key) + "Sign", sign))
            return {};
        for (int column = 0; column < 3; ++column) turned[row][column] = column == axis ? static_cast<float>(sign) : 0.0f;
    }
    const bool areThree = std::abs(aiMatrix3x3(turned).Determinant()) == 1;
    return areThree ? turned : aiMatrix4x4();
}

bool isFinite(const glm::vec3& point) { return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z); }

}  // namespace

Result<TriangleMesh> readMesh(const std::filesystem::path& path) {
    TRY(readStart(path, 0));  // assimp's own message for a missing file gives no reason
    const auto refused = [&](std::string_view why) { return Error(fmt::format("{}: {}", path.string(), why)); };
    Assimp::Importer importer;
    auto* const files = new Files;
    importer.SetIOHandler(files);  // owned by the importer from now on
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TEXCOORDS | aiComponent_COLORS |
                                                            aiComponent_TANGENTS_AND_BITANGENTS);
    const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_RemoveComponent |
                                                                aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
    if (files->refusal) return *files->refusal;
    if (scene == nullptr)
        return refused(fmt::format("not a mesh that can be read: {}; export it as FBX, OBJ or glTF", importer.GetErrorString()));
    TriangleMesh mesh;
    append(*scene, *scene->mRootNode, sceneFromFile(*scene), mesh);
    if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), isFinite))
        return refused("a vertex coordinate is not a finite number");
    if (mesh.triangles.empty())
        return refused("has no triangles; export the surface itself, not only points, lines or an empty node");
    return mesh;
}

Result<void> writeObj(const std::filesystem::path& path, const TriangleMesh& mesh) {
    std::string text;
    const auto out = std::back_inserter(text);
    for (const glm::vec3& v : mesh.vertices) fmt::format_to(out, "v {} {} {}\n", v.x, v.y, v.z);
    for (const glm::uvec3& t : mesh.triangles) fmt::format_to(out, "f {} {} {}\n", t.x + 1, t.y + 1, t.z + 1);
    return writeFile(path, text);
}

}  // namespace fantascope
