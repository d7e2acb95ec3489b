#pragma once

#include "media/mesh.h"

#include <glm/vec4.hpp>

namespace fantascope {

// From corner to corner.
inline TriangleMesh boxMesh(const glm::vec3& least, const glm::vec3& most) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < 8; ++i)
        mesh.vertices.emplace_back((i & 1U) != 0 ? most.x : least.x, (i & 2U) != 0 ? most.y : least.y,
                                   (i & 4U) != 0 ? most.z : least.z);
    for (const glm::uvec4& q : {glm::uvec4(0, 2, 3, 1), {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
        mesh.triangles.insert(mesh.triangles.end(), {{q.x, q.y, q.z}, {q.x, q.z, q.w}});
    return mesh;
}

inline TriangleMesh both(TriangleMesh one, const TriangleMesh& other) {
    const auto first = static_cast<unsigned>(one.vertices.size());
    one.vertices.insert(one.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const glm::uvec3& t : other.triangles) one.triangles.push_back(t + first);
    return one;
}

inline TriangleMesh insideOut(TriangleMesh mesh) {
    for (glm::uvec3& t : mesh.triangles) t = {t.x, t.z, t.y};
    return mesh;
}

}  // namespace fantascope
