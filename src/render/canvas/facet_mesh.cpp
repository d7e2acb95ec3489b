#include "render/canvas/facet_mesh.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace fantascope::render {
namespace {

// Facets count as parallel if 1 - cosine of the angle between their normals is smaller; some 0.8
// degrees.
constexpr float kParallel = 1e-4f;

glm::vec3 normalOf(const TriangleMesh& mesh, glm::uvec3 triangle) {
    const glm::vec3 a = mesh.vertices[triangle.x], b = mesh.vertices[triangle.y], c = mesh.vertices[triangle.z];
    const glm::vec3 across = glm::cross(b - a, c - a);
    const float length = glm::length(across);
    return length > 0 ? across / length : glm::vec3(0);
}

// Whether triangles traverse every edge once in each direction, and facets face outwards.
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

TriangleMesh cutUp(TriangleMesh mesh, double longest) {
    for (bool cut = true; cut;) {
        cut = false;
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        // The vertex in the middle of an edge that is too long.
        const auto middle = [&](std::uint32_t a, std::uint32_t b) -> std::optional<std::uint32_t> {
            if (static_cast<double>(glm::distance(mesh.vertices[a], mesh.vertices[b])) <= longest) return std::nullopt;
            const auto [place, isNew] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
            if (isNew) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]) / 2.0f);
            return place->second;
        };
        std::vector<glm::uvec3> triangles;
        for (glm::uvec3 t : mesh.triangles) {
            std::array<std::optional<std::uint32_t>, 3> cuts = {middle(t.x, t.y), middle(t.y, t.z), middle(t.z, t.x)};
            const auto count = std::count_if(cuts.begin(), cuts.end(), [](const auto& place) { return place.has_value(); });
            cut |= count > 0;
            // Rotates the corners so that the cut edges come first: xy, then yz, then zx.
            while (count > 0 && !(cuts[0] && (count == 1 || cuts[1]))) {
                t = {t.y, t.z, t.x};
                std::rotate(cuts.begin(), cuts.begin() + 1, cuts.end());
            }
            if (count == 0)
                triangles.push_back(t);
            else if (count == 1)
                triangles.insert(triangles.end(), {{t.x, *cuts[0], t.z}, {*cuts[0], t.y, t.z}});
            else if (count == 2)
                triangles.insert(triangles.end(), {{*cuts[0], t.y, *cuts[1]}, {t.x, *cuts[0], *cuts[1]}, {t.x, *cuts[1], t.z}});
            else
                triangles.insert(triangles.end(), {{t.x, *cuts[0], *cuts[2]},
                                                   {*cuts[0], t.y, *cuts[1]},
                                                   {*cuts[2], *cuts[1], t.z},
                                                   {*cuts[0], *cuts[1], *cuts[2]}});
        }
        mesh.triangles = std::move(triangles);
    }
    return mesh;
}

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
        // Rotates the corners until the last one is not the last of another triangle; if there is
        // none, copies one.
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
