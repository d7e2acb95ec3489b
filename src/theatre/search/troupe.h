#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/stage/cast.h"

#include "core/result.h"

#include <optional>
#include <span>
#include <vector>

namespace fantascope::theatre {

// Who plays a silhouette, and how large (Won & Lee 2016, section 3, strategy 5: fewer for smaller
// shapes, more for larger ones).
struct Troupe {
    std::vector<double> statures;  // of each actor, metres
    double height = 0;             // of the silhouette on the screen, metres

    // What is not said is chosen so that everyone has about kShare of the silhouette: the height,
    // in whole centimetres, or up to kMostUnasked actors; where neither is said the height is
    // kUsualHeight. `area`: the silhouette's, in squares of its height. `statures`: one for all, or
    // one an actor. Error: says what is out of range, and which heights and how many actors would
    // do.
    static Result<Troupe> of(double area, std::optional<int> actors, std::optional<double> height,
                             std::span<const double> statures);

    static constexpr int kMostActors = 49, kMostUnasked = 12;
    static constexpr double kUsualHeight = 1.7, kLeastHeight = 0.3, kMostHeight = 8;
    // Square metres of the silhouette for an actor of kStature, and in squares of the stature for
    // others: less than kLeastShare is not filled by the smallest shadow, of somebody who crouches
    // at the screen; more than kMostShare is beyond the largest, of somebody who stretches near the
    // light.
    static constexpr double kStature = 1.75, kShare = 0.6, kLeastShare = 0.12, kMostShare = 6;
};

// The area that people have to fill, for Troupe::of(): on average over the beams of a stage, in
// squares of the first silhouette's height, wherever the lights are. `silhouettes`: one a beam,
// each laid on a stage with one lamp.
double areaToFill(std::span<const PoseTarget> silhouettes, const Stage& stage);

// How high a silhouette is on the screen of a beam, and where its middle is, in whole centimetres,
// for people to be as high there as on the first screen, where they are `height` metres high. It
// has no file yet.
Cast::Target targetOn(const Stage& stage, std::size_t beam, double height);

}  // namespace fantascope::theatre
