#pragma once

#include "theatre/motion/pose_spline.h"
#include "theatre/stage/cast.h"
#include "theatre/stage/stage_set.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// Whether a cast's last frame leads to its first: its sequence loops, and it has all frames of it.
// Error: as readSequence().
Result<bool> loops(const Cast& cast);

// The people of a moving cast, posed at any moment between its frames, for a show that plays live.
// Thread: thread-bound.
class MovingCast {
public:
    // `loops`: after the last frame comes the first. `cast` must outlive this object.
    MovingCast(const Cast& cast, bool loops);
    MovingCast(const MovingCast&) = delete;
    MovingCast& operator=(const MovingCast&) = delete;

    // Poses everybody at a moment, in frames from the first. A loop takes any moment; otherwise the
    // ends are held. Only the first call allocates.
    void pose(double frame);

    std::size_t actors() const { return bodies_.size(); }
    const Body& body(std::size_t actor) const { return bodies_[actor]; }
    // In the current pose.
    const PosedBody& posed(std::size_t actor) const { return posed_[actor]; }
    std::span<const PlacedProp> held(std::size_t actor) const { return held_[actor]; }

private:
    const Cast& cast_;
    std::vector<Body> bodies_;
    std::vector<PoseSpline> splines_;
    std::vector<PosedBody> posed_;
    std::vector<std::vector<PlacedProp>> held_;
};

}  // namespace fantascope::theatre
