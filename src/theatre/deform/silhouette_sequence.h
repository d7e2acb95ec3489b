#pragma once

#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <filesystem>
#include <optional>
#include <vector>

namespace fantascope::theatre {

// A moving silhouette (Won & Lee 2016, section 5).
struct SilhouetteSequence {
    // Its interior, the same triangles in each frame: the consistent triangulation by which poses
    // follow it.
    struct Interior {
        std::vector<glm::uvec3> triangles;
        std::vector<std::vector<glm::dvec2>> vertices;  // [frame][vertex], pixels of the pictures, x right, y down
    };
    std::vector<std::filesystem::path> pictures;  // one for each frame, all of one size
    double framesPerSecond = 12;
    bool loops = false;  // after the last frame comes the first
    std::optional<Interior> interior;
};

// Reads sequence.yaml, docs/sequence-format.md. Error: names file, line, column and key; for
// instance a picture that is missing, or whose size differs from the first.
Result<SilhouetteSequence> readSequence(const std::filesystem::path& file);
// Writes to a temporary file that is then renamed. Numbers are written so that they are read back
// exactly. The pictures must lie in the file's folder or below it, and need not exist yet.
Result<void> writeSequence(const std::filesystem::path& file, const SilhouetteSequence& sequence);

}  // namespace fantascope::theatre
