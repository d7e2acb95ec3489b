#pragma once

#include "theatre/motion/motion_adaptation.h"
#include "theatre/stage/cast.h"

#include <span>
#include <vector>

namespace fantascope::theatre {

// How an adaptation is stored in a cast, and how a later one resumes from it.
// Thread: reentrant.

// The frames that have poses, in the order in which they are played. They are contiguous; in a loop
// they may wrap around its end.
std::vector<std::size_t> playedFrames(const MotionProblem& motion, const MotionAdaptation::Frames& frames);

// The frames of an interrupted motion, from which MotionAdaptation::run() resumes: those of
// `written`, if it has these principal poses and this sequence. Empty if it has others, or if it is
// complete.
MotionAdaptation::Frames resumedFrames(const MotionProblem& motion, std::span<const double> principal, const Cast& written);

}  // namespace fantascope::theatre
