#pragma once

#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <filesystem>
#include <optional>
#include <vector>

namespace fantascope::theatre {

// A silhouette that moves (Won & Lee 2016, section 5).
struct SilhouetteSequence {
    // Its interior, the same triangles in each frame: the consistent triangulation that poses are
    // carried along by.
    struct Interior {
        std::vector<glm::uvec3> triangles;
        std::vector<std::vector<glm::dvec2>> vertices;  // [frame][vertex], pixels of the pictures, x right, y down
    };
    std::vector<std::filesystem::path> pictures;  // one a frame, all of one size
    double framesPerSecond = 12;
    bool loops = false;  // after the last frame comes the first
    std::optional<Interior> interior;
};

// sequence.yaml, docs/sequence-format.md. Error: names file, line, column and key; a picture that
// is not there, or of another size than the first.
Result<SilhouetteSequence> readSequence(const std::filesystem::path& file);
// Written aside and renamed; numbers come back to the last bit. The pictures lie in the file's
// folder or below it, and need not be there yet.
Result<void> writeSequence(const std::filesystem::path& file, const SilhouetteSequence& sequence);

}  // namespace fantascope::theatre
