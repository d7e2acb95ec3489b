#pragma once

#include "theatre/stage/stage.h"

#include <filesystem>

namespace fantascope::theatre {

// Reads *.stage.yaml, docs/stage-format.md, and the meshes that it names. Error: names file, line,
// key and what to do; for instance a light behind the screen or below the floor, two lights or
// none, a platform in the floor or the screen, a mesh that cannot be read, a prop that stands
// outside the stage.
Result<Stage> readStage(const std::filesystem::path& file);

}  // namespace fantascope::theatre
