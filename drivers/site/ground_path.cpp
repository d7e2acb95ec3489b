#include "drivers/site/ground_path.h"

#include "drivers/site/limits.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace fantascope::site {

Result<GroundPath> GroundPath::read(const ConfigNode& node) {
    GroundPath path;
    for (const ConfigNode& item : TRY(node.items(2))) {
        const glm::dvec2 point = TRY(item.vector2(-kMaxDistance, kMaxDistance, "m"));
        const double step = path.points_.empty() ? 0 : glm::distance(path.points_.back(), point);
        if (!path.points_.empty() && step < 1e-3) return item.error("two points of a path that follow each other must differ");
        path.distances_.push_back(path.points_.empty() ? 0 : path.distances_.back() + step);
        path.points_.push_back(point);
    }
    return path;
}

double GroundPath::length() const { return distances_.back(); }

GroundPath::Place GroundPath::at(double distance) const {
    const auto after = std::upper_bound(distances_.begin() + 1, distances_.end() - 1, distance);
    const auto next = static_cast<std::size_t>(after - distances_.begin());
    const glm::dvec2 from = points_[next - 1], to = points_[next], direction = glm::normalize(to - from);
    const glm::dvec2 here = from + direction * (distance - distances_[next - 1]);
    return {{here.x, 0, here.y}, {direction.x, 0, direction.y}};
}

}  // namespace fantascope::site
