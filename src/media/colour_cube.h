#pragma once

#include "core/result.h"

#include <glm/vec3.hpp>

#include <filesystem>
#include <vector>

namespace fantascope {

// A three-dimensional look-up table of colours, as grading and calibration programs write it in a
// .cube file (Adobe, Cube LUT Specification 1.0). Colours are stored values, 0..1 for the range
// that is shown.
struct ColourCube {
    static constexpr int kMostSide = 256;

    int side = 0;                    // points in each direction, 2 .. kMostSide
    glm::vec3 low{0}, high{1};       // the colours that the first and the last point stand for
    std::vector<glm::vec3> colours;  // red runs fastest, then green

    // Error: file, line, and what is wrong: missing, cut off, one-dimensional, or not a table at
    // all.
    static Result<ColourCube> read(const std::filesystem::path& file);
    // Trilinear; colours beyond low and high are those at the edge.
    glm::vec3 at(glm::vec3 colour) const;
};

}  // namespace fantascope
