#pragma once

#include "media/image.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <optional>
#include <span>

namespace fantascope::render {

// How an output's light is changed pixel by pixel: to x times that light plus y. Linear light; 1 is
// the projector's white.
using BlendMap = Image<glm::vec2>;

// The map of projector `which` of those that show parts of one canvas. Where pictures overlap, each
// contributes a share of the light, and the shares add up to one. Projectors leak light when black,
// so all blacks are raised to that of the brightest overlap. Masks dim. Nothing if the projector is
// alone on its canvas and has no mask.
//
// A share is 0 at those edges of the projector's picture that lie inside another picture, and grows
// with the distance from them (after Raskar et al. 1999, section 5), smoothly at both ends. It
// follows from the warps alone. `threads`: how many to use.
std::optional<BlendMap> blendMap(std::span<const Projection> onCanvas, std::size_t which, int threads);

}  // namespace fantascope::render
