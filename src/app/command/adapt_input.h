#pragma once

#include "theatre/deform/silhouette_sequence.h"
#include "theatre/motion/motion_adaptation.h"
#include "theatre/stage/cast.h"

#include "core/parallel.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

namespace fantascope::app {

// What 'fantascope adapt' is told.
struct AdaptOptions {
    std::filesystem::path cast, sequence, output;
    std::optional<int> representative;  // from 1
    std::optional<double> frameRate;
    std::uint64_t seed = 1;
    theatre::MotionAdaptation::Options search{.threads = hardwareThreads()};
    std::optional<std::filesystem::path> sheet, video, report;
};

// Everything that a run needs and leaves behind.
struct Adapted {
    const AdaptOptions& options;
    theatre::Cast cast;  // the principal poses
    theatre::SilhouetteSequence sequence;
    theatre::MotionProblem motion;
    std::vector<double> principal;
    theatre::MotionAdaptation::Frames frames{};
    std::vector<double> seconds{};  // of each frame, when it was done
    bool isWhole() const {
        return std::all_of(frames.begin(), frames.end(), [](const auto& frame) { return frame.has_value(); });
    }
};

// Reads the principal poses and the sequence, without any frame yet. Error: they do not go
// together, or cannot be read.
Result<Adapted> readMotion(const AdaptOptions& options);

// Tells the person at the terminal what will be hard to follow: jumps, triangles that fold over, a
// representative frame that is far from the others. It is followed as well as can be.
void warn(const Adapted& adapted);

}  // namespace fantascope::app
