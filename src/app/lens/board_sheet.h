#pragma once

#include "core/result.h"
#include "plot/page.h"

#include <glm/vec2.hpp>

namespace fantascope::app {

enum class Paper { A4, A3 };

// The side of a square of the board on a sheet of paper, millimetres.
double squareMm(Paper paper);

// The lens board in the middle of a landscape sheet, with its name, its squares and what to measure
// in the margin. For Page::writeAsPaper().
plot::Page boardSheet(Paper paper);

// The lens board as a picture to be shown on a screen or by a projector, pixels: as large as it
// goes with whole pixels for its smallest parts, and the same words. For Page::write() as a PNG.
// Error: the picture is too small for the board.
Result<plot::Page> boardPicture(glm::ivec2 size);

}  // namespace fantascope::app
