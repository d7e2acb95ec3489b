#include "pattern/elemental_shape.h"

#include "core/check.h"
#include "core/config.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace fantascope::pattern {
namespace {

namespace fs = std::filesystem;

// A front view with less area than this (in radius^2) is a line to the eye.
constexpr double kLeastFrontArea = 1e-3;

// A convex outline, anticlockwise, as a fan.
TriangleMesh fan(std::vector<glm::vec3> outline) {
    TriangleMesh mesh{std::move(outline), {}};
    for (std::uint32_t i = 2; i < mesh.vertices.size(); ++i) mesh.triangles.emplace_back(0, i - 1, i);
    return mesh;
}

// Corners on the unit circle, standing on a side.
TriangleMesh regularPolygon(int corners) {
    std::vector<glm::vec3> outline;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.5) / corners - std::numbers::pi / 2;
        outline.emplace_back(std::cos(angle), std::sin(angle), 0);
    }
    return fan(std::move(outline));
}

// Two arcs that meet in a tip above and below, as wide as a half of its length.
TriangleMesh leaf() {
    constexpr int kSides = 8;  // straight pieces an arc
    // The arc through the tips (0, +-1) and the flank (1/2, 0) has its centre at (-3/4, 0).
    const double radius = 1.25, tip = std::asin(1 / radius);
    std::vector<glm::vec3> outline;
    for (const double side : {1.0, -1.0})
        for (int i = 0; i < kSides; ++i) {
            const double angle = tip * (2.0 * i / kSides - 1);
            outline.emplace_back(side * (radius * std::cos(angle) - 0.75), side * radius * std::sin(angle), 0);
        }
    return fan(std::move(outline));
}

struct BuiltIn {
    std::string name;
    std::function<TriangleMesh()> mesh;
};
const std::vector<BuiltIn>& builtIns() {
    static const std::vector<BuiltIn> shapes = {
        {"triangle", [] { return regularPolygon(3); }},
        {"square", [] { return regularPolygon(4); }},
        {"circle", [] { return regularPolygon(24); }},
        {"leaf", leaf},
    };
    return shapes;
}

// The area that the triangles cover when projected along z, those in front of each other counted each; a fold of a surface cannot
// hide all.
double projectedArea(const TriangleMesh& mesh) {
    double doubled = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = mesh.vertices[t.x], b = mesh.vertices[t.y], c = mesh.vertices[t.z];
        doubled += std::abs(glm::cross(b - a, c - a).z);
    }
    return doubled / 2;
}

glm::dvec3 surfaceCentre(const TriangleMesh& mesh) {
    glm::dvec3 weighted(0.0);
    double total = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = mesh.vertices[t.x], b = mesh.vertices[t.y], c = mesh.vertices[t.z];
        const double area = glm::length(glm::cross(b - a, c - a));
        weighted += area * (a + b + c) / 3.0;
        total += area;
    }
    return weighted / total;
}

}  // namespace

const std::vector<std::string>& builtInShapeNames() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const BuiltIn& shape : builtIns()) list.push_back(shape.name);
        return list;
    }();
    return names;
}

Result<ElementalShape> makeShape(std::string name, TriangleMesh mesh) {
    FANTASCOPE_CHECK(!mesh.triangles.empty(), "a mesh has triangles");
    const glm::dvec3 centre = surfaceCentre(mesh);
    double radius = 0;
    for (const glm::uvec3& t : mesh.triangles)
        for (const std::uint32_t corner : {t.x, t.y, t.z})
            radius = std::max(radius, glm::length(glm::dvec3(mesh.vertices[corner]) - centre));
    for (glm::vec3& vertex : mesh.vertices) vertex = (glm::dvec3(vertex) - centre) / radius;
    if (projectedArea(mesh) < kLeastFrontArea)
        return Error(fmt::format(
            "{}: seen from the front (along -z) the shape has no area; turn it so that its face looks along +z, y up", name));
    return ElementalShape{std::move(name), std::move(mesh)};
}

Result<ElementalShape> loadShape(const std::string& nameOrFile) {
    for (const BuiltIn& shape : builtIns())
        if (shape.name == nameOrFile) return makeShape(shape.name, shape.mesh());
    const fs::path file = nameOrFile;
    if (!file.has_extension() && !fs::exists(file)) {
        const std::string nearest = nearestName(file.filename().string(), builtInShapeNames());
        return Error(fmt::format("'{}' is not a shape: neither a file nor one of {}{}", nameOrFile,
                                 fmt::join(builtInShapeNames(), ", "),
                                 nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
    }
    return makeShape(nameOrFile, TRY(readMesh(file)));
}

}  // namespace fantascope::pattern
