#pragma once

#include "theatre/stage/stage.h"

#include "core/result.h"

#include <filesystem>

namespace fantascope::app {

// Where the stage file `source` is that a cast at `output` names: where it lies, if that is the
// cast's folder or below it; else a copy in a folder of its own there, with its props' meshes.
Result<std::filesystem::path> placeStage(const std::filesystem::path& source, const theatre::Stage& stage,
                                         const std::filesystem::path& output);

// Whether placeStage() can. It is asked before the work, so that nothing found is lost.
Result<void> checkStageCanGo(const std::filesystem::path& source, const theatre::Stage& stage,
                             const std::filesystem::path& output);

}  // namespace fantascope::app
