#include "core/mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/file.h"

namespace fantascope {

Result<TriangleMesh> readMesh(const std::filesystem::path& path) {
    // assimp's own message for a missing file does not say why; readFile's does.
    if (auto readable = readFile(path); !readable) return readable.error();
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TEXCOORDS | aiComponent_COLORS | aiComponent_TANGENTS_AND_BITANGENTS);
    const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_RemoveComponent |
                                                                aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
    if (scene == nullptr) return Error(fmt::format("{}: not a mesh that can be read: {}; export it as FBX, OBJ or glTF", path.string(), importer.GetErrorString()));
    TriangleMesh mesh;
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
        const aiMesh& part = *scene->mMeshes[m];
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (unsigned v = 0; v < part.mNumVertices; ++v) {
            const aiVector3D& p = part.mVertices[v];
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
                return Error(fmt::format("{}: a vertex coordinate is not a finite number", path.string()));
            mesh.vertices.emplace_back(p.x, p.y, p.z);
        }
        for (unsigned f = 0; f < part.mNumFaces; ++f) {
            const aiFace& face = part.mFaces[f];
            if (face.mNumIndices != 3) continue;
            const glm::uvec3 triangle(first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]);
            const glm::vec3 a = mesh.vertices[triangle.x], b = mesh.vertices[triangle.y], c = mesh.vertices[triangle.z];
            if (glm::length(glm::cross(b - a, c - a)) > 0) mesh.triangles.push_back(triangle);
        }
    }
    if (mesh.triangles.empty()) return Error(fmt::format("{}: has no triangles; export the surface itself, not only points, lines or an empty node", path.string()));
    return mesh;
}

}  // namespace fantascope
