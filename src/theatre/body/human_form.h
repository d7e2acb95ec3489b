#pragma once

#include "theatre/body/posed_body.h"

#include <array>
#include <vector>

namespace fantascope::theatre {

// The form of a grown person in the rest pose of humanBody(), neither female nor male, as an
// implicit field. The field is negative inside; near the surface its magnitude is the distance from
// the surface. Lengths are in shares of the stature, from the floor's middle, +y up, +z to the
// front. Left and right are symmetric. Trunk and limbs are a compromise between human shape and the
// body's capsules, so that the capsules approximate them; hands and feet are modelled freely.
class HumanForm {
public:
    explicit HumanForm(const Body& body);
    double operator()(const glm::dvec3& place) const;

private:
    std::vector<std::array<PlacedSphere, 2>> capsules_;  // at rest, in shares of the stature; the middle and left ones
};

}  // namespace fantascope::theatre
