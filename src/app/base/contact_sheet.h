#pragma once

#include "media/image.h"

#include <string>
#include <vector>

namespace fantascope::app {

struct LabelledPicture {
    std::string label;  // ASCII; one line below the picture
    RgbaImage image;
};

// The pictures in a grid, each with its label, in order from the top left; all pictures of the
// first one's size. Empty if there are none.
RgbaImage contactSheet(const std::vector<LabelledPicture>& pictures, int columns = 2);

}  // namespace fantascope::app
