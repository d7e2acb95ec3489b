#include "pattern/search/motion_fit.h"

#include "pattern/search/measure.h"

#include "core/geometry.h"

#include <cmath>

namespace fantascope::pattern {
namespace {

constexpr double kDisplacement = 0.155;     // of the mean size
constexpr double kToneGiven = 0.009;        // how much worse the mean tone over the loop may be than that at rest
constexpr int kMoments = 24;                // of the loop are looked at
constexpr double kMajor = 1, kMinor = 0.3;  // ranges of the groups, in mean sizes, before they are fitted
constexpr double kMagnitude = 2.5;          // in ranges: the range is reached by nearly all

// The parts that the local axes have in a movement: ranges in mean sizes and in degrees.
struct Mix {
    double translation, tilt, turn;
};
// A tilt costs the most tone, for a shape that tilts gets narrower, and a turn the least.
constexpr Mix kLively{0.15, 8, 26};
constexpr Mix kTurning{0.05, 3, 40};  // for drawings that do not bear the other

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

void setLength(AxisMotion& axis, double range) {
    axis.range = rounded(range, 1e5);
    axis.magnitude = rounded(kMagnitude * range, 1e5);
}
void setAngle(AxisMotion& axis, double degrees) {
    axis.range = radians(rounded(degrees, 10));
    axis.magnitude = radians(rounded(kMagnitude * degrees, 10));
}

// `local` and `groups`: shares of the mix and of the groups' ranges.
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

// The largest share 0..1, to 1/32, that is good; 0 is.
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
    bool borne;  // the local movement alone keeps to the tone
};

Fit fit(const ShapePattern& pattern, const Mix& mix, const GreyImage& guide, int threads) {
    // The movement is linear in its ranges, and so is the wind: one construction serves all that is
    // tried.
    ShapePattern whole = pattern;
    whole.motion = motionOf(pattern, mix, 1, 1);
    const LoopMeasure loop(whole, guide, threads);
    const double atRest = loop.in({.strength = 0}, 1).tone;
    const double local = kDisplacement / loop.in({}, kMoments).localDisplacement;
    const auto good = [&](double groups) {
        return loop.in({.strength = local, .ownDirection = groups / local}, kMoments).tone <= atRest + kToneGiven;
    };
    const bool borne = good(0);
    return {motionOf(pattern, mix, local, borne ? largestGood(good) : 0), borne};
}

}  // namespace

MotionSettings fittedMotion(const ShapePattern& pattern, const GreyImage& guide, int threads) {
    if (pattern.instances.empty()) return motionOf(pattern, kLively, 1, 1);
    const Fit lively = fit(pattern, kLively, guide, threads);
    return lively.borne ? lively.motion : fit(pattern, kTurning, guide, threads).motion;
}

}  // namespace fantascope::pattern
