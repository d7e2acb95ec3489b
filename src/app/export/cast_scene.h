#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/stage/cast.h"

#include "core/result.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace fantascope::app {

// One frame of a cast's file, with its silhouette: people in their skins, on their stage, before
// their target.
struct CastScene {
    theatre::Cast cast;
    std::size_t frame;  // from 0
    theatre::PoseProblem problem;
    std::vector<double> dofs;  // of all actors, one after the other
};
// Without a frame that of the principal poses. Error: as readCast() and readSequence(); there is no
// such frame; no picture of the silhouette.
Result<CastScene> readCastScene(const std::filesystem::path& file, std::optional<std::size_t> frame);

}  // namespace fantascope::app
