#pragma once

#include "media/image.h"

#include <string>
#include <vector>

namespace fantascope::app {

struct LabelledPicture {
    std::string label;  // ASCII; one line below the picture
    RgbaImage image;
};

// The pictures in a grid, each with its label, row by row from the top left. All pictures have the
// size of the first one. Empty if there are none.
RgbaImage contactSheet(const std::vector<LabelledPicture>& pictures, int columns = 2);

}  // namespace fantascope::app
