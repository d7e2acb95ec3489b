#pragma once

#include "theatre/print/print_layout.h"
#include "theatre/print/voxel_solid.h"

#include <functional>
#include <string>
#include <vector>

namespace fantascope::theatre {

// Tells how far a print has come; an error ends it.
using PrintStep = std::function<Result<void>(double share, const char* what)>;

// The second stage of a print: one piece on a grid, with walls that a printer makes.
struct PrintSolid {
    VoxelSolid solid;
    std::vector<Fabrication::ThinPart> thin{};
    std::vector<double> reinforcedBy{};  // of each of the layout's footings: Fabrication::Contact's
    std::vector<Fabrication::Rod> rods{};
    std::vector<std::string> warnings{};
    double thinnestWall = 0;
    std::string thinnestWallAt{};  // as Fabrication's
};

// `scene` is posed and its terms asked for. `options` say plate and cell. Error: a grid beyond what
// a machine holds, or `step`'s.
Result<PrintSolid> makeSolid(const PoseProblem& problem, const SceneEnergy& scene, const PrintLayout& layout,
                             const Fabrication::Options& options, const PrintStep& step);

}  // namespace fantascope::theatre
