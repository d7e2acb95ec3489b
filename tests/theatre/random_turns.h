#pragma once

#include "theatre/body/joint.h"

#include "core/random.h"

#include <glm/geometric.hpp>

#include <numbers>

namespace fantascope::theatre {

inline glm::dvec3 randomVector(Rng& rng, double size) {
    return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}
inline glm::dquat randomTurn(Rng& rng) {
    return glm::normalize(glm::dquat(rng.normal(), rng.normal(), rng.normal(), rng.normal()));
}
// The angle between two orientations; q and -q are one.
inline double angleBetween(const glm::dquat& a, const glm::dquat& b) { return glm::length(vectorOf(a * glm::conjugate(b))); }

}  // namespace fantascope::theatre
