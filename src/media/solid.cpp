#include "media/solid.h"

#include "core/file.h"
#include "core/parallel.h"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <string>
#include <utility>

namespace fantascope {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

// Triangles keep their indices. Empty if the triangles form no surface.
Surface surfaceOf(const TriangleMesh& mesh) {
    std::vector<Kernel::Point_3> points;
    points.reserve(mesh.vertices.size());
    for (const glm::vec3& v : mesh.vertices) points.emplace_back(v.x, v.y, v.z);
    std::vector<std::array<std::size_t, 3>> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) triangles.push_back({t.x, t.y, t.z});
    Surface surface;
    if (processing::is_polygon_soup_a_polygon_mesh(triangles))
        processing::polygon_soup_to_polygon_mesh(points, triangles, surface);
    return surface;
}

}  // namespace

SolidCheck checkSolid(const TriangleMesh& mesh) {
    SolidCheck check;
    const Surface surface = surfaceOf(mesh);
    check.isManifold = surface.number_of_faces() > 0;
    if (!check.isManifold) return check;
    check.isClosed = CGAL::is_closed(surface);
    std::vector<std::pair<Surface::Face_index, Surface::Face_index>> crossings;
    processing::self_intersections(surface, std::back_inserter(crossings));
    for (const auto& [one, other] : crossings) {
        check.crossings.push_back(one);
        check.crossings.push_back(other);
    }
    std::sort(check.crossings.begin(), check.crossings.end());
    check.crossings.erase(std::unique(check.crossings.begin(), check.crossings.end()), check.crossings.end());
    std::vector<std::size_t> pieces(surface.number_of_faces());
    check.pieces = processing::connected_components(
        surface, boost::make_iterator_property_map(pieces.begin(), get(boost::face_index, surface)));
    if (!check.isClosed) return check;
    check.volume = processing::volume(surface);
    check.facesOutward = processing::is_outward_oriented(surface);
    return check;
}

std::vector<double> thicknesses(const TriangleMesh& mesh, std::size_t every) {
    const Surface surface = surfaceOf(mesh);
    std::vector<double> found((mesh.triangles.size() + every - 1) / every, std::numeric_limits<double>::infinity());
    if (surface.number_of_faces() == 0) return found;
    using Primitive = CGAL::AABB_face_graph_triangle_primitive<Surface>;
    using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
    Tree tree(faces(surface).begin(), faces(surface).end(), surface);
    tree.build();
    constexpr int kSlices = 64;
    parallelFor(kSlices, hardwareThreads(), [&](int slice) {
        for (auto i = static_cast<std::size_t>(slice); i < found.size(); i += kSlices) {
            const std::size_t t = i * every;
            const glm::uvec3& corners = mesh.triangles[t];
            const glm::dvec3 a = mesh.vertices[corners.x], b = mesh.vertices[corners.y], c = mesh.vertices[corners.z];
            const glm::dvec3 middle = (a + b + c) / 3.0, inward = -glm::cross(b - a, c - a);
            if (glm::length(inward) == 0) continue;
            const Kernel::Ray_3 ray(Kernel::Point_3(middle.x, middle.y, middle.z),
                                    Kernel::Vector_3(inward.x, inward.y, inward.z));
            const Surface::Face_index own(static_cast<std::uint32_t>(t));
            const auto hit = tree.first_intersection(ray, [&](const Surface::Face_index& face) { return face == own; });
            if (!hit) continue;
            if (const auto* at = boost::get<Kernel::Point_3>(&hit->first))
                found[i] = glm::distance(middle, {at->x(), at->y(), at->z()});
        }
    });
    return found;
}

Result<void> writeStl(const std::filesystem::path& path, const TriangleMesh& mesh) {
    static_assert(std::endian::native == std::endian::little, "STL is little-endian");
    std::string bytes(80, ' ');
    bytes.replace(0, 10, "fantascope");  // not "solid", which marks an STL in text form
    const auto append = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    append(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 &a = mesh.vertices[t.x], &b = mesh.vertices[t.y], &c = mesh.vertices[t.z];
        const glm::dvec3 normal = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
        const double length = glm::length(normal);
        append(length > 0 ? glm::vec3(normal / length) : glm::vec3(0));
        append(a), append(b), append(c);
        append(std::uint16_t{0});
    }
    return writeFile(path, bytes);
}

}  // namespace fantascope
