#pragma once

#include "theatre/stage/stage.h"

#include "core/result.h"

#include <filesystem>

namespace fantascope::app {

// Returns the stage file for a cast at `output` to name: `source` itself, if it lies in the cast's
// folder or below it; else a copy, in a folder of its own there, with its props' meshes.
Result<std::filesystem::path> placeStage(const std::filesystem::path& source, const theatre::Stage& stage,
                                         const std::filesystem::path& output);

// Checks that placeStage() can succeed. Called before the search, so that no result is lost.
Result<void> checkStageCanGo(const std::filesystem::path& source, const theatre::Stage& stage,
                             const std::filesystem::path& output);

}  // namespace fantascope::app
