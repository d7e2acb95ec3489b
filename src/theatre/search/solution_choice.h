#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace fantascope::theatre {

// Where a solution of a pose problem has its people: what makes it another one than the next.
struct PlacedActor {
    double stature = 0;
    std::vector<glm::dvec3> joints;  // metres, stage frame; of all actors as many
};

// How far two solutions are from each other, metres: the mean distance of the joints, with those of
// the other's actors assigned to each actor that make it least. People of one stature can play each
// other's parts; of each stature both have as many.
double difference(std::span<const PlacedActor> a, std::span<const PlacedActor> b);

// Which solutions to show of many, given the best first: the best, then again and again the one
// that is farthest from all chosen (of several the better). In the order of their choice, `count`
// of them or all.
std::vector<std::size_t> mostDifferent(std::span<const std::vector<PlacedActor>> solutions, std::size_t count);

}  // namespace fantascope::theatre
