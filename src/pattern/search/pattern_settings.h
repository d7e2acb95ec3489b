#pragma once

#include "pattern/search/pattern_search.h"
#include "pattern/shape/motion_settings.h"
#include "pattern/shape/shape_pattern.h"

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace fantascope::pattern {

// A shape that the settings name, and what it has of its own.
struct ShapeSettings {
    ElementalShape shape;
    PatternSearch::Options::Shape own;
};

// The numerical parameters of sections 4.1 and 4.2 (Ji et al. 2015), which an artist seldom
// changes.
struct PatternSettings {
    PatternSearch::Options search;
    MotionSettings motion;
    // Magnitudes and ranges are to be fitted to the pattern that is found (fittedMotion); false
    // where the file names one.
    bool fitMotion = true;
    GuideTransfer guideTransfer = GuideTransfer::Srgb;
    std::vector<ShapeSettings> shapes;  // none is named twice
    std::optional<double> seconds;      // after which the caller is to stop the search; > 0

    // What `shape` has of its own: of these the one of the same name or file; nothing if there is
    // none.
    PatternSearch::Options::Shape ownOf(const ElementalShape& shape) const;
};

// *.pattern-settings.yaml (docs/pattern-settings.md), strict; every key may be absent and then has
// the default of its field here.
// Error: names file, line, column, key.
Result<PatternSettings> readPatternSettings(const std::filesystem::path& file);

}  // namespace fantascope::pattern
