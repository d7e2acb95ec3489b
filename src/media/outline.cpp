#include "media/outline.h"

#include "core/check.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

namespace fantascope {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Default, CGAL::Exact_predicates_tag>;  // rings may cross
using FineTriangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel,
    CGAL::Triangulation_data_structure_2<CGAL::Delaunay_mesh_vertex_base_2<Kernel>, CGAL::Delaunay_mesh_face_base_2<Kernel>>,
    CGAL::Exact_predicates_tag>;

glm::dvec2 toGlm(const Point& point) { return {point.x(), point.y()}; }

// Douglas & Peucker (1973).
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

// Counts the rings that a ray to the right crosses.
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

template <class Triangulation>
void insertRings(const Outline& outline, Triangulation& triangulation) {
    for (const auto& ring : outline.rings) {
        std::vector<Point> points;
        points.reserve(ring.size());
        for (const glm::dvec2 point : ring) points.emplace_back(point.x, point.y);
        triangulation.insert_constraint(points.begin(), points.end(), true);
    }
}

// No ring passes through a triangle, so one point decides.
template <class Face>
bool isFaceInside(const Outline& outline, const Face& face) {
    return isInside(outline,
                    (toGlm(face.vertex(0)->point()) + toGlm(face.vertex(1)->point()) + toGlm(face.vertex(2)->point())) / 3.0);
}

// The wanted triangles, with each used vertex once.
template <class Triangulation, class IsWanted>
FlatMesh trianglesOf(const Triangulation& triangulation, IsWanted isWanted) {
    FlatMesh mesh;
    std::map<typename Triangulation::Vertex_handle, std::uint32_t> indices;
    for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
        if (!isWanted(*face)) continue;
        glm::uvec3 triangle(0);
        for (int corner = 0; corner < 3; ++corner) {
            const auto vertex = face->vertex(corner);
            const auto [known, isNew] = indices.try_emplace(vertex, static_cast<std::uint32_t>(mesh.vertices.size()));
            if (isNew) mesh.vertices.push_back(toGlm(vertex->point()));
            triangle[corner] = known->second;
        }
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

// Walks along the borders of a picture through the squares between four pixel centres (Lorensen &
// Cline 1987, in the plane), with the light on the right.
class BorderTracer {
public:
    explicit BorderTracer(const GreyImage& picture) : picture_(picture) {}

    Outline run() {
        std::vector<std::int64_t> order;
        for (int y = -1; y < picture_.height(); ++y)
            for (int x = -1; x < picture_.width(); ++x) lookAt(x, y, order);
        Outline outline;
        for (const std::int64_t first : order) {
            if (!next_.contains(first)) continue;  // already walked
            auto& ring = outline.rings.emplace_back();
            std::int64_t side = first;
            do {
                const auto step = next_.find(side);
                FANTASCOPE_CHECK(step != next_.end(), "a border has no end");
                ring.push_back(step->second.point);
                side = step->second.to;
                next_.erase(step);
            } while (side != first);
        }
        return outline;
    }

private:
    struct Step {
        std::int64_t to;
        glm::dvec2 point;
    };
    static constexpr double kHalf = 0.5;

    double at(glm::ivec2 pixel) const {
        const bool isIn = pixel.x >= 0 && pixel.y >= 0 && pixel.x < picture_.width() && pixel.y < picture_.height();
        return isIn ? double(picture_.at(pixel.x, pixel.y)) : 0;
    }
    // Where the light passes a half between two neighbours: never at a centre, where other borders
    // may pass.
    glm::dvec2 crossing(glm::ivec2 a, glm::ivec2 b) const {
        const double share = std::clamp((kHalf - at(a)) / (at(b) - at(a)), 0.01, 0.99);
        return glm::dvec2(a) + 0.5 + share * glm::dvec2(b - a);
    }

    // Handles the square whose top left corner is a pixel's centre.
    void lookAt(int x, int y, std::vector<std::int64_t>& order) {
        const std::array<glm::ivec2, 4> corners = {glm::ivec2(x, y), {x + 1, y}, {x + 1, y + 1}, {x, y + 1}};  // clockwise
        std::array<bool, 4> light;
        for (std::size_t i = 0; i < 4; ++i) light[i] = at(corners[i]) > kHalf;
        const auto isLight = [&](std::size_t i) { return light[i % 4]; };
        const auto lights = std::count(light.begin(), light.end(), true);
        if (lights == 0 || lights == 4) return;
        const bool isSaddle = lights == 2 && light[0] == light[2];
        // Diagonal corners are connected unless the middle is dark.
        const bool areJoined = isSaddle && at(corners[0]) + at(corners[1]) + at(corners[2]) + at(corners[3]) >= 4 * kHalf;
        // A border enters through a side where light turns dark, clockwise, and leaves through one
        // where dark turns light.
        for (std::size_t i = 0; i < 4; ++i) {
            if (!isLight(i) || isLight(i + 1)) continue;
            std::size_t out = i;
            do out += isSaddle && !areJoined ? 3 : 1;
            while (isLight(out % 4) || !isLight(out + 1));
            const std::int64_t from = side(x, y, i);
            next_.emplace(from, Step{side(x, y, out % 4), crossing(corners[i], corners[(i + 1) % 4])});
            order.push_back(from);
        }
    }
    // The number of a square's side, shared with the neighbour: top, right, bottom, left.
    std::int64_t side(int x, int y, std::size_t i) const {
        if (i == 1) ++x;
        if (i == 2) ++y;
        const std::int64_t square = (std::int64_t{y} + 1) * (picture_.width() + 2) + x + 1;
        return 2 * square + (i % 2 == 0 ? 0 : 1);
    }

    const GreyImage& picture_;
    std::unordered_map<std::int64_t, Step> next_;  // by the side through which a border enters
};

}  // namespace

std::size_t Outline::pointCount() const {
    std::size_t count = 0;
    for (const auto& ring : rings) count += ring.size();
    return count;
}

Outline simplified(const Outline& outline, double tolerance, std::size_t maxPoints) {
    constexpr double kCoarser = 1.25;
    Outline result = simplified(outline, tolerance);
    while (result.pointCount() > maxPoints) result = simplified(outline, tolerance *= kCoarser);
    return result;
}

TriangleMesh filled(const Outline& outline) {
    Triangulation triangulation;
    insertRings(outline, triangulation);
    FlatMesh flat = trianglesOf(triangulation, [&](const auto& face) { return isFaceInside(outline, face); });
    TriangleMesh mesh;
    for (const glm::dvec2 vertex : flat.vertices) mesh.vertices.emplace_back(vertex.x, vertex.y, 0);
    mesh.triangles = std::move(flat.triangles);
    return mesh;
}

FlatMesh meshed(const Outline& outline, double maxEdge) {
    constexpr int kMaxSteps = 300'000;
    constexpr double kAngle = 0.125;  // the squared sine of 20.7 degrees, with which refinement is guaranteed to end
    FineTriangulation triangulation;
    insertRings(outline, triangulation);
    for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face)
        face->set_in_domain(isFaceInside(outline, *face));
    using Criteria = CGAL::Delaunay_mesh_size_criteria_2<FineTriangulation>;
    CGAL::Delaunay_mesher_2<FineTriangulation, Criteria> mesher(triangulation, Criteria(kAngle, maxEdge));
    mesher.init(true);
    // If rings lie within rounding error of themselves, refinement may never end; the result so far
    // is good enough.
    for (int step = 0; step < kMaxSteps && mesher.try_one_step_refine_mesh(); ++step) {
    }
    return trianglesOf(triangulation, [](const auto& face) { return face.is_in_domain(); });
}

