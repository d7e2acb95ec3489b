#pragma once

#include "theatre/energy/pose_weights.h"

#include "core/result.h"

#include <filesystem>
#include <string_view>

namespace fantascope::theatre {

// Weights w1 .. w12 of a file (docs/weights-format.md): those of `base` but for what the file's
// `common` says, and then, if `preset` is not empty, what its preset of that name says. A file of
// one's own has only what is to be different. Error: names file, line and weight: one that is
// negative, an unknown one, or a preset that is not there.
Result<PoseWeights> readWeights(const std::filesystem::path& file, std::string_view preset = "", const PoseWeights& base = {});

}  // namespace fantascope::theatre
