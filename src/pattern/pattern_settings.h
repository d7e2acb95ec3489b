#pragma once

#include "pattern/motion_settings.h"
#include "pattern/pattern_search.h"
#include "pattern/shape_pattern.h"

#include "core/result.h"

#include <filesystem>

namespace fantascope::pattern {

// The numerical parameters of sections 4.1 and 4.2 (Ji et al. 2015), which an artist seldom changes.
struct PatternSettings {
    PatternSearch::Options search;
    MotionSettings motion;
    // Magnitudes and ranges are to be fitted to the pattern that is found (fittedMotion); false where the file names one.
    bool fitMotion = true;
    GuideTransfer guideTransfer = GuideTransfer::Srgb;
};

// *.pattern-settings.yaml (docs/pattern-settings.md), strict; every key may be absent and then has the default of its field here.
// Error: names file, line, column, key.
Result<PatternSettings> readPatternSettings(const std::filesystem::path& file);

}  // namespace fantascope::pattern
