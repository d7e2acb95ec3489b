#pragma once

#include "theatre/bit_mask.h"
#include "theatre/posed_body.h"
#include "theatre/stage.h"

#include <array>

namespace fantascope::theatre {

// The shadow of a capsule: the convex hull of two ellipses, since the light's tangent planes of a sphere at d (from the light) with radius
// r are those whose unit normal n has n.d = r. It is drawn as a polygon of its outermost points in kDirections directions, on the true
// outline; between them it lies inside by at most 1 - cos(pi / kDirections) of the ellipse's size.
// Thread: thread-bound.
class CapsuleShadow {
public:
    static constexpr int kDirections = 20;

    // Adds the shadow to a mask of the frame's size. A capsule that reaches the light's height above the screen, where it would throw no
    // bounded shadow, adds nothing and gives false.
    bool add(const ScreenFrame& frame, const PlacedCapsule& capsule, BitMask& mask);

private:
    struct Reach {
        std::array<float, kDirections> far, x, y;
    };
    static void feel(const glm::vec3& d, float radius, Reach& reach);

    Reach from_, to_;
    std::array<glm::vec2, kDirections> outline_;
    ConvexFiller filler_;
};

}  // namespace fantascope::theatre
