#pragma once

#include "core/result.h"

#include <glm/vec3.hpp>

#include <filesystem>
#include <vector>

namespace fantascope {

// A three-dimensional colour look-up table, as written by grading and calibration programs in a
// .cube file (Adobe, Cube LUT Specification 1.0). Colours are stored values, 0..1 for the displayed
// range.
struct ColourCube {
    static constexpr int kMaxSide = 256;

    int side = 0;                    // points in each direction, 2 .. kMaxSide
    glm::vec3 low{0}, high{1};       // the colours of the first and the last point
    std::vector<glm::vec3> colours;  // red varies fastest, then green

    // Error: file, line, and the fault: missing, cut off, one-dimensional, or not a table.
    static Result<ColourCube> read(const std::filesystem::path& file);
    // Trilinear; colours outside low and high are clamped.
    glm::vec3 at(glm::vec3 colour) const;
};

}  // namespace fantascope
