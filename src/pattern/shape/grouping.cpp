#include "pattern/shape/grouping.h"

#include "pattern/shape/streams.h"

#include "core/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace fantascope::pattern {
namespace {

double squaredDistance(glm::dvec2 a, glm::dvec2 b) { return glm::dot(a - b, a - b); }

// The first index whose cumulative weight exceeds a uniform random share of the total.
std::size_t drawIndex(std::span<const double> weights, Rng& rng) {
    const double draw = rng.uniform() * std::accumulate(weights.begin(), weights.end(), 0.0);
    double accumulated = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        accumulated += weights[i];
        if (accumulated > draw) return i;
    }
    return weights.size() - 1;  // all weights are zero, or the cumulative sum was rounded down
}

// Chooses points as first centres. Each further point is drawn with a probability proportional to
// its squared distance from the nearest one before (k-means++, Arthur & Vassilvitskii 2007), so
// that hardly a cluster of points starts without a centre.
std::vector<glm::dvec2> firstCentres(std::span<const glm::dvec2> points, std::uint32_t clusters, Rng& rng) {
    std::vector<glm::dvec2> centres;
    std::vector<double> nearest(points.size(), std::numeric_limits<double>::max());
    std::size_t chosen = rng.below(static_cast<std::uint32_t>(points.size()));
    while (true) {
        centres.push_back(points[chosen]);
        if (centres.size() == clusters) return centres;
        for (std::size_t i = 0; i < points.size(); ++i)
            nearest[i] = std::min(nearest[i], squaredDistance(points[i], centres.back()));
        chosen = drawIndex(nearest, rng);
    }
}

// How much a point belongs to each centre: (1 / distance^2)^(1 / (m - 1)). It is computed relative
// to the nearest centre, so that no power overflows and a point on a centre belongs to it alone (or
// to all centres that coincide there).
struct Belonging {
    std::vector<double> ratio;  // squared distance of the nearest centre / that of this centre; 0..1
    std::vector<double> share;  // ratio^(1 / (m - 1))
    double nearest = 0;         // squared distance
    double sum = 0;             // of all shares

    explicit Belonging(std::size_t centres) : ratio(centres), share(centres) {}

    void measure(glm::dvec2 point, std::span<const glm::dvec2> centres, double m) {
        const double exponent = 1 / (m - 1);
        nearest = std::numeric_limits<double>::max();
        for (std::size_t k = 0; k < centres.size(); ++k)
            nearest = std::min(nearest, ratio[k] = squaredDistance(point, centres[k]));
        sum = 0;
        for (std::size_t k = 0; k < centres.size(); ++k) {
            ratio[k] = ratio[k] > nearest ? nearest / ratio[k] : 1.0;
            // std::pow would take most of the time for the default, whose exponent is 2.
            sum += share[k] = exponent == 2 ? ratio[k] * ratio[k] : std::pow(ratio[k], exponent);
        }
    }
};

}  // namespace

FuzzyClusters fuzzyCMeans(std::span<const glm::dvec2> points, const FuzzyClusters::Options& options, Rng& rng) {
    FANTASCOPE_CHECK(!points.empty() && options.clusters >= 1, "clustering needs a point and a cluster");
    FANTASCOPE_CHECK(options.fuzziness > 1, "fuzzy c-means needs a fuzziness > 1");
    const double m = options.fuzziness;
    const std::size_t clusters = options.clusters;
    FuzzyClusters result;
    result.centres = firstCentres(points, options.clusters, rng);
    result.memberships.assign(points.size() * clusters, 0.0);

    Belonging belonging(clusters);
    std::vector<double> weightSum(clusters);
    std::vector<glm::dvec2> weightedSum(clusters);
    for (int iteration = 0; iteration < options.maxIterations; ++iteration) {
        std::fill(weightSum.begin(), weightSum.end(), 0.0);
        std::fill(weightedSum.begin(), weightedSum.end(), glm::dvec2(0));
        double objective = 0, change = 0;
        // The best memberships for these centres. A point's weight for a centre is membership^m =
        // (share / sum)^m. It needs no further power, since share^m = share * ratio, and so weight
        // * distance^2 = nearest * share / sum^m.
        for (std::size_t i = 0; i < points.size(); ++i) {
            belonging.measure(points[i], result.centres, m);
            const double sumToM = std::pow(belonging.sum, m);
            objective += belonging.nearest * belonging.sum / sumToM;
            for (std::size_t k = 0; k < clusters; ++k) {
                double& membership = result.memberships[i * clusters + k];
                const double before = std::exchange(membership, belonging.share[k] / belonging.sum);
                change = std::max(change, std::abs(membership - before));
                const double weight = belonging.share[k] * belonging.ratio[k] / sumToM;
                weightSum[k] += weight;
                weightedSum[k] += weight * points[i];
            }
        }
        result.summary.objective.push_back(objective);
        if (change <= options.tolerance) {
            result.summary.reason = FuzzyClusters::StopReason::Converged;
            break;
        }
        // The best centres for these memberships. A centre without members stays.
        for (std::size_t k = 0; k < clusters; ++k)
            if (weightSum[k] > 0) result.centres[k] = weightedSum[k] / weightSum[k];
    }
    return result;
}

std::uint32_t groupCount(std::size_t instances, double instancesPerGroup) {
    FANTASCOPE_CHECK(instancesPerGroup > 0, "instances per group must be > 0");
    return static_cast<std::uint32_t>(std::max(1.0, std::round(static_cast<double>(instances) / instancesPerGroup)));
}

std::uint32_t drawGroup(std::span<const double> memberships, std::uint64_t seed, std::uint32_t id) {
    Rng rng(streamSeed(seed, {Stream::GroupMembership, id}));
    return static_cast<std::uint32_t>(drawIndex(memberships, rng));
}

FuzzyClusters::Summary assignGroups(ShapePattern& pattern) {
    pattern.groups = groupCount(pattern.instances.size(), pattern.motion.instancesPerGroup);
    if (pattern.instances.empty()) return {FuzzyClusters::StopReason::Converged, {}};
    std::vector<glm::dvec2> centres;
    for (const ShapeInstance& instance : pattern.instances) centres.push_back(instance.centre);

    Rng rng(streamSeed(pattern.seed, {Stream::GroupCentres}));
    const FuzzyClusters clusters = fuzzyCMeans(centres, {.clusters = pattern.groups, .fuzziness = pattern.motion.fuzziness}, rng);
    for (std::size_t i = 0; i < pattern.instances.size(); ++i) {
        ShapeInstance& instance = pattern.instances[i];
        instance.group = drawGroup(clusters.membershipsOf(i), pattern.seed, instance.id);
    }
    return clusters.summary;
}

}  // namespace fantascope::pattern
