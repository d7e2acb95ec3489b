#include "theatre/body/triangle.h"

#include <glm/geometric.hpp>

namespace fantascope::theatre {

using glm::dvec3;

dvec3 nearestOf(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const dvec3 bp = p - b;
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const dvec3 cp = p - c;
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
    const double all = va + vb + vc;
    return all > 0 ? a + vb / all * ab + vc / all * ac : a;
}

int sideOf(glm::dvec2 a, glm::dvec2 b) {
    const double twice = a.y * b.x - a.x * b.y;
    if (twice != 0) return twice > 0 ? 1 : -1;
    if (b.y != a.y) return b.y > a.y ? 1 : -1;
    return b.x > a.x ? 1 : b.x < a.x ? -1 : 0;
}

}  // namespace fantascope::theatre
