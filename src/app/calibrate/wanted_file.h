#pragma once

#include "core/result.h"

#include <glm/vec2.hpp>

#include <array>
#include <filesystem>
#include <map>
#include <string>

namespace fantascope::app {

// By output: the corners of its whole canvas in pixels of the camera's picture as it is
// (distorted), clockwise from the canvas's top left.
using WantedCorners = std::map<std::string, std::array<glm::dvec2, 4>>;

// Where canvases are to stand.
struct Wanted {
    WantedCorners corners;
    bool markers = false;  // the other outputs' canvas stands where the markers on the wall say (marked_place.h)
};

// Reads where pictures are to stand (docs/calibrating.md). Strict. Error: file, line, column, key;
// corners that no picture can have.
Result<WantedCorners> readWanted(const std::filesystem::path& file);

}  // namespace fantascope::app