Outline tracedBorders(const GreyImage& picture) { return BorderTracer(picture).run(); }

GreyImage drawn(const Outline& outline, int width, int height) {
    constexpr int kLines = 16;  // per row of pixels
    struct Crossing {
        double x;
        int turn;
    };
    std::vector<std::vector<Crossing>> lines(static_cast<std::size_t>(height) * kLines);
    for (const auto& ring : outline.rings)
        for (std::size_t i = 0; i < ring.size(); ++i) {
            glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
            const int turn = a.y < b.y ? 1 : -1;
            if (turn < 0) std::swap(a, b);
            // The lines at heights (k + 1/2) / kLines from a, inclusive, to b, exclusive.
            const double last = static_cast<double>(lines.size());
            const auto firstLine = [&](double y) {
                return static_cast<std::size_t>(std::clamp(std::ceil(y * kLines - 0.5), 0.0, last));
            };
            for (std::size_t line = firstLine(a.y); line < firstLine(b.y); ++line) {
                const double y = (static_cast<double>(line) + 0.5) / kLines;
                lines[line].push_back({a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x), turn});
            }
        }
    GreyImage picture(width, height);
    std::vector<double> row(static_cast<std::size_t>(width));
    const auto fill = [&](double from, double to) {
        from = std::clamp(from, 0.0, double(width)), to = std::clamp(to, 0.0, double(width));
        for (int x = static_cast<int>(from); x < to; ++x)
            row[static_cast<std::size_t>(x)] += std::min(to, x + 1.0) - std::max(from, double(x));
    };
    for (int y = 0; y < height; ++y) {
        std::fill(row.begin(), row.end(), 0.0);
        for (int line = 0; line < kLines; ++line) {
            auto& crossings = lines[static_cast<std::size_t>(y) * kLines + static_cast<std::size_t>(line)];
            std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
            int turns = 0;
            for (std::size_t i = 0; i + 1 < crossings.size(); ++i)
                if ((turns += crossings[i].turn) != 0) fill(crossings[i].x, crossings[i + 1].x);
        }
        for (int x = 0; x < width; ++x)
            picture.at(x, y) = static_cast<float>(std::min(1.0, row[static_cast<std::size_t>(x)] / kLines));
    }
    return picture;
}

}  // namespace fantascope
