#include "plot/contact_shade.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fantascope::plot {
namespace {

constexpr float kCell = 0.05f, kReach = 0.6f;  // metres

template <class Visit>
void forEachMesh(const StageView& view, Visit visit) {
    for (const StageView::Actor& actor : view.actors) visit(actor.mesh);
    for (const StageView::Actor& prop : view.props) visit(prop.mesh);
}

}  // namespace

ContactShade::ContactShade(const StageView& view) {
    glm::vec2 low(std::numeric_limits<float>::max()), high(-low);
    forEachMesh(view, [&](const TriangleMesh& mesh) {
        for (const glm::vec3& v : mesh.vertices) {
            low = glm::min(low, glm::vec2(v.x, v.z));
            high = glm::max(high, glm::vec2(v.x, v.z));
        }
    });
    if (low.x > high.x) return;
    origin_ = low - kReach;
    const glm::vec2 cells = glm::ceil((high - low + 2 * kReach) / kCell);
    shade_ = GreyImage(static_cast<int>(cells.x), static_cast<int>(cells.y));
    forEachMesh(view, [&](const TriangleMesh& mesh) {
        for (const glm::uvec3 t : mesh.triangles) add(mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]);
    });
}

float ContactShade::at(const glm::vec3& place) const {
    const glm::vec2 p = (glm::vec2(place.x, place.z) - origin_) / kCell - 0.5f;
    const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
    if (x < 0 || y < 0 || x + 1 >= shade_.width() || y + 1 >= shade_.height()) return 0;
    const glm::vec2 f = p - glm::vec2(x, y);
    return glm::mix(glm::mix(shade_.at(x, y), shade_.at(x + 1, y), f.x),
                    glm::mix(shade_.at(x, y + 1), shade_.at(x + 1, y + 1), f.x), f.y);
}

// Adds a triangle, divided into pieces no larger than a cell.
void ContactShade::add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const float longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    const int steps = 1 + static_cast<int>(longest / kCell);
    const glm::vec3 u = (b - a) / float(steps), v = (c - a) / float(steps), area = 0.5f * glm::cross(u, v);
    for (int i = 0; i < steps; ++i)
        for (int j = 0; i + j < steps; ++j) {
            const glm::vec3 corner = a + float(i) * u + float(j) * v;
            spread(corner + (u + v) / 3.0f, area);
            if (i + j + 1 < steps) spread(corner + (u + v) * (2 / 3.0f), area);
        }
}

// Adds the form factor cos cos' dA / (pi r^2), fading out at kReach, of one surface piece. `area`:
// a vector along its normal.
void ContactShade::spread(const glm::vec3& place, const glm::vec3& area) {
    const float height = std::max(place.y, 0.0f);
    if (height >= kReach) return;
    const glm::vec2 at = (glm::vec2(place.x, place.z) - origin_) / kCell - 0.5f;
    const glm::ivec2 low = glm::max(glm::ivec2(at - kReach / kCell), glm::ivec2(0)),
                     high = glm::min(glm::ivec2(at + kReach / kCell), glm::ivec2(shade_.width(), shade_.height()) - 1);
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            const glm::vec3 d(kCell * (at.x - float(x)), height, kCell * (at.y - float(y)));
            const float r2 = std::max(glm::dot(d, d), 0.25f * kCell * kCell), fading = 1 - r2 / (kReach * kReach);
            const float facing = -glm::dot(d, area);
            if (facing <= 0 || fading <= 0) continue;
            shade_.at(x, y) += height * facing / (glm::pi<float>() * r2 * r2) * fading;
        }
}

}  // namespace fantascope::plot
