#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/stage/cast.h"

#include "core/result.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace fantascope::app {

// One frame of a cast file: its actors with skins, their stage, and the silhouette as target.
struct CastScene {
    theatre::Cast cast;
    std::size_t frame;  // from 0
    theatre::PoseProblem problem;
    std::vector<double> dofs;  // all actors' degrees of freedom, one actor after the other
};
// `frame`: default: that of the principal poses. Error: as readCast() and readSequence(); there is
// no such frame, or no picture of the silhouette.
Result<CastScene> readCastScene(const std::filesystem::path& file, std::optional<std::size_t> frame);

}  // namespace fantascope::app
