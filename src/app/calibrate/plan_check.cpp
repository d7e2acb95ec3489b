#include "app/calibrate/plan_check.h"

#include "app/site/site_models.h"

#include "vision/watch/output_view.h"

#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <optional>

namespace fantascope::app {
namespace {

// How a map's projector pixels change from one camera pixel to the next, to the right and down:
// the least-squares fit over all that are known. Nothing: too few are, or they lie on a line.
std::optional<glm::dmat2> slopeOf(const vision::ProjectorMap& map) {
    glm::dvec2 cameraSum(0), projectorSum(0);
    glm::dmat2 cameras(0), both(0);
    double count = 0;
    for (int y = 0; y < map.at.height(); ++y)
        for (int x = 0; x < map.at.width(); ++x) {
            if (!map.isKnown(x, y)) continue;
            const glm::dvec2 camera(x, y), projector(map.at.at(x, y));
            cameraSum += camera;
            projectorSum += projector;
            cameras += glm::outerProduct(camera, camera);
            both += glm::outerProduct(projector, camera);
            ++count;
        }
    if (count == 0) return std::nullopt;
    cameras -= glm::outerProduct(cameraSum, cameraSum) / count;
    both -= glm::outerProduct(projectorSum, cameraSum) / count;
    if (glm::determinant(cameras) <= 0) return std::nullopt;
    return both * glm::inverse(cameras);
}

}  // namespace

Result<std::optional<bool>> isUpsideDown(const show::Site& site, std::size_t output, const vision::ProjectorMap& seen) {
    if (site.outputs[output].projection.warp.shape().orientation != Orientation()) return std::optional<bool>();
    const auto view = TRY(nominalViewOf(site, output, 1, Fit::Stretch));
    if (!view) return std::optional<bool>();
    const auto is = slopeOf(seen), planned = slopeOf(vision::nominalMap(*view));
    if (!is || !planned || glm::determinant(*planned) == 0) return std::optional<bool>();
    // The identity, if all stands as planned.
    const glm::dmat2 turn = *is * glm::inverse(*planned);
    // By more than 135 degrees, and not mirrored.
    const double along = turn[0][0] + turn[1][1], across = turn[0][1] - turn[1][0];
    return std::optional(glm::determinant(turn) > 0 && along < 0 && -along > std::abs(across));
}

bool isHalfTurned(const WarpShape& warp, const WarpShape& other) {
    const auto& is = warp.corners;
    const auto& was = other.corners;
    return glm::dot(is[1] - is[0], was[1] - was[0]) < 0 && glm::dot(is[3] - is[0], was[3] - was[0]) < 0;
}

}  // namespace fantascope::app
