#pragma once

#include "pattern/shape/motion_settings.h"

#include "core/config/config.h"
#include "core/result.h"

#include <string>

namespace fantascope::pattern {

// Reads the value of a `motion:` key (docs/pattern-format.md). Strict; absent keys keep their
// defaults. The result lies within the bounds that MotionSettings states. Thread: reentrant.
Result<MotionSettings> readMotion(const ConfigNode& node);
// Whether `node`, which readMotion() accepts, sets the magnitude or the range of any axis.
Result<bool> setsAmplitude(const ConfigNode& node);
// The `motion:` key and its value as whole lines without indentation, with every setting.
std::string motionText(const MotionSettings& motion);

}  // namespace fantascope::pattern
