#pragma once

#include "app/command/pose_options.h"

#include "theatre/stage/cast.h"

#include "media/image.h"

#include <string>
#include <vector>

namespace fantascope::app {

// Everything that a run of 'fantascope pose' leaves behind is made of this.
struct FoundPoses {
    const PoseOptions& options;
    std::vector<GreyImage> silhouettes;          // of each beam, white on black
    std::optional<theatre::Stage> stage;         // of options.stage
    std::vector<theatre::Cast::Target> targets;  // of each beam; their files as they were given
    theatre::PoseRounds rounds;

    const theatre::PoseRounds::Round& round() const { return rounds.rounds.back(); }
    const theatre::PoseProblem& problem() const { return round().problem; }
    const theatre::PoseTrials& trials() const { return round().trials; }
    const theatre::PoseTrials::Trial& best() const { return round().best(); }
};

// The cast with all that it names, and whatever else the options ask for.
Result<void> writeAll(const FoundPoses& found);

// One line for a person.
std::string brief(const FoundPoses& found);

}  // namespace fantascope::app
