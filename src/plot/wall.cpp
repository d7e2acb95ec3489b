#include "plot/wall.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <limits>

namespace fantascope::plot {

Wall::Wall(const Projection& projection) : projector_(projection.size) {
    // The picture itself decides and not the warp's settings, since crossed corners mirror and
    // rotate it too.
    const CanvasPart& part = projection.warp.shape().part;
    const glm::dvec2 middle = (part.low + part.high) / 2.0, reach = (part.high - part.low) / 4.0;
    const auto moved = [&](glm::dvec2 by) {
        return projection.warp.keystone()(middle + by) - projection.warp.keystone()(middle - by);
    };
    const glm::dvec2 right = glm::normalize(moved({reach.x, 0})), down = glm::normalize(moved({0, reach.y}));
    double best = -std::numeric_limits<double>::infinity();
    for (const glm::dvec2 x : {glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(-1, 0), glm::dvec2(0, -1)})
        for (const glm::dvec2 y : {glm::dvec2(-x.y, x.x), glm::dvec2(x.y, -x.x)})
            if (const double fit = glm::dot(x, right) + glm::dot(y, down); fit > best + 1e-9) {
                best = fit;
                projectorFromWall_ = glm::dmat2(x, y);
            }
}

glm::ivec2 Wall::size() const { return projectorFromWall_[0].x != 0 ? projector_ : glm::ivec2(projector_.y, projector_.x); }

glm::dvec2 Wall::fromProjector(glm::dvec2 pixel) const {
    return glm::transpose(projectorFromWall_) * (pixel - glm::dvec2(projector_) / 2.0) + glm::dvec2(size()) / 2.0;
}

RgbaImage Wall::toProjector(Sheet& sheet) const {
    const auto pixel = [&](glm::dvec2 at) { return glm::ivec2(glm::floor(fromProjector(at + 0.5))); };
    const glm::ivec2 origin = pixel({0, 0});
    return sheet.image(projector_, origin, pixel({1, 0}) - origin, pixel({0, 1}) - origin);
}

}  // namespace fantascope::plot
