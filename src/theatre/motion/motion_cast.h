#pragma once

#include "theatre/motion/motion_adaptation.h"
#include "theatre/stage/cast.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// What an adaptation leaves in a cast, and how a later one resumes from it.
// Thread: reentrant.

// The frames that have poses, in the order in which they are played. They hang together; in a loop
// also over its end.
std::vector<std::size_t> playedFrames(const MotionProblem& motion, const MotionAdaptation::Frames& frames);

// The frames of a motion that was interrupted, for MotionAdaptation::run() to resume from: those
// that `written` has, if it is of these principal poses and of this sequence. Nothing if it is not,
// or is whole.
MotionAdaptation::Frames resumedFrames(const MotionProblem& motion, std::span<const double> principal, const Cast& written);

}  // namespace fantascope::theatre
