#pragma once

#include "theatre/body/posed_body.h"
#include "theatre/mask/bit_mask.h"
#include "theatre/stage/stage.h"

#include <vector>

namespace fantascope::theatre {

// The shadows of spheres and capsules. A sphere's is an ellipse; a capsule's is the convex hull of
// its ends' ellipses: they and the quadrilateral between the points where the light's two tangent
// planes of both spheres touch them.
// Thread: thread-bound.
class CapsuleShadow {
public:
    // Adds the shadow to a mask of the frame's size. A sphere that reaches the light's height above
    // the screen, where it would throw no bounded shadow, adds nothing and gives false, and so does
    // what hangs on it.
    bool add(const ScreenFrame& frame, const PlacedSphere& sphere, BitMask& mask);
    bool add(const ScreenFrame& frame, const PlacedCapsule& capsule, BitMask& mask);
    bool add(const ScreenFrame& frame, const PosedBody& body, BitMask& mask);

private:
    // What a capsule's shadow has beyond those of its ends.
    void addBetween(const ScreenFrame& frame, const PlacedCapsule& capsule, BitMask& mask);

    std::vector<float> left_, right_;  // of the rows of an ellipse; scratch, kept for its memory
    ConvexFiller filler_;
};

}  // namespace fantascope::theatre
