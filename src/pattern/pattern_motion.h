#pragma once

#include <memory>
#include <span>

#include "core/clock.h"
#include "pattern/shape_pattern.h"

namespace fantascope::pattern {

// The movement of a whole pattern as a function of show time (Ji et al. 2015, section 4.2): two harmonic motions a group, five an instance.
// Periodic without a seam, exact under seek: poses depend on the time alone. Thread: every const method is reentrant.
class PatternMotion {
public:
    // Computes one period of every axis; some 0.1 ms an instance.
    explicit PatternMotion(const ShapePattern& pattern);

    // The loop's length, motion.frames / motion.rate seconds.
    Time period() const;
    // Fills one pose for every instance, in the pattern's order; out.size() == instances.size(). No allocation.
    void posesAt(Time time, std::span<InstancePose> out) const;

private:
    struct Tables;
    std::shared_ptr<const Tables> tables_;
};

}  // namespace fantascope::pattern
