#include "pattern/search/refit.h"

#include "pattern/search/measure.h"

#include "core/check.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

namespace fantascope::pattern {
namespace {

// What a change must win, as a share of an instance's pixels. Below it, a pattern that reads as its
// guide would be stirred by what the search had left undone; far above it, stains stay.
constexpr double kChangeCost = 0.25;
// Instances may become larger and smaller than those that there are, by this factor.
constexpr double kGrowth = 1.2;
// Of the guide's light, so much may be missing.
constexpr double kMissing = 0.01;

double sumOf(const GreyImage& image) { return std::accumulate(image.pixels().begin(), image.pixels().end(), 0.0); }

GreyImage scaled(GreyImage light, double factor) {
    for (float& value : light.pixels()) value = static_cast<float>(value * factor);
    return light;
}

// The light at which the pattern on the surface has the guide's mean light, if that is its white.
double exposureOf(const ShapePattern& pattern, const GreyImage& guide, const GreyImage& light) {
    GreyImage seen = drawWhiteOnBlack(pattern, light.width(), light.height());
    for (std::size_t i = 0; i < seen.pixels().size(); ++i) seen.pixels()[i] *= light.pixels()[i];
    const double wanted = sumOf(guide);
    return wanted > 0 ? sumOf(seen) / wanted : 0;
}

// The guide without what cannot be seen, beyond the edges of what is lit.
GreyImage inSight(GreyImage guide, const GreyImage& light) {
    for (int y = 0; y < guide.height(); ++y)
        for (int x = 0; x < guide.width(); ++x)
            if (light.at(x * light.width() / guide.width(), y * light.height() / guide.height()) <= 0) guide.at(x, y) = 0;
    return guide;
}

// The range of some values, and a range of angles at most a whole turn wide.
struct Range {
    glm::dvec2 range{1e9, -1e9};
    void add(double value) { range = {std::min(range.x, value), std::max(range.y, value)}; }
    glm::dvec2 turn() const {
        const double middle = (range.x + range.y) / 2, reach = std::min(std::numbers::pi, (range.y - range.x) / 2);
        return {middle - reach, middle + reach};
    }
};

// The settings with which the pattern was found are not known, but what it has of each shape is.
PatternSearch::Options optionsOf(const ShapePattern& pattern, const PatternRefit::Options& wanted) {
    constexpr double kLargest = 2, kLeastShare = 0.001;
    PatternSearch::Options options;
    const auto count = static_cast<double>(pattern.instances.size());
    options.instances = static_cast<std::uint32_t>(std::ceil(count * (1 + wanted.more)));
    options.rows = std::clamp(pattern.height, 16, 4096);
    options.iterations = wanted.iterations;
    options.changeCost = kChangeCost;
    options.refined.temperature = 0;
    Range all;
    for (std::size_t shape = 0; shape < pattern.shapes.size(); ++shape) {
        Range size, tilt, turn;
        std::size_t there = 0;
        for (const ShapeInstance& instance : pattern.instances) {
            if (instance.shape != shape) continue;
            ++there;
            size.add(instance.size), all.add(instance.size);
            tilt.add(instance.rotation.x), tilt.add(instance.rotation.y);
            turn.add(instance.rotation.z);
        }
        PatternSearch::Options::Shape& own = options.shapes.emplace_back();
        own.share = std::max(kLeastShare, static_cast<double>(there) / count);
        if (there == 0) continue;
        own.size = glm::dvec2(size.range.x / kGrowth, std::min(kLargest, size.range.y * kGrowth));
        own.tilt = tilt.turn();
        own.turn = turn.turn();
    }
    options.size = glm::dvec2(all.range.x / kGrowth, std::min(kLargest, all.range.y * kGrowth));
    return options;
}

const ShapeInstance& nearestTo(glm::dvec2 place, const std::vector<ShapeInstance>& instances) {
    return *std::ranges::min_element(instances, {},
                                     [&](const ShapeInstance& instance) { return glm::distance(instance.centre, place); });
}

bool isSame(const ShapeInstance& a, const ShapeInstance& b) {
    return a.centre == b.centre && a.size == b.size && a.rotation == b.rotation;
}

void count(PatternRefit& refit, const std::vector<ShapeInstance>& given) {
    std::map<std::uint32_t, const ShapeInstance*> before;
    for (const ShapeInstance& instance : given) before[instance.id] = &instance;
    for (const ShapeInstance& instance : refit.pattern.instances) {
        const auto found = before.find(instance.id);
        if (found == before.end()) {
            ++refit.made;
            continue;
        }
        refit.changed += isSame(*found->second, instance) ? 0 : 1;
        before.erase(found);
    }
    refit.removed = before.size();
}

}  // namespace

double reachableWhite(const GreyImage& light, const GreyImage& guide, double missing) {
    const double wanted = sumOf(guide);
    if (wanted <= 0) return 0;
    const auto missed = [&](double white) {
        double sum = 0;
        for (std::size_t i = 0; i < guide.pixels().size(); ++i)
            sum += std::max(0.0, guide.pixels()[i] - light.pixels()[i] / white);
        return sum;
    };
    double low = 0, high = *std::ranges::max_element(light.pixels());
    constexpr int kHalvings = 24;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = (low + high) / 2;
        (missed(middle) <= missing * wanted ? low : high) = middle;
    }
    return low;
}

double toneOnSurface(const ShapePattern& pattern, const GreyImage& whole, const GreyImage& light) {
    const GreyImage guide = inSight(whole, light), drawing = resized(guide, light.width(), light.height());
    const double exposure = exposureOf(pattern, drawing, light);
    if (exposure <= 0) return 1;
    const GreyImage surface = scaled(light, 1 / exposure);
    return measure(pattern, guide, &surface).tone;
}

PatternRefit PatternRefit::of(const ShapePattern& pattern, const GreyImage& whole, const GreyImage& light, const Options& options,
                              const PatternSearch::AskStop& askStop) {
    FANTASCOPE_CHECK(!pattern.instances.empty() && !whole.empty() && !light.empty(), "there is a pattern, a guide and a surface");
    const GreyImage guide = inSight(whole, light);
    PatternRefit refit;
    refit.pattern = pattern;
    refit.toneBefore = refit.toneAfter = toneOnSurface(pattern, guide, light);
    const GreyImage drawing = resized(guide, light.width(), light.height());
    const double exposure = exposureOf(pattern, drawing, light);
    if (exposure <= 0) return refit;
    const double white = std::clamp(reachableWhite(light, drawing, kMissing), options.least * exposure, exposure);
    PatternSearch::Options search = optionsOf(pattern, options);
    search.surface = std::make_shared<const GreyImage>(scaled(light, 1 / white));
    refit.pattern = PatternSearch::run(guide, pattern, search, 1, askStop).pattern;
    refit.pattern.width = pattern.width;  // the guide may have another size than it had
    refit.pattern.height = pattern.height;
    const std::uint32_t last = std::ranges::max_element(pattern.instances, {}, &ShapeInstance::id)->id;
    for (ShapeInstance& instance : refit.pattern.instances)
        if (instance.id > last) instance.colour = nearestTo(instance.centre, pattern.instances).colour;
    refit.toneAfter = toneOnSurface(refit.pattern, guide, light);
    refit.kept = exposureOf(refit.pattern, drawing, light) / exposure;
    count(refit, pattern.instances);
    return refit;
}

}  // namespace fantascope::pattern
