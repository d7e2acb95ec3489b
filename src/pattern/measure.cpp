#include "pattern/measure.h"

#include "pattern/coverage.h"
#include "pattern/goal.h"
#include "pattern/pattern_motion.h"

#include "core/check.h"
#include "core/parallel.h"

#include <cmath>
#include <numeric>
#include <vector>

namespace fantascope::pattern {
namespace {

std::vector<Silhouette> silhouettesOf(const ShapePattern& pattern) {
    std::vector<Silhouette> silhouettes;
    for (const ElementalShape& shape : pattern.shapes) silhouettes.emplace_back(shape.mesh);
    return silhouettes;
}

InstancePose restPose(const ShapeInstance& instance) { return {instance.centre, instance.size, instance.rotation}; }

double meanDifference(const GreyImage& a, const GreyImage& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels().size(); ++i) sum += std::abs(double(a.pixels()[i]) - b.pixels()[i]);
    return sum / static_cast<double>(a.pixels().size());
}

// The share of covered pixels that are covered by more than one instance; 0 where nothing is covered.
double overlapOf(const ShapePattern& pattern, const std::vector<Silhouette>& silhouettes) {
    Image<std::uint8_t> layers(pattern.width, pattern.height);  // 0, 1, or 2 for more
    Coverage alone(pattern.width, pattern.height);
    for (const ShapeInstance& instance : pattern.instances) {
        alone.clear();
        alone.add(silhouettes[instance.shape], restPose(instance));
        alone.forEachRun([&](int y, int begin, int end) {
            for (int x = begin; x < end; ++x)
                if (layers.at(x, y) < 2) ++layers.at(x, y);
        });
    }
    std::int64_t covered = 0, several = 0;
    for (const std::uint8_t count : layers.pixels()) {
        covered += count > 0 ? 1 : 0;
        several += count > 1 ? 1 : 0;
    }
    return covered == 0 ? 0 : static_cast<double>(several) / static_cast<double>(covered);
}

}  // namespace

PatternQuality measure(const ShapePattern& pattern, const GreyImage& guide) {
    const GreyImage compared = resized(guide, pattern.width, pattern.height);
    const std::vector<Silhouette> silhouettes = silhouettesOf(pattern);
    Coverage coverage(pattern.width, pattern.height);
    for (const ShapeInstance& instance : pattern.instances) coverage.add(silhouettes[instance.shape], restPose(instance));
    const Goal goal(compared);
    const double sigma = pattern.height / 36.0;
    return {.z = goal.z(coverage),
            .zBound = goal.bound(),
            .tone = meanDifference(blurred(compared, sigma), blurred(coverage.picture(), sigma)),
            .overlap = overlapOf(pattern, silhouettes)};
}

double loopZ(const ShapePattern& pattern, const GreyImage& guide, int moments, int threads) {
    FANTASCOPE_CHECK(moments > 0, "a mean has terms");
    const Goal goal(resized(guide, pattern.width, pattern.height));
    const std::vector<Silhouette> silhouettes = silhouettesOf(pattern);
    const PatternMotion motion(pattern, threads);
    std::vector<double> z(static_cast<std::size_t>(moments));
    parallelFor(moments, threads, [&](int moment) {
        std::vector<InstancePose> poses(pattern.instances.size());
        motion.posesAt(motion.period() * moment / moments, poses);
        Coverage coverage(pattern.width, pattern.height);
        for (std::size_t i = 0; i < poses.size(); ++i) coverage.add(silhouettes[pattern.instances[i].shape], poses[i]);
        z[static_cast<std::size_t>(moment)] = goal.z(coverage);
    });
    return std::accumulate(z.begin(), z.end(), 0.0) / moments;
}

GreyImage drawWhiteOnBlack(const ShapePattern& pattern, int width, int height) {
    const std::vector<Silhouette> silhouettes = silhouettesOf(pattern);
    Coverage coverage(width, height);
    for (const ShapeInstance& instance : pattern.instances) coverage.add(silhouettes[instance.shape], restPose(instance));
    return coverage.picture();
}

}  // namespace fantascope::pattern
