#include "theatre/mask/convex_outline.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace fantascope::theatre {

using glm::dvec2;

double distanceTo(const dvec2& a, const dvec2& b, const dvec2& p) {
    const dvec2 along = b - a;
    const double length2 = glm::dot(along, along);
    return glm::distance(p, a + (length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0) * along);
}

void findHull(std::span<const dvec2> points, std::vector<std::uint32_t>& corners) {
    // The points sorted from left to right come first; the hull is built behind them.
    corners.resize(points.size());
    std::iota(corners.begin(), corners.end(), 0u);
    std::sort(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tie(points[a].x, points[a].y, a) < std::tie(points[b].x, points[b].y, b);
    });
    corners.erase(
        std::unique(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) { return points[a] == points[b]; }),
        corners.end());
    const std::size_t count = corners.size();
    if (count < 3) return;
    const auto add = [&](std::uint32_t next, std::size_t keep) {
        while (corners.size() >= keep + 2) {
            const dvec2 a = points[corners[corners.size() - 2]], b = points[corners.back()], p = points[next];
            if ((b.x - a.x) * (p.y - b.y) - (b.y - a.y) * (p.x - b.x) > 0) break;
            corners.pop_back();
        }
        corners.push_back(next);
    };
    for (std::size_t i = 0; i < count; ++i) add(corners[i], count);
    const std::size_t lower = corners.size() - 1;
    for (std::size_t i = count - 1; i-- > 0;) add(corners[i], lower);
    corners.pop_back();
    corners.erase(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(count));
}

std::vector<dvec2> hullOf(std::span<const dvec2> points) {
    std::vector<std::uint32_t> corners;
    findHull(points, corners);
    std::vector<dvec2> hull;
    for (const std::uint32_t corner : corners) hull.push_back(points[corner]);
    return hull;
}

double areaOf(const std::vector<dvec2>& hull) {
    double twice = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const dvec2 a = hull[i], b = hull[(i + 1) % hull.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * std::abs(twice);
}

double perimeterOf(const std::vector<dvec2>& hull) {
    double length = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) length += glm::distance(hull[i], hull[(i + 1) % hull.size()]);
    return length;
}

double distanceTo(const std::vector<dvec2>& hull, const dvec2& p) {
    double least = std::numeric_limits<double>::infinity();
    bool isInside = hull.size() > 2;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const dvec2 a = hull[i], b = hull[(i + 1) % hull.size()];
        least = std::min(least, distanceTo(a, b, p));
        if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) < 0) isInside = false;
    }
    return isInside ? -least : least;
}

dvec2 middleOf(const std::vector<dvec2>& points) {
    return std::accumulate(points.begin(), points.end(), dvec2(0)) / static_cast<double>(points.size());
}

std::vector<dvec2> partWithin(const std::vector<dvec2>& hull, double grown, const dvec2& middle, const dvec2& along,
                              double reach) {
    if (distanceTo(hull, middle) > grown) return {};
    std::vector<dvec2> ends;
    for (const double side : {-1.0, 1.0}) {
        double in = 0, out = reach;
        for (int i = 0; i < 50; ++i) {
            const double half = 0.5 * (in + out);
            (distanceTo(hull, middle + side * half * along) <= grown ? in : out) = half;
        }
        ends.push_back(middle + side * in * along);
    }
    return ends;
}

}  // namespace fantascope::theatre
