#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/random.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::pattern {

// Points of the plane in overlapping clusters.
struct FuzzyClusters {
    struct Options {
        std::uint32_t clusters = 1;  // >= 1; may exceed the number of points
        double fuzziness = 2;        // m > 1; near 1 every point belongs to its nearest cluster alone
        double tolerance =
            1e-3;  // converged once no membership changes by more in an iteration; fewer changes hardly affect a draw
        int maxIterations = 500;
    };
    enum class StopReason { Converged, IterationLimit };
    struct Summary {
        StopReason reason = StopReason::IterationLimit;
        std::vector<double> objective;  // after each iteration: sum of membership^m * distance^2; never rises
    };

    std::vector<glm::dvec2> centres;
    std::vector<double> memberships;  // a row of centres.size() numbers per point; each row sums to 1
    Summary summary;

    std::span<const double> membershipsOf(std::size_t point) const {
        return std::span(memberships).subspan(point * centres.size(), centres.size());
    }
};

// Fuzzy c-means (Bezdek 1981). `rng` chooses the first centres. Thread: reentrant.
FuzzyClusters fuzzyCMeans(std::span<const glm::dvec2> points, const FuzzyClusters::Options& options, Rng& rng);

// How many movement groups a pattern of so many instances has: instances / instancesPerGroup,
// rounded, at least 1.
std::uint32_t groupCount(std::size_t instances, double instancesPerGroup);

// The first group whose cumulative membership exceeds a uniform random number from the stream
// (seed, id).
std::uint32_t drawGroup(std::span<const double> memberships, std::uint64_t seed, std::uint32_t id);

// Assigns instances to groups: fuzzy c-means over their centres, then one draw per instance from
// its row of the membership matrix (Ji et al. 2015, section 4.2, stage 2, step 1). The draw of an
// instance comes from the stream (seed, id). Sets pattern.groups and every instance's group.
FuzzyClusters::Summary assignGroups(ShapePattern& pattern);

}  // namespace fantascope::pattern
