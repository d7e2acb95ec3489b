#pragma once

#include "theatre/deform/triangulated_silhouette.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace fantascope::theatre {

// The movement of a silhouette's handles, as key frames. Pixels of the silhouette's picture,
// seconds.
struct HandleMotion {
    struct Key {
        double time = 0;
        glm::dvec2 place{0};
    };
    struct Handle {
        std::string name;
        glm::dvec2 at{0};  // at rest
        CarriedPoint point;
        std::vector<Key> keys;  // ascending times; empty: the handle is fixed
    };
    static constexpr int kMostFrames = 10'000;
    static constexpr double kMostFramesPerSecond = 240, kLeastFramesPerSecond = 1;

    double seconds = 0;
    double framesPerSecond = 12;
    bool loops = false;  // the end is the beginning
    std::vector<Handle> handles;

    // The place of a handle at a time, by monotone cubic interpolation between keys with a
    // continuous velocity, separately for x and y (Fritsch & Butland 1984). Before the first key
    // and after the last the handle stays there. In a loop the last key leads to the first.
    glm::dvec2 placeAt(const Handle& handle, double time) const;
    std::vector<glm::dvec2> placesAt(double time) const;
};

// Reads *.motion.yaml, docs/motion-format.md, for a silhouette. Error: names file, line, the handle
// and what to do; for instance two handles of one name or at the same point, a handle farther than
// kFarOutside from the white, times that do not rise or exceed the end, or a loop that does not end
// where it begins.
Result<HandleMotion> readMotion(const std::filesystem::path& file, const TriangulatedSilhouette& silhouette);
constexpr double kFarOutside = 2, kSamePoint = 1;  // pixels

}  // namespace fantascope::theatre
