#include "vision/map_check.h"

#include "core/check.h"
#include "core/median.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace fantascope::vision {
namespace {

constexpr int kBlock = 24;       // side of a block, camera pixels
constexpr double kFewest = 100;  // known pixels of a block that counts
constexpr std::size_t kFewestBlocks = 4;
constexpr double kWeak = 0.3;  // a sinusoid this much weaker than full light is not the one of the map
constexpr double kTurn = 2 * std::numbers::pi;

// Sums for the sinusoid that fits a block's pixels best: a cos(phase) + b sin(phase).
struct Sums {
    double count = 0, cc = 0, cs = 0, ss = 0, vc = 0, vs = 0;

    void add(double phase, double value) {
        const double c = std::cos(phase), s = std::sin(phase);
        ++count;
        cc += c * c, cs += c * s, ss += s * s;
        vc += value * c, vs += value * s;
    }
    // By how many turns the sinusoid has moved; half a turn: it is not there, or nobody can tell.
    double turns() const {
        const double determinant = cc * ss - cs * cs;
        if (determinant < 1e-3 * count * count) return 0.5;
        const double a = (vc * ss - vs * cs) / determinant, b = (vs * cc - vc * cs) / determinant;
        return std::hypot(a, b) < kWeak ? 0.5 : std::abs(std::atan2(b, a)) / kTurn;
    }
};

}  // namespace

std::optional<double> movedSince(const ProjectorMap& map, const StructuredLight& light, StructuredLight::Axis axis,
                                 const GreyImage& difference) {
    const int width = map.at.width(), height = map.at.height();
    FANTASCOPE_CHECK(difference.width() == width && difference.height() == height, "pictures of the camera's size");
    std::vector<double> moved;
    for (int top = 0; top < height; top += kBlock)
        for (int left = 0; left < width; left += kBlock) {
            Sums sums;
            for (int y = top; y < std::min(height, top + kBlock); ++y)
                for (int x = left; x < std::min(width, left + kBlock); ++x) {
                    if (!map.isKnown(x, y)) continue;
                    const glm::vec2 at = map.at.at(x, y);
                    const double along = axis == StructuredLight::Axis::Across ? at.x : at.y;
                    sums.add(kTurn * along / light.period(), difference.at(x, y) / map.light.at(x, y));
                }
            if (sums.count >= kFewest) moved.push_back(light.period() * sums.turns());
        }
    if (moved.size() < kFewestBlocks) return std::nullopt;
    return medianOf(moved);
}

}  // namespace fantascope::vision
