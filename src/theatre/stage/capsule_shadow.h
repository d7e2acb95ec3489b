#pragma once

#include "theatre/body/posed_body.h"
#include "theatre/mask/bit_mask.h"
#include "theatre/stage/stage.h"

#include <vector>

namespace fantascope::theatre {

// The shadows of spheres and capsules. A sphere's shadow is an ellipse. A capsule's shadow is the
// convex hull of its ends' ellipses. It consists of the ellipses and a quadrilateral between the
// points where the light's two common tangent planes touch the spheres.
// Thread: thread-bound.
class CapsuleShadow {
public:
    // Adds the shadow to a mask of the frame's size. A sphere that reaches as far from the screen
    // as the light has no bounded shadow: it adds nothing, and the result is false. Capsules with
    // such an end add nothing either.
    bool add(const ScreenFrame& frame, const PlacedSphere& sphere, BitMask& mask);
    bool add(const ScreenFrame& frame, const PlacedCapsule& capsule, BitMask& mask);
    bool add(const ScreenFrame& frame, const PosedBody& body, BitMask& mask);

private:
    // Adds the part of a capsule's shadow that its ends' shadows do not cover.
    void addBetween(const ScreenFrame& frame, const PlacedCapsule& capsule, BitMask& mask);

    std::vector<float> left_, right_;  // of the rows of an ellipse; scratch, kept for its memory
    ConvexFiller filler_;
};

}  // namespace fantascope::theatre
