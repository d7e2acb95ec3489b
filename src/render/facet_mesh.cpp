#include "render/facet_mesh.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace fantascope::render {
namespace {

// Facets whose normals differ by less (1 - cosine; some 0.8 degrees) are parallel.
constexpr float kParallel = 1e-4f;

glm::vec3 normalOf(const TriangleMesh& mesh, glm::uvec3 triangle) {
    const glm::vec3 a = mesh.vertices[triangle.x], b = mesh.vertices[triangle.y], c = mesh.vertices[triangle.z];
    const glm::vec3 across = glm::cross(b - a, c - a);
    const float length = glm::length(across);
    return length > 0 ? across / length : glm::vec3(0);
}

// Whether every edge is walked once in each direction, and the facets look outwards.
bool isClosed(const TriangleMesh& mesh) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> walked;
    float volume = 0;
    for (const glm::uvec3 t : mesh.triangles) {
        for (const auto& edge : {std::pair(t.x, t.y), std::pair(t.y, t.z), std::pair(t.z, t.x)})
            if (!walked.insert(edge).second) return false;
        volume += glm::dot(mesh.vertices[t.x], glm::cross(mesh.vertices[t.y], mesh.vertices[t.z]));
    }
    const auto walkedBack = [&](const auto& edge) { return walked.contains({edge.second, edge.first}); };
    return volume > 0 && std::all_of(walked.begin(), walked.end(), walkedBack);
}

}  // namespace

FacetMesh facetMesh(const TriangleMesh& mesh) {
    std::vector<glm::vec3> normals;
    for (const glm::uvec3 triangle : mesh.triangles) normals.push_back(normalOf(mesh, triangle));
    const bool flat = std::all_of(normals.begin(), normals.end(),
                                  [&](glm::vec3 normal) { return std::abs(glm::dot(normal, normals[0])) > 1 - kParallel; });
    if (flat) std::fill(normals.begin(), normals.end(), glm::vec3(0));

    FacetMesh facets;
    facets.closed = isClosed(mesh);
    for (const glm::vec3 position : mesh.vertices) facets.vertices.push_back({position, glm::vec3(0)});
    std::vector<bool> taken(mesh.vertices.size(), false);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        // Turn the triangle round until its last corner is one that no other triangle has taken; failing that, copy one.
        std::array<std::uint32_t, 3> corners = {mesh.triangles[t].x, mesh.triangles[t].y, mesh.triangles[t].z};
        for (int turn = 0; turn < 2 && taken[corners[2]]; ++turn)
            std::rotate(corners.begin(), corners.begin() + 1, corners.end());
        if (taken[corners[2]]) {
            facets.vertices.push_back({mesh.vertices[corners[2]], glm::vec3(0)});
            corners[2] = static_cast<std::uint32_t>(facets.vertices.size() - 1);
        } else {
            taken[corners[2]] = true;
        }
        facets.vertices[corners[2]].normal = normals[t];
        facets.indices.insert(facets.indices.end(), corners.begin(), corners.end());
    }
    return facets;
}

}  // namespace fantascope::render
