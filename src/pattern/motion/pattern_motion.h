#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/clock.h"
#include "core/parallel.h"
#include "core/wind.h"

#include <memory>
#include <span>

namespace fantascope::pattern {

// The movement of a whole pattern as a function of show time (Ji et al. 2015, section 4.2): two
// harmonic motions a group, five an instance. Periodic without a seam, exact under seek: poses
// depend on the time alone. What moves an instance depends on (seed, its id) and on (seed, its
// group) alone, so that another instance more or less changes nothing for it. A wind multiplies and
// turns what the pattern does by itself, at the moment of asking: so it may change from frame to
// frame and a seek is exact still.
//
// Memory: 40 bytes for each instance and frame, 16 for each group and frame; with the paper's 2000
// frames 80 kB an instance, 245 MB for 3000. Copies share it.
// Thread: every const method is reentrant.
class PatternMotion {
public:
    // Computes one period of every axis on `threads` threads, which change nothing but the time
    // that it takes: about 1 ms an instance on one. pattern.motion must be within the bounds that
    // MotionSettings states.
    explicit PatternMotion(const ShapePattern& pattern, int threads = hardwareThreads());

    // The loop's length: motion.frames / motion.rate seconds, to a whole nanosecond. In the same
    // wind posesAt(t + period()) is posesAt(t), bit for bit.
    Time period() const;
    // Fills one pose for every instance, in the pattern's order; out.size() == instances.size().
    // Any time, negative ones too. All displacements are proportional to wind.strength: no axis
    // leaves its range times that, and at 0 all is at rest. Allocates nothing.
    void posesAt(Time time, const Wind& wind, std::span<InstancePose> out) const;

private:
    struct Tables;
    std::shared_ptr<const Tables> tables_;
};

}  // namespace fantascope::pattern
