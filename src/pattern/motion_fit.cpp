#include "pattern/motion_fit.h"

#include "pattern/measure.h"

#include <cmath>

namespace fantascope::pattern {
namespace {

constexpr double kDisplacement = 0.155;  // of the mean size
constexpr double kToneGiven = 0.009;     // how much worse the mean tone over the loop may be than that at rest
constexpr int kMoments = 24;             // of the loop are looked at
constexpr int kHalvings = 5;             // of the interval in which the groups' share lies
// The parts that the axes have in a movement, before it is fitted: ranges in mean sizes, and in radians. Tilts cost the most tone, for
// a shape that tilts gets narrower; turns cost the least.
constexpr double kMajor = 1, kMinor = 0.3, kTranslation = 0.15;
constexpr double kTilt = radians(8), kTurn = radians(26);
constexpr double kMagnitude = 2.5;  // in ranges: the range is reached by nearly all

void setRange(AxisMotion& axis, double range, double step) {
    axis.range = std::round(range / step) * step;
    axis.magnitude = kMagnitude * axis.range;
}

}  // namespace

MotionSettings fittedMotion(const ShapePattern& pattern, const GreyImage& guide, int threads) {
    const double size = pattern.meanSize();
    // `local` and `groups`: shares of the ranges above.
    const auto motionOf = [&](double local, double groups) {
        constexpr double kLength = 1e-5, kAngle = radians(0.1);
        MotionSettings motion = pattern.motion;
        setRange(motion.groupMajor, groups * kMajor * size, kLength);
        setRange(motion.groupMinor, groups * kMinor * size, kLength);
        setRange(motion.localTranslation, local * kTranslation * size, kLength);
        setRange(motion.localTilt, local * kTilt, kAngle);
        setRange(motion.localTurn, local * kTurn, kAngle);
        return motion;
    };
    ShapePattern lively = pattern;
    lively.motion = motionOf(1, 1);
    if (pattern.instances.empty()) return lively.motion;

    // The movement is linear in its ranges, and so is the wind: one construction serves all that is tried.
    const LoopMeasure loop(lively, guide, threads);
    const double atRest = loop.in({.strength = 0}, 1).tone;
    const double local = kDisplacement / loop.in({}, kMoments).localDisplacement;
    const auto good = [&](double groups) {
        return loop.in({.strength = local, .ownDirection = groups / local}, kMoments).tone <= atRest + kToneGiven;
    };
    double groups = 1;
    if (!good(groups)) {
        double step = 0.5;
        groups = 0;
        for (int i = 0; i < kHalvings; ++i, step /= 2)
            if (good(groups + step)) groups += step;
    }
    return motionOf(local, groups);
}

}  // namespace fantascope::pattern
