#include "pattern/search/motion_fit.h"

#include "pattern/search/measure.h"

#include "core/geometry.h"

#include <cmath>

namespace fantascope::pattern {
namespace {

constexpr double kDisplacement = 0.155;     // wanted LoopQuality::localDisplacement
constexpr double kToneLoss = 0.009;         // by which the mean tone over the loop may exceed the tone at rest
constexpr int kMoments = 24;                // of the loop that are measured
constexpr double kMajor = 1, kMinor = 0.3;  // maximum ranges of the groups, in mean sizes
constexpr double kMagnitude = 2.5;          // in ranges: large enough that nearly every movement reaches its range

// The composition of local movement: translation range in mean sizes, tilt and turn ranges in
// degrees.
struct Mix {
    double translation, tilt, turn;
};
// Tilts harm the tone most, since a tilted shape is narrower; turns least.
constexpr Mix kLively{0.15, 8, 26};
constexpr Mix kTurning{0.05, 3, 40};  // for drawings whose tone does not allow kLively

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

void setLength(AxisMotion& axis, double range) {
    axis.range = rounded(range, 1e5);
    axis.magnitude = rounded(kMagnitude * range, 1e5);
}
void setAngle(AxisMotion& axis, double degrees) {
    axis.range = radians(rounded(degrees, 10));
    axis.magnitude = radians(rounded(kMagnitude * degrees, 10));
}

// `local`, `groups`: factors of the mix and of the groups' ranges.
MotionSettings motionOf(const ShapePattern& pattern, const Mix& mix, double local, double groups) {
    const double size = pattern.meanSize();
    MotionSettings motion = pattern.motion;
    setLength(motion.groupMajor, groups * kMajor * size);
    setLength(motion.groupMinor, groups * kMinor * size);
    setLength(motion.localTranslation, local * mix.translation * size);
    setAngle(motion.localTilt, local * mix.tilt);
    setAngle(motion.localTurn, local * mix.turn);
    return motion;
}

// The largest good share 0..1, to a precision of 1/32; 0 is taken to be good.
template <class Good>
double largestGood(Good good) {
    if (good(1)) return 1;
    double share = 0;
    for (double step = 0.5; step >= 1.0 / 32; step /= 2)
        if (good(share + step)) share += step;
    return share;
}

struct Fit {
    MotionSettings motion;
    bool isGood;  // local movement alone keeps the tone
};

Fit fit(const ShapePattern& pattern, const Mix& mix, const GreyImage& guide, int threads, const GreyImage* surface) {
    // The movement is linear in its ranges and in the wind's strength, so one LoopMeasure serves
    // all trials.
    ShapePattern whole = pattern;
    whole.motion = motionOf(pattern, mix, 1, 1);
    const LoopMeasure loop(whole, guide, threads, surface);
    const double atRest = loop.in({.strength = 0}, 1).tone;
    const double local = kDisplacement / loop.in({}, kMoments).localDisplacement;
    const auto good = [&](double groups) {
        return loop.in({.strength = local, .ownDirection = groups / local}, kMoments).tone <= atRest + kToneLoss;
    };
    const bool isGood = good(0);
    return {motionOf(pattern, mix, local, isGood ? largestGood(good) : 0), isGood};
}

}  // namespace

MotionSettings fittedMotion(const ShapePattern& pattern, const GreyImage& guide, int threads, const GreyImage* surface) {
    if (pattern.instances.empty()) return motionOf(pattern, kLively, 1, 1);
    const Fit lively = fit(pattern, kLively, guide, threads, surface);
    return lively.isGood ? lively.motion : fit(pattern, kTurning, guide, threads, surface).motion;
}

}  // namespace fantascope::pattern
