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

// A front view with less area than this (in radius^2) looks like a line.
constexpr double kMinFrontArea = 1e-3;
// A thousand copies of a larger mesh cannot be drawn and compared in a useful time.
constexpr std::size_t kMaxTriangles = 20'000;

// The sum of the triangles' areas projected along z. It is an upper bound of the visible area, and
// it is 0 only if the front view shows nothing.
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
    if (mesh.triangles.empty()) return Error(fmt::format("{}: has no surface", name));
    if (mesh.triangles.size() > kMaxTriangles)
        return Error(fmt::format(
            "{}: has {} triangles, at most {} are allowed, since every copy draws them all; reduce the mesh to a few hundred",
            name, mesh.triangles.size(), kMaxTriangles));
    const glm::dvec3 centre = surfaceCentre(mesh);
    double radius = 0;
    for (const glm::uvec3& t : mesh.triangles)
        for (const std::uint32_t corner : {t.x, t.y, t.z})
            radius = std::max(radius, glm::length(glm::dvec3(mesh.vertices[corner]) - centre));
    for (glm::vec3& vertex : mesh.vertices) vertex = (glm::dvec3(vertex) - centre) / radius;
    if (projectedArea(mesh) < kMinFrontArea)
        return Error(fmt::format("{}: has no area seen from the front (along -z); turn it so that it faces +z, with y up", name));
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
