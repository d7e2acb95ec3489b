#pragma once

#include "media/image.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <optional>
#include <span>

namespace fantascope::render {

// What becomes of the light that an output draws, pixel by pixel: x times that light plus y, all
// linear, 1 is the projector's white.
using BlendMap = Image<glm::vec2>;

// The map of one of the projectors that throw parts of one canvas: where pictures overlap, each
// gives a share of the light and the shares add up to one; every black is lifted to that of the
// place where most projectors shine on, since none of them is dark; masks dim. Nothing if there is
// nothing to do: alone on its canvas and without a mask.
//
// A share grows from nothing at those edges of the projector's picture that lie in another one,
// with the distance from there (after Raskar et al. 1999, section 5), and has no kink at its ends.
// It follows from the warps alone. `threads`: to work on it with.
std::optional<BlendMap> blendMap(std::span<const Projection> onCanvas, std::size_t which, int threads);

}  // namespace fantascope::render
