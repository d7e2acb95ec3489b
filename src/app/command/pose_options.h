#pragma once

#include "app/base/command_line.h"

#include "theatre/search/pose_rounds.h"

#include "core/parallel.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// What 'fantascope pose' is told.
struct PoseOptions {
    std::filesystem::path target, output;
    std::optional<int> actors;     // none: auto
    std::optional<double> height;  // of the first silhouette, metres
    std::vector<double> statures{theatre::Troupe::kStature};
    theatre::PoseRounds::Options search{.threads = hardwareThreads()};
    std::optional<std::filesystem::path> hints, stage;
    bool invert = false;
    std::vector<std::filesystem::path> furtherTargets;
    std::vector<double> furtherHeights, furtherMiddles;  // of these targets; empty: by theatre::targetOn()
    std::optional<std::string> weights;                  // a preset's name, or a file
    std::optional<std::filesystem::path> image, view, each, solutions, meshes, report;

    // The silhouettes' files, one for each beam.
    std::vector<std::filesystem::path> targets() const;
};

constexpr std::size_t kMostSolutions = 8;

void declarePose(Command& command, PoseOptions& options);

// Refuses before the search what could not be written after it.
Result<void> checkOutputs(const PoseOptions& options);
// Error: the further targets' options are not as many as the stage has further beams.
Result<void> checkFurther(const PoseOptions& options, std::size_t furtherBeams);

// What the silhouette of a beam that was turned over is called beside an output: P.inverted.png
// beside P.cast.yaml, and P.inverted-2.png for the second beam.
std::string invertedName(const std::filesystem::path& output, std::size_t beam);
// "", or "-2" for the second beam's.
std::string numbered(std::size_t beam);

}  // namespace fantascope::app
