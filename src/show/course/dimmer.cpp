#include "show/course/dimmer.h"

#include "show/course/course.h"

#include <algorithm>

namespace fantascope::show {

void Dimmer::want(float level, Time at, Time fade) { moves_.set(at, {this->at(at), level, at, fade}); }

float Dimmer::at(Time time) const {
    const Move& move = moves_.at(time);
    const float moved = Course{0, 1, move.start, move.fade}.shareAt(time);
    return move.to < move.from ? std::max(move.to, move.from - moved) : std::min(move.to, move.from + moved);
}

}  // namespace fantascope::show
