#pragma once

#include "pattern/shape/motion_settings.h"

#include "core/config.h"
#include "core/result.h"

#include <string>

namespace fantascope::pattern {

// The value of a `motion:` key (docs/pattern-format.md). Strict; what is absent keeps its default.
// Whatever is accepted lies within the bounds that MotionSettings states. Thread: reentrant.
Result<MotionSettings> readMotion(const ConfigNode& node);
// Whether it names a magnitude or a range of any axis. `node`: one that readMotion accepts.
Result<bool> namesAmplitude(const ConfigNode& node);
// The key and its value at the margin of a file, as whole lines, every setting spelled out.
std::string motionText(const MotionSettings& motion);

}  // namespace fantascope::pattern
