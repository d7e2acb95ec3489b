#pragma once

#include "theatre/stage/cast.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <vector>

namespace fantascope::theatre {

// What the shadow of a cast is to be, on a rectangle of a beam's screen. Row 0 of the pictures is
// the rectangle's upper edge.
struct WantedShadow {
    std::vector<GreyImage> frames;  // by frame of the cast, or one for all; 1: shadow is wanted
    GreyImage counted;              // 1 where the searches for poses compare: above the floor, and where light falls

    // At a position in the cast's motion: of the nearest frame.
    const GreyImage& at(double frame) const;
};

// `from`, `to`: the rectangle's lower left and upper right corners on the screen, unrolled if it is
// curved, metres. The pictures have `rows` rows. The silhouettes lie where the searches for poses
// place them. Those of a motion on the first beam's screen are the pictures of its sequence.
// Error: there is no target for the beam; or names the picture that is missing or no silhouette.
Result<WantedShadow> wantedShadow(const Cast& cast, std::size_t beam, glm::dvec2 from, glm::dvec2 to, int rows);

}  // namespace fantascope::theatre
