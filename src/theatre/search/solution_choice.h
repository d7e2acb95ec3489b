#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The joint positions of an actor in a solution, by which solutions are compared.
struct PlacedActor {
    double stature = 0;
    std::vector<glm::dvec3> joints;  // metres, stage frame; every actor has as many
};

// The distance of two solutions, metres: the mean distance of corresponding joints, under the
// assignment of `b`'s actors to `a`'s that makes it smallest. Only actors of equal stature are
// assigned to each other. Both solutions must have equally many of each stature.
double difference(std::span<const PlacedActor> a, std::span<const PlacedActor> b);

// Chooses which of many solutions, given best first, to show: the best, and then repeatedly the one
// that is farthest from all chosen (ties go to the better). Gives `count` indices, or all, in the
// order of choice.
std::vector<std::size_t> mostDifferent(std::span<const std::vector<PlacedActor>> solutions, std::size_t count);

}  // namespace fantascope::theatre
