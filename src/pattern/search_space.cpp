#include "pattern/search_space.h"

#include "pattern/coverage.h"
#include "pattern/streams.h"

#include <algorithm>
#include <cmath>

namespace fantascope::pattern {
namespace {

using Options = PatternSearch::Options;

// Without given sizes, the instances together are as large as `fill` times the guide's white, overlaps and gaps taking the difference,
// and vary around the middle size by the factor `spread`. The refined method grows what it may: a smaller spread keeps shapes many and
// alike. No middle is smaller (pixels) or larger (canvas heights) than a shape can be seen.
struct Sizes {
    double fill, spread;
};
constexpr Sizes sizesFor(PatternSearch::Method method) {
    return method == PatternSearch::Method::Paper ? Sizes{1.3, 2} : Sizes{1.2, 1.4};
}
constexpr double kSmallestMiddle = 2, kLargestMiddle = 0.25;

double typicalSide(const Silhouette& shape, const Options& options, Rng rng) {
    constexpr int kViews = 64, kPixels = 128;
    std::int64_t covered = 0;
    for (int i = 0; i < kViews; ++i) {
        Coverage view(kPixels, kPixels);
        const glm::dvec3 rotation(rng.uniform(-options.tilt, options.tilt), rng.uniform(-options.tilt, options.tilt),
                                  rng.uniform(-options.turn, options.turn));
        view.add(shape, {{0.5, 0.5}, 0.5, rotation});
        covered += view.count({{0, 0}, {kPixels, kPixels}});
    }
    constexpr double kPixelsOfUnit = kPixels * 0.5;  // the shape was drawn at size 0.5
    return std::sqrt(static_cast<double>(covered) / kViews) / kPixelsOfUnit;
}

double rounded(double value, double steps) { return std::round(value * steps) / steps; }
double roundedAngle(double angle) { return radians(rounded(angle * 180 / std::numbers::pi, 1e4)); }

}  // namespace

SearchSpace::SearchSpace(const GreyImage& guide, std::span<const ElementalShape> shapes, std::uint64_t seed,
                         const Options& options)
    : options_(options),
      seed_(seed),
      goal_(guide),
      pixels_(guide.width(), guide.height()),
      aspect_(double(pixels_.x) / pixels_.y) {
    for (const ElementalShape& shape : shapes) {
        silhouettes_.emplace_back(shape.mesh);
        sides_.push_back(typicalSide(silhouettes_.back(), options, Rng(streamSeed(seed, {Stream::TypicalViews, sides_.size()}))));
        meanSide_ += sides_.back() / static_cast<double>(shapes.size());
    }
    sizes_ = options.size ? *options.size : fittingSizes();
}

// Sizes with which the most instances light as much as the guide is white, and a little more.
glm::dvec2 SearchSpace::fittingSizes() const {
    const double light = goal_.mean() * aspect_;
    const auto [fill, spread] = sizesFor(options_.method);
    const double middle =
        std::clamp(std::sqrt(fill * light / options_.instances) / meanSide_, kSmallestMiddle / pixels_.y, kLargestMiddle);
    return {middle / spread, middle * spread};
}

ShapeInstance SearchSpace::randomInstance(const PixelRectangle& cell, Rng& rng) const {
    ShapeInstance instance;
    instance.shape = rng.below(static_cast<std::uint32_t>(silhouettes_.size()));
    instance.centre =
        glm::dvec2(rng.uniform(cell.begin.x, cell.end.x), rng.uniform(cell.begin.y, cell.end.y)) / double(pixels_.y);
    instance.size = sizes_.x * std::pow(sizes_.y / sizes_.x, rng.uniform());
    instance.rotation = {rng.uniform(-options_.tilt, options_.tilt), rng.uniform(-options_.tilt, options_.tilt),
                         rng.uniform(-options_.turn, options_.turn)};
    return allowed(instance);
}

ShapeInstance SearchSpace::allowed(ShapeInstance instance) const {
    const double right = std::floor(aspect_ * 1e6) / 1e6;
    instance.centre.x = std::clamp(rounded(instance.centre.x, 1e6), 0.0, right);
    instance.centre.y = std::clamp(rounded(instance.centre.y, 1e6), 0.0, 1.0);
    instance.size = rounded(std::clamp(instance.size, sizes_.x, sizes_.y), 1e6);
    const double turned = std::remainder(instance.rotation.z, 2 * std::numbers::pi);  // a free turn has no ends
    instance.rotation = {roundedAngle(std::clamp(instance.rotation.x, -options_.tilt, options_.tilt)),
                         roundedAngle(std::clamp(instance.rotation.y, -options_.tilt, options_.tilt)),
                         roundedAngle(std::clamp(turned, -options_.turn, options_.turn))};
    return instance;
}

}  // namespace fantascope::pattern
