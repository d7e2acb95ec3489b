#pragma once

#include "theatre/deform/triangulated_silhouette.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace fantascope::theatre {

// How the handles of a silhouette move: key frames. Pixels of the silhouette's picture, seconds.
struct HandleMotion {
    struct Key {
        double time = 0;
        glm::dvec2 place{0};
    };
    struct Handle {
        std::string name;
        glm::dvec2 at{0};  // at rest
        CarriedPoint point;
        std::vector<Key> keys;  // times rise; none: it is fixed
    };
    static constexpr int kMostFrames = 10'000;
    static constexpr double kMostFramesPerSecond = 240, kLeastFramesPerSecond = 1;

    double seconds = 0;
    double framesPerSecond = 12;
    bool loops = false;  // the end is the beginning
    std::vector<Handle> handles;

    // Eased from key to key by a cubic that rises or falls between two keys and nothing else, for x
    // and y apart, its velocity without jumps (Fritsch & Butland 1984). Before the first key and
    // after the last it stays there; a loop goes on from the last to the first.
    glm::dvec2 placeAt(const Handle& handle, double time) const;
    std::vector<glm::dvec2> placesAt(double time) const;
};

// *.motion.yaml, docs/motion-format.md, for a silhouette. Error: names file, line, the handle and
// what to do: two of one name or at the same point, one farther than kFarOutside from the white,
// times that do not rise or go beyond the end, a loop whose end is not its beginning.
Result<HandleMotion> readMotion(const std::filesystem::path& file, const TriangulatedSilhouette& silhouette);
constexpr double kFarOutside = 2, kSamePoint = 1;  // pixels

}  // namespace fantascope::theatre
