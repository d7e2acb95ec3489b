#include "theatre/convex_outline.h"

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

std::vector<dvec2> hullOf(std::vector<dvec2> points) {
    std::sort(points.begin(), points.end(),
              [](const dvec2& a, const dvec2& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    std::vector<dvec2> hull;
    const auto add = [&](const dvec2& p, std::size_t keep) {
        while (hull.size() >= keep + 2) {
            const dvec2 a = hull[hull.size() - 2], b = hull.back();
            if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0) break;
            hull.pop_back();
        }
        hull.push_back(p);
    };
    for (const dvec2& p : points) add(p, 0);
    const std::size_t lower = hull.size() - 1;
    for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
    hull.pop_back();
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
