#include "pattern/search/search_space.h"

#include "pattern/search/coverage.h"
#include "pattern/shape/streams.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fantascope::pattern {
namespace {

using Options = PatternSearch::Options;

// If no sizes are given, the maximum number of instances of the middle size are together `fill`
// times as large as the guide's white; overlaps and gaps account for the rest. Sizes range from
// middle / spread to middle * spread. The refined method enlarges shapes where it can, so a smaller
// spread keeps them many and alike.
struct Sizes {
    double fill, spread;
};
constexpr Sizes sizesFor(PatternSearch::Method method) {
    return method == PatternSearch::Method::Paper ? Sizes{1.3, 2} : Sizes{1.2, 1.4};
}
// Bounds of the middle size at which a shape can still be recognised: pixels; canvas heights.
constexpr double kSmallestMiddle = 2, kLargestMiddle = 0.25;

double typicalSide(const Silhouette& shape, glm::dvec2 tilt, glm::dvec2 turn, Rng rng) {
    constexpr int kViews = 64, kPixels = 128;
    std::int64_t covered = 0;
    for (int i = 0; i < kViews; ++i) {
        Coverage view(kPixels, kPixels);
        // The order of these draws is part of what a seed means.
        const double z = rng.uniform(turn.x, turn.y), y = rng.uniform(tilt.x, tilt.y), x = rng.uniform(tilt.x, tilt.y);
        view.add(shape, {{0.5, 0.5}, 0.5, {x, y, z}});
        covered += view.count({{0, 0}, {kPixels, kPixels}});
    }
    constexpr double kPixelsOfUnit = kPixels * 0.5;  // the shape was drawn at size 0.5
    return std::sqrt(static_cast<double>(covered) / kViews) / kPixelsOfUnit;
}

double rounded(double value, double steps) { return std::round(value * steps) / steps; }
double roundedAngle(double angle) { return radians(rounded(angle * 180 / std::numbers::pi, 1e4)); }

Goal goalOf(const GreyImage& guide, const GreyImage* surface) {
    if (surface == nullptr) return Goal(guide);
    const GreyImage inItsSize = resized(*surface, guide.width(), guide.height());
    return Goal(guide, &inItsSize);
}

}  // namespace

SearchSpace::SearchSpace(const GreyImage& guide, std::span<const ElementalShape> shapes, std::uint64_t seed,
                         const Options& options)
    : options_(options),
      seed_(seed),
      goal_(goalOf(guide, options.surface.get())),
      pixels_(guide.width(), guide.height()),
      aspect_(double(pixels_.x) / pixels_.y) {
    const auto own = [&](std::size_t index) { return index < options.shapes.size() ? options.shapes[index] : Options::Shape(); };
    double all = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        shares_.push_back(own(i).share);
        all += own(i).share;
        areAlike_ = areAlike_ && own(i).share == own(0).share;
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Options::Shape shape = own(i);
        limits_.push_back({shape.size.value_or(glm::dvec2(0.0)), shape.tilt.value_or(glm::dvec2(-options.tilt, options.tilt)),
                           shape.turn.value_or(glm::dvec2(-options.turn, options.turn))});
        silhouettes_.emplace_back(shapes[i].mesh);
        sides_.push_back(typicalSide(silhouettes_.back(), limits_.back().tilt, limits_.back().turn,
                                     Rng(streamSeed(seed, {Stream::TypicalViews, i}))));
        meanSide_ += sides_.back() / (all / shape.share);
        shares_[i] /= all;
    }
    setSizes();
}

void SearchSpace::setSizes() {
    const glm::dvec2 common = options_.size ? *options_.size : fittingSizes();
    bool areCommon = true;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
        if (limits_[i].sizes == glm::dvec2(0.0)) limits_[i].sizes = common;
        areCommon = areCommon && limits_[i].sizes == common;
        typicalSizes_ += shares_[i] * sides_[i] / meanSide_ * limits_[i].sizes;
    }
    if (areCommon) typicalSizes_ = common;  // exactly
}

// The sizes if none are given, see Sizes.
glm::dvec2 SearchSpace::fittingSizes() const {
    const double light = goal_.wantedCoverage() * aspect_;
    const auto [fill, spread] = sizesFor(options_.method);
    const double middle =
        std::clamp(std::sqrt(fill * light / options_.instances) / meanSide_, kSmallestMiddle / pixels_.y, kLargestMiddle);
    return {middle / spread, middle * spread};
}

std::uint32_t SearchSpace::randomShape(Rng& rng, std::span<const std::uint32_t> counts) const {
    if (areAlike_) return rng.below(static_cast<std::uint32_t>(shares_.size()));
    const double wanted = 1.0 + std::accumulate(counts.begin(), counts.end(), 0u);
    const auto weight = [&](std::size_t i) {
        return counts.empty() ? shares_[i] : std::max(0.0, shares_[i] * wanted - counts[i]);
    };
    double total = 0;
    for (std::size_t i = 0; i < shares_.size(); ++i) total += weight(i);
    double at = rng.uniform() * total;
    std::uint32_t shape = 0;
    while (shape + 1 < shares_.size() && (at -= weight(shape)) >= 0) ++shape;
    return shape;
}

ShapeInstance SearchSpace::randomInstance(const PixelRectangle& cell, Rng& rng, std::span<const std::uint32_t> counts) const {
    ShapeInstance instance;
    instance.shape = randomShape(rng, counts);
    instance.centre =
        glm::dvec2(rng.uniform(cell.begin.x, cell.end.x), rng.uniform(cell.begin.y, cell.end.y)) / double(pixels_.y);
    const auto& [sizes, tilt, turn] = limits_[instance.shape];
    instance.size = sizes.x * std::pow(sizes.y / sizes.x, rng.uniform());
    instance.rotation = {rng.uniform(tilt.x, tilt.y), rng.uniform(tilt.x, tilt.y), rng.uniform(turn.x, turn.y)};
    return allowed(instance);
}

ShapeInstance SearchSpace::allowed(ShapeInstance instance) const {
    const auto& [sizes, tilt, turn] = limits_[instance.shape];
    const double right = std::floor(aspect_ * 1e6) / 1e6;
    instance.centre.x = std::clamp(rounded(instance.centre.x, 1e6), 0.0, right);
    instance.centre.y = std::clamp(rounded(instance.centre.y, 1e6), 0.0, 1.0);
    instance.size = rounded(std::clamp(instance.size, sizes.x, sizes.y), 1e6);
    // Of all equivalent turns, the nearest to the middle of the range.
    const double middle = (turn.x + turn.y) / 2;
    const double turned = middle + std::remainder(instance.rotation.z - middle, 2 * std::numbers::pi);
    instance.rotation = {roundedAngle(std::clamp(instance.rotation.x, tilt.x, tilt.y)),
                         roundedAngle(std::clamp(instance.rotation.y, tilt.x, tilt.y)),
                         roundedAngle(std::clamp(turned, turn.x, turn.y))};
    return instance;
}

}  // namespace fantascope::pattern
