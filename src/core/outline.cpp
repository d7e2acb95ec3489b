#include "core/outline.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polyline_simplification_2/Squared_distance_cost.h>
#include <CGAL/Polyline_simplification_2/simplify.h>
#include <glm/geometric.hpp>

#include <map>

namespace fantascope {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Vertex = CGAL::Polyline_simplification_2::Vertex_base_2<Kernel>;
using Face = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>,
                                                                 CGAL::Exact_predicates_tag>;  // rings that cross are cut there
using Polylines = CGAL::Constrained_triangulation_plus_2<Triangulation>;

glm::dvec2 toGlm(const Point& point) { return {point.x(), point.y()}; }

std::vector<Point> toCgal(const std::vector<glm::dvec2>& ring) {
    std::vector<Point> points;
    for (const glm::dvec2 point : ring) points.emplace_back(point.x, point.y);
    return points;
}

// When points may no longer be taken away, the cheapest first.
struct Stop {
    double tolerance;
    std::size_t most;

    template <class VertexHandle>
    bool operator()(const Polylines&, VertexHandle, double squaredDistance, std::size_t, std::size_t count) const {
        return squaredDistance > tolerance * tolerance && count <= most;
    }
};

// By the rings that a ray to the right crosses.
bool isInside(const Outline& outline, glm::dvec2 point) {
    bool inside = false;
    for (const auto& ring : outline.rings)
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
            if ((a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x))
                inside = !inside;
        }
    return inside;
}

}  // namespace

std::size_t Outline::pointCount() const {
    std::size_t count = 0;
    for (const auto& ring : rings) count += ring.size();
    return count;
}

Outline simplified(const Outline& outline, double tolerance, std::size_t most) {
    Polylines polylines;
    for (const auto& ring : outline.rings) {
        const std::vector<Point> points = toCgal(ring);
        polylines.insert_constraint(points.begin(), points.end(), true);
    }
    CGAL::Polyline_simplification_2::simplify(polylines, CGAL::Polyline_simplification_2::Squared_distance_cost(),
                                              Stop{tolerance, most});
    Outline result;
    for (auto id = polylines.constraints_begin(); id != polylines.constraints_end(); ++id) {
        auto& ring = result.rings.emplace_back();
        for (auto vertex = polylines.vertices_in_constraint_begin(*id); vertex != polylines.vertices_in_constraint_end(*id);
             ++vertex)
            ring.push_back(toGlm((*vertex)->point()));
        if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    }
    return result;
}

TriangleMesh filled(const Outline& outline) {
    Triangulation triangulation;
    for (const auto& ring : outline.rings) {
        const std::vector<Point> points = toCgal(ring);
        if (points.size() > 2) triangulation.insert_constraint(points.begin(), points.end(), true);
    }
    TriangleMesh mesh;
    std::map<Triangulation::Vertex_handle, std::uint32_t> indices;
    for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
        // No ring passes through a triangle: all of it is inside, or nothing.
        const glm::dvec2 middle =
            (toGlm(face->vertex(0)->point()) + toGlm(face->vertex(1)->point()) + toGlm(face->vertex(2)->point())) / 3.0;
        if (!isInside(outline, middle)) continue;
        glm::uvec3 triangle(0);
        for (int corner = 0; corner < 3; ++corner) {
            const auto vertex = face->vertex(corner);
            const auto [known, isNew] = indices.try_emplace(vertex, static_cast<std::uint32_t>(mesh.vertices.size()));
            if (isNew) mesh.vertices.emplace_back(vertex->point().x(), vertex->point().y(), 0);
            triangle[corner] = known->second;
        }
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

}  // namespace fantascope
