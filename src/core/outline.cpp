#include "core/outline.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

#include <map>

namespace fantascope {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Default, CGAL::Exact_predicates_tag>;  // rings may cross

glm::dvec2 toGlm(const Point& point) { return {point.x(), point.y()}; }

// After Douglas & Peucker (1973).
Outline simplified(const Outline& outline, double tolerance) {
    Outline result;
    for (const auto& ring : outline.rings) {
        std::vector<cv::Point2f> points, fewer;
        for (const glm::dvec2 point : ring) points.emplace_back(static_cast<float>(point.x), static_cast<float>(point.y));
        cv::approxPolyDP(points, fewer, tolerance, true);
        if (fewer.size() < 3) continue;
        auto& kept = result.rings.emplace_back();
        for (const cv::Point2f point : fewer) kept.emplace_back(point.x, point.y);
    }
    return result;
}

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
    constexpr double kCoarser = 1.25;
    Outline result = simplified(outline, tolerance);
    while (result.pointCount() > most) result = simplified(outline, tolerance *= kCoarser);
    return result;
}

TriangleMesh filled(const Outline& outline) {
    Triangulation triangulation;
    for (const auto& ring : outline.rings) {
        std::vector<Point> points;
        for (const glm::dvec2 point : ring) points.emplace_back(point.x, point.y);
        triangulation.insert_constraint(points.begin(), points.end(), true);
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
