#pragma once

#include "app/calibrate/corner_picture.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace fantascope::app {

// By output: the corners of its whole canvas in pixels of the camera's picture as it is
// (distorted), clockwise from the canvas's top left.
using WantedCorners = std::map<std::string, std::array<glm::dvec2, 4>>;

// Asks a person for the places of canvases: the corners of each, as above, in the order of
// `places`. Error: the person gave up, or cannot be asked.
using ChoosePlaces = std::function<Result<std::vector<std::array<glm::dvec2, 4>>>(std::vector<OpenPlace> places)>;

// Where canvases are to stand.
struct Wanted {
    WantedCorners corners;
    bool markers = false;  // the other outputs' canvas stands where the markers on the wall say (marked_place.h)
    ChoosePlaces choose;   // if set and without markers: a person chooses the place of the other outputs' canvases
};

// Reads where pictures are to stand (docs/calibrating.md). Strict. Error: file, line, column, key;
// corners that no picture can have.
Result<WantedCorners> readWanted(const std::filesystem::path& file);

}  // namespace fantascope::app
