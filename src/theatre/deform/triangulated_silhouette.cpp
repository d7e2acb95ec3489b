#include "theatre/deform/triangulated_silhouette.h"

#include "theatre/energy/pose_problem.h"

#include "core/check.h"
#include "core/disjoint_sets.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace fantascope::theatre {
namespace {

// Pixels. The blur removes the pixel staircase from the outline of a black and white picture. It
// does not move a straight border.
constexpr double kBlur = 0.6, kMargin = 4;
// The tolerance of the triangles' border from the picture's: a share of the edge length, and at
// least a number of pixels that the fine outline hides.
constexpr double kCoarse = 0.06, kLeastCoarse = 0.1;
constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

// The signed area of a ring; positive if it encloses white.
double areaOf(const std::vector<glm::dvec2>& ring) {
    double twice = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) twice += cross(ring[i], ring[(i + 1) % ring.size()]);
    return twice / 2;
}

// The number of parts that are connected by edges. Two parts that meet only in a corner would
// rotate about it freely.
std::size_t partsOf(const FlatMesh& mesh) {
    DisjointSets parts(mesh.triangles.size());
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> edges;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (int corner = 0; corner < 3; ++corner) {
            const auto edge = std::minmax(mesh.triangles[i][corner], mesh.triangles[i][(corner + 1) % 3]);
            const auto [known, isNew] = edges.try_emplace(edge, i);
            if (!isNew) parts.join(i, known->second);
        }
    return parts.count();
}

Outline smoothBordersOf(const GreyImage& picture) {
    const int margin = static_cast<int>(kMargin);
    GreyImage wide(picture.width() + 2 * margin, picture.height() + 2 * margin);
    for (int y = 0; y < picture.height(); ++y)
        std::copy(picture.row(y).begin(), picture.row(y).end(), wide.row(y + margin).begin() + margin);
    Outline borders = tracedBorders(blurred(wide, kBlur));
    for (auto& ring : borders.rings)
        for (glm::dvec2& point : ring) point -= kMargin;
    return borders;
}

Result<void> checkBorders(const Outline& borders, const GreyImage& picture) {
    if (borders.rings.empty()) return Error("nothing in it is white; a silhouette is white on black");
    if (std::none_of(picture.pixels().begin(), picture.pixels().end(), [](float value) { return value <= 0.5f; }))
        return Error("all of it is white; a silhouette is white on black, with some black around");
    if (borders.rings.size() > TriangulatedSilhouette::kMostRings)
        return Error(
            fmt::format("it has {} islands and holes, no more than {} can be moved: fill the small holes, and remove specks",
                        borders.rings.size(), TriangulatedSilhouette::kMostRings));
    for (const auto& ring : borders.rings)
        if (const double area = areaOf(ring); area > 0 && area < PoseTarget::kFewest)
            return Error(
                fmt::format("at column {:.0f}, row {:.0f} is a white speck of {:.0f} pixels; remove it, or draw it larger: fewer "
                            "than {} are no silhouette",
                            ring[0].x, ring[0].y, area, PoseTarget::kFewest));
    return {};
}

// A mesh that is coarser than the picture's outline. If islands split or merge, the tolerance is
// reduced.
Result<FlatMesh> meshOf(const Outline& borders, double edge) {
    const auto islands = static_cast<std::size_t>(
        std::count_if(borders.rings.begin(), borders.rings.end(), [](const auto& ring) { return areaOf(ring) > 0; }));
    double tolerance = std::max(kLeastCoarse, kCoarse * edge);
    while (tolerance >= kLeastCoarse / 2) {
        FlatMesh mesh = meshed(simplified(borders, tolerance, kAny), edge);
        tolerance /= 2;
        const std::vector<std::size_t> numbers = islandsOf(mesh);
        if (!numbers.empty() && *std::max_element(numbers.begin(), numbers.end()) + 1 == islands && partsOf(mesh) == islands)
            return mesh;
    }
    return Error("some of its parts all but touch each other; draw them a pixel or two apart, or together");
}

// A mesh with about this many vertices.
Result<FlatMesh> meshOf(const Outline& borders, int vertices) {
    constexpr int kRounds = 6;
    constexpr double kNear = 0.05;
    double area = 0;
    for (const auto& ring : borders.rings) area += areaOf(ring);
    FlatMesh best;
    double edge = 1.6 * std::sqrt(area / vertices), bestAway = std::numeric_limits<double>::max();
    for (int round = 0; round < kRounds && bestAway > kNear; ++round) {
        FlatMesh mesh = TRY(meshOf(borders, edge));
        const double away = std::log(static_cast<double>(mesh.vertices.size()) / vertices);
        edge *= std::exp(away / 2);
        if (std::abs(away) < bestAway) bestAway = std::abs(away), best = std::move(mesh);
    }
    return best;
}

