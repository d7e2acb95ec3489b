#pragma once

#include "vision/structured_light.h"

#include "media/image.h"

#include <optional>

namespace fantascope::vision {

// How far a projector's light has moved over the camera's picture since a map was measured:
// projector pixels along one axis, the median over blocks of the camera's picture, so that somebody
// who stands before some of them does not matter. It is never more than half of `light.period()`,
// and a movement by whole periods is not found. Nothing: the map knows too little. `difference`: by
// camera pixel, linear light: the picture of `light`'s first phase along `axis`, less its
// complement.
// Thread: reentrant.
std::optional<double> movedSince(const ProjectorMap& map, const StructuredLight& light, StructuredLight::Axis axis,
                                 const GreyImage& difference);

}  // namespace fantascope::vision
