#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/stage/cast.h"

#include "core/result.h"

#include <optional>
#include <span>
#include <vector>

namespace fantascope::theatre {

// Who plays a silhouette, and how large it is (Won & Lee 2016, section 3, strategy 5: fewer for
// smaller shapes, more for larger ones).
struct Troupe {
    std::vector<double> statures;  // of each actor, metres
    double height = 0;             // of the silhouette on the screen, metres

    // What is not given is chosen so that everyone has about kShare of the silhouette: the height,
    // in whole centimetres, or up to kMostUnasked actors. If neither is given, the height is
    // kUsualHeight. `area`: the silhouette's, in squares of its height. `statures`: one for all, or
    // one for each actor, metres. Error: says what is out of range, and which heights and numbers
    // of actors are possible.
    static Result<Troupe> of(double area, std::optional<int> actors, std::optional<double> height,
                             std::span<const double> statures);

    static constexpr int kMostActors = 49, kMostUnasked = 12;
    static constexpr double kUsualHeight = 1.7, kLeastHeight = 0.3, kMostHeight = 8;
    // Square metres of the silhouette for an actor of kStature metres; for others the area scales
    // with the square of the stature. The smallest shadow, of somebody who crouches at the screen,
    // has about kLeastShare. The largest, of somebody who stretches near the light, has about
    // kMostShare.
    static constexpr double kStature = 1.75, kShare = 0.6, kLeastShare = 0.12, kMostShare = 6;
};

// The area that people have to fill, for Troupe::of(): the mean over the beams of a stage, in
// squares of the first silhouette's height. It does not depend on the lights. `silhouettes`: one a
// beam, each laid on a stage with one lamp.
double areaToFill(std::span<const PoseTarget> silhouettes, const Stage& stage);

// The target on the screen of a further beam that matches a first target of `height` metres: its
// height is scaled like the shadow of people, and its middle is where that shadow falls. Both are
// rounded to whole centimetres. The file is empty.
Cast::Target targetOn(const Stage& stage, std::size_t beam, double height);

}  // namespace fantascope::theatre
