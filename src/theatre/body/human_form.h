#pragma once

#include "theatre/body/posed_body.h"

#include <array>
#include <vector>

namespace fantascope::theatre {

// The form of a grown person in the rest pose of humanBody(), neither a woman nor a man, as a
// field: negative inside, near the surface the distance from it. In shares of the stature, from the
// floor's middle, +y up, +z to the front; left and right are mirrored. Trunk and limbs lie between
// how people are shaped and the body's capsules, so that these can stand for them; hands and feet
// are of their own form.
class HumanForm {
public:
    explicit HumanForm(const Body& body);
    double operator()(const glm::dvec3& place) const;

private:
    std::vector<std::array<PlacedSphere, 2>> capsules_;  // at rest, in statures; the middle and left ones
};

}  // namespace fantascope::theatre
