#pragma once

#include "pattern/motion_settings.h"

#include "core/config.h"

#include <string>

namespace fantascope::pattern {

// The `motion:` section of a YAML file, the same in a pattern's settings and in a pattern. Every key may be absent and then has
// its default.
Result<MotionSettings> readMotion(const ConfigNode& node);

// All of the section, "motion:" first; what readMotion makes the same settings of.
std::string motionSection(const MotionSettings& motion);

}  // namespace fantascope::pattern
