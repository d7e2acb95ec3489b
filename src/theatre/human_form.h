#pragma once

#include <glm/vec3.hpp>

namespace fantascope::theatre {

// The form of a grown person in the rest pose of humanBody(), neither a woman nor a man, as a field: negative inside, near the surface the
// distance from it. In shares of the stature, from the floor's middle, +y up, +z to the front; left and right are mirrored.
double humanForm(const glm::dvec3& place);

}  // namespace fantascope::theatre
