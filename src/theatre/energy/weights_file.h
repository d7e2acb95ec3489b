#pragma once

#include "theatre/energy/pose_weights.h"

#include "core/result.h"

#include <filesystem>
#include <string_view>

namespace fantascope::theatre {

// Reads weights w1 .. w16 from a file (docs/weights-format.md). They start from `base`. The file's
// `common` overrides them, and then, if `preset` is not empty, its preset of that name. So a file
// needs only the weights that differ. Error: names file, line and weight; for instance a negative
// or unknown weight, or a missing preset.
Result<PoseWeights> readWeights(const std::filesystem::path& file, std::string_view preset = "", const PoseWeights& base = {});

}  // namespace fantascope::theatre
