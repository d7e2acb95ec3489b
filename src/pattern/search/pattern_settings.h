#pragma once

#include "pattern/search/pattern_search.h"
#include "pattern/shape/motion_settings.h"
#include "pattern/shape/shape_pattern.h"

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace fantascope::pattern {

// A shape that the settings name, and its own options.
struct ShapeSettings {
    ElementalShape shape;
    PatternSearch::Options::Shape own;
};

// The numerical parameters of Ji et al. 2015, sections 4.1 and 4.2, which an artist seldom changes.
struct PatternSettings {
    PatternSearch::Options search;
    MotionSettings motion;
    // Whether magnitudes and ranges are to be fitted to the pattern that is found (fittedMotion);
    // false if the file sets one.
    bool fitMotion = true;
    GuideTransfer guideTransfer = GuideTransfer::Srgb;
    // Absent: light for the refined method, stored values for the paper's.
    std::optional<CompareSpace> compare;
    std::vector<ShapeSettings> shapes;  // each is named once
    std::optional<double> seconds;      // time limit of the search, for the caller; > 0

    // The own options of the entry with the same name or file as `shape`; none if there is no such
    // entry.
    PatternSearch::Options::Shape ownOf(const ElementalShape& shape) const;
};

// Reads a *.pattern-settings.yaml (docs/pattern-settings.md), strictly. An absent key has the
// default of its field here.
// Error: names file, line, column, key.
Result<PatternSettings> readPatternSettings(const std::filesystem::path& file);

}  // namespace fantascope::pattern
