#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/clock.h"
#include "core/parallel.h"
#include "core/wind.h"

#include <memory>
#include <span>

namespace fantascope::pattern {

// The movement of a whole pattern as a function of show time (Ji et al. 2015, section 4.2): two
// harmonic motions per group, five per instance. It repeats without a seam. Poses depend on the
// time alone, so a seek is exact. The movement of an instance depends on (seed, id) and (seed,
// group) alone, so adding or removing other instances does not change it. The wind of the moment
// asked for scales and turns the pattern's own movement; it may change from frame to frame, and a
// seek stays exact.
//
// Memory: 40 bytes per instance and frame, 16 per group and frame. With the paper's 2000 frames
// that is 80 kB per instance, 245 MB for 3000. Copies share it.
// Thread: every const method is reentrant.
class PatternMotion {
public:
    // Computes one period of every axis on `threads` threads: about 1 ms per instance on one
    // thread. The result does not depend on `threads`. pattern.motion must be within the bounds
    // that MotionSettings states.
    explicit PatternMotion(const ShapePattern& pattern, int threads = hardwareThreads());

    // The loop's length: motion.frames / motion.rate seconds, rounded to a nanosecond. In the same
    // wind posesAt(t + period()) equals posesAt(t) bit for bit.
    Time period() const;
    // Fills `out` with one pose per instance, in the pattern's order; out.size() ==
    // instances.size(). `time` may be negative. All displacements are proportional to
    // wind.strength: no axis exceeds its range times that, and at 0 everything is at rest. Does not
    // allocate.
    void posesAt(Time time, const Wind& wind, std::span<InstancePose> out) const;

private:
    struct Tables;
    std::shared_ptr<const Tables> tables_;
};

}  // namespace fantascope::pattern
