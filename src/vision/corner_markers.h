#pragma once
// Four printed markers that say where a canvas is to stand on the wall: ArUco markers of 4 x 4 bits
// (Garrido-Jurado et al. 2014), numbers 0 to 3 clockwise from the canvas's top left.

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <array>
#include <string_view>
#include <vector>

namespace fantascope::vision {

// Thread: every function is reentrant.
struct CornerMarker {
    static constexpr int kCells = 6;  // across and down, with the dark rim of one cell
    static constexpr std::array<std::string_view, 4> kNames = {"top left", "top right", "bottom right", "bottom left"};

    // Whether each cell is dark, row by row.
    static std::vector<bool> darkCells(std::size_t marker);
};

// The markers' middles in a picture of linear light, in its pixels. A cell of a marker must be
// three pixels wide. Error: which markers are not seen, or seen twice.
Result<std::array<glm::dvec2, 4>> findCornerMarkers(const GreyImage& light);

}  // namespace fantascope::vision
