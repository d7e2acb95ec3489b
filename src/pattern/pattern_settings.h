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
    GuideTransfer guideTransfer = GuideTransfer::Srgb;
};

// *.pattern-settings.yaml, strict; every key may be absent:
//     fantascope: pattern-settings
//     version: 1
//     guide_transfer: srgb            # or linear
//     search:  {lambda_create: 0.1, lambda_increase: 0.05, lambda_reduce: -0.05, lambda_delete: -0.1, lattice_cell: 2,
//     instance_cell: 2,
//               candidates: 12, largest_amount: 0.5, success_rate: 0.5, target_z: 0, rows: 720}
//     shapes:  {instances: 600, size: [0.01, 0.05], tilt: 40, turn: 180}          # canvas heights; degrees
//     colours: [{from: [0.1, 0.8, 0.4], to: [0, 0.3, 0.9]}, {from: [1, 1, 1]}]    # linear light; `to` is `from` when absent
//     motion:  {frames: 2000, ...}                                                # as in a pattern
// The numbers above are the defaults, except that sizes then follow from the guide and the one colour is white;
// PatternSearch::Options says what each means. Error: names file, line, column, key.
Result<PatternSettings> readPatternSettings(const std::filesystem::path& file);

}  // namespace fantascope::pattern