glm::dvec3 sharesAt(glm::dvec2 point, const glm::uvec3& triangle, std::span<const glm::dvec2> vertices) {
    const glm::dvec2 a = vertices[triangle.x], b = vertices[triangle.y], c = vertices[triangle.z];
    const double all = cross(b - a, c - a), ofB = cross(point - a, c - a) / all, ofC = cross(b - a, point - a) / all;
    return {1 - ofB - ofC, ofB, ofC};
}

glm::dvec2 nearestOf(glm::dvec2 point, const glm::uvec3& triangle, std::span<const glm::dvec2> vertices) {
    const glm::dvec3 shares = sharesAt(point, triangle, vertices);
    if (std::min({shares.x, shares.y, shares.z}) >= 0) return point;
    glm::dvec2 nearest(0);
    double least = std::numeric_limits<double>::max();
    for (int corner = 0; corner < 3; ++corner) {
        const glm::dvec2 a = vertices[triangle[corner]], along = vertices[triangle[(corner + 1) % 3]] - a;
        const glm::dvec2 on = a + std::clamp(glm::dot(point - a, along) / glm::dot(along, along), 0.0, 1.0) * along;
        if (const double away = glm::distance(point, on); away < least) least = away, nearest = on;
    }
    return nearest;
}

}  // namespace

double doubleArea(const glm::uvec3& triangle, std::span<const glm::dvec2> vertices) {
    const glm::dvec2 a = vertices[triangle.x];
    return cross(vertices[triangle.y] - a, vertices[triangle.z] - a);
}

std::vector<std::size_t> foldedTriangles(const FlatMesh& rest, std::span<const glm::dvec2> vertices) {
    std::vector<std::size_t> folded;
    for (std::size_t i = 0; i < rest.triangles.size(); ++i)
        if (doubleArea(rest.triangles[i], vertices) <= 0) folded.push_back(i);
    return folded;
}

std::vector<std::size_t> islandsOf(const FlatMesh& mesh) {
    DisjointSets islands(mesh.vertices.size());
    for (const glm::uvec3 triangle : mesh.triangles) islands.join(triangle.x, triangle.y), islands.join(triangle.y, triangle.z);
    std::map<std::size_t, std::size_t> numbers;
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        found.push_back(numbers.try_emplace(islands.root(i), numbers.size()).first->second);
    return found;
}

Result<TriangulatedSilhouette> TriangulatedSilhouette::of(const GreyImage& picture, int vertices) {
    FANTASCOPE_CHECK(vertices >= kFewestVertices && vertices <= kMostVertices, "the number of vertices is in its range");
    TRY(PoseTarget::checkSize(picture.width(), picture.height()));
    Outline borders = tracedBorders(picture);
    TRY(checkBorders(borders, picture));
    // The blur is used only if it preserves all rings: a line one pixel wide would vanish.
    if (Outline smooth = smoothBordersOf(picture); smooth.rings.size() == borders.rings.size()) borders = std::move(smooth);
    TriangulatedSilhouette silhouette;
    silhouette.width = picture.width();
    silhouette.height = picture.height();
    silhouette.rest = TRY(meshOf(borders, vertices));
    // All points are kept: a straight side does not stay straight when the triangles along it
    // deform.
    for (const auto& ring : borders.rings) {
        auto& points = silhouette.outline.emplace_back();
        for (const glm::dvec2 point : ring) points.push_back(silhouette.carried(point));
    }
    return silhouette;
}

CarriedPoint TriangulatedSilhouette::carried(glm::dvec2 point) const {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < rest.triangles.size() && least > 0; ++i)
        if (const double away = glm::distance(point, nearestOf(point, rest.triangles[i], rest.vertices)); away < least)
            least = away, best = i;
    return {static_cast<std::uint32_t>(best), sharesAt(point, rest.triangles[best], rest.vertices)};
}

glm::dvec2 TriangulatedSilhouette::nearest(glm::dvec2 point) const {
    const CarriedPoint carrier = carried(point);
    return nearestOf(point, rest.triangles[carrier.triangle], rest.vertices);
}

glm::dvec2 TriangulatedSilhouette::placeOf(const CarriedPoint& point, std::span<const glm::dvec2> vertices) const {
    const glm::uvec3 triangle = rest.triangles[point.triangle];
    return point.shares.x * vertices[triangle.x] + point.shares.y * vertices[triangle.y] + point.shares.z * vertices[triangle.z];
}

Outline TriangulatedSilhouette::outlineAt(std::span<const glm::dvec2> vertices) const {
    Outline places;
    for (const auto& points : outline) {
        auto& ring = places.rings.emplace_back();
        for (const CarriedPoint& point : points) ring.push_back(placeOf(point, vertices));
    }
    return places;
}

}  // namespace fantascope::theatre
