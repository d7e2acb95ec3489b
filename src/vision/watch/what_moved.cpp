#include "vision/watch/what_moved.h"

#include <algorithm>

namespace fantascope::vision {
namespace {

constexpr double kSureOfSurface = 3;  // standard deviations
constexpr double kStill = 0.3;        // of the largest drift: an output that moved so little did not move with the others
constexpr double kAtMost = 0.65;      // of the largest drift: its own and two standard deviations are less
constexpr double kExplained = 0.15;   // of the camera's movement, besides:
constexpr double kMeasured = 0.2;     // camera pixels: what a movement of the camera may leave unexplained

}  // namespace

Moved whatMoved(const WallWatch& wall, const std::vector<std::optional<Drift>>& drifts) {
    double largest = 0, surface = 0;
    bool anySure = false;
    for (const std::optional<Drift>& drift : drifts) {
        if (!drift || !drift->isSure()) continue;
        anySure = true;
        largest = std::max(largest, drift->px);
        surface += drift->surfaceStayed;
    }
    if (!anySure) return Moved::Nothing;
    std::vector<const Homography*> movements;
    std::size_t watched = 0;
    bool anyStill = false, allMoved = true;
    for (const std::optional<Drift>& drift : drifts) {
        movements.push_back(drift ? &drift->moved : nullptr);
        if (!drift) continue;
        ++watched;
        anyStill = anyStill || (drift->px < kStill * largest && drift->px + 2 * drift->sigma < kAtMost * largest);
        allMoved = allMoved && drift->isSure();
    }
    if (anyStill) return Moved::Projectors;
    if (!allMoved) return Moved::Unclear;
    if (watched > 1) {
        const auto camera = wall.cameraMovement(movements);
        if (!camera || camera->missed > kExplained * camera->px + kMeasured) return Moved::Projectors;
        return surface > 2 * kSureOfSurface ? Moved::Projectors : Moved::Camera;
    }
    if (surface > kSureOfSurface) return Moved::Projectors;
    return surface < -kSureOfSurface ? Moved::Camera : Moved::Unclear;
}

}  // namespace fantascope::vision
