#pragma once

#include "theatre/print/print_layout.h"
#include "theatre/print/voxel_solid.h"

#include <functional>
#include <string>
#include <vector>

namespace fantascope::theatre {

// Reports the progress of a print, 0 .. 1. An error ends the print.
using PrintStep = std::function<Result<void>(double share, const char* what)>;

// The second stage of a print: one connected solid on a grid, with walls that a printer can make.
struct PrintSolid {
    VoxelSolid solid;
    std::vector<Fabrication::ThinPart> thin{};
    std::vector<double> reinforcedBy{};  // of each of the layout's footings: Fabrication::Contact's
    std::vector<Fabrication::Rod> rods{};
    std::vector<std::string> warnings{};
    double thinnestWall = 0;
    std::string thinnestWallAt{};  // as Fabrication's
};

// `scene` must be posed and its terms() up to date. `options` must have a plate and a cell above 0.
// Error: a grid too large for memory, or `step`'s.
Result<PrintSolid> makeSolid(const PoseProblem& problem, const SceneEnergy& scene, const PrintLayout& layout,
                             const Fabrication::Options& options, const PrintStep& step);

}  // namespace fantascope::theatre
