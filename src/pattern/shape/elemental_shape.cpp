#include "pattern/shape/elemental_shape.h"

#include "pattern/shape/built_in_shapes.h"

#include "media/outline_file.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::pattern {
namespace {

namespace fs = std::filesystem;

// A front view with less area than this (in radius^2) is a line to the eye.
constexpr double kLeastFrontArea = 1e-3;
// A thousand copies of more are drawn and compared in no useful time.
constexpr std::size_t kMostTriangles = 20'000;

// The area that the triangles cover when projected along z, those in front of each other counted
// each; a fold of a surface cannot hide all.
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

Result<ElementalShape> makeShape(std::string name, TriangleMesh mesh) {
    if (mesh.triangles.empty()) return Error(fmt::format("{}: shows nothing that has an area", name));
    if (mesh.triangles.size() > kMostTriangles)
        return Error(
            fmt::format("{}: has {} triangles, {} may be, for each is drawn in every copy; reduce the mesh to some hundred", name,
                        mesh.triangles.size(), kMostTriangles));
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

Result<ElementalShape> readShapeFile(const fs::path& file, const std::string& name) {
    TriangleMesh mesh = isOutlineFile(file) ? filled(TRY(readOutline(file))) : TRY(readMesh(file));
    ElementalShape shape = TRY(makeShape(name, std::move(mesh)));
    shape.file = file;
    return shape;
}

Result<ElementalShape> builtInShape(const std::string& name) {
    TriangleMesh mesh = TRY(builtInMesh(name));
    return makeShape(name, std::move(mesh));
}

Result<ElementalShape> loadShape(const std::string& nameOrFile) {
    const fs::path file = nameOrFile;
    if (isBuiltInShape(nameOrFile)) return builtInShape(nameOrFile);
    if (!file.has_extension() && !fs::exists(file)) return builtInShape(nameOrFile).in("neither a file nor built in");
    return readShapeFile(file, nameOrFile);
}

}  // namespace fantascope::pattern
