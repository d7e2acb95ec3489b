#pragma once
// The figure of one output on the wall: what was wanted there, and what the camera saw.

#include "media/image.h"
#include "plot/page.h"

#include <optional>
#include <span>
#include <string>

namespace fantascope::plot {

// A camera's picture in the guide's frame. Values are stored ones, 0..1, but for `difference`.
struct WallSight {
    std::string name;  // of the camera's picture
    GreyImage wanted, seen;
    GreyImage difference;  // seen - wanted, -1..1
    GreyImage inSight;     // 0 where the camera does not see the output
    double z = 0;
    std::optional<double> tone;
};

// A row of four pictures for each camera picture: the guide drawing, what is wanted on the wall,
// what was seen, and their difference: red where there is too much light, blue where there is too
// little. Each row has its z and tone. `guide`: stored values, 0..1. `output`: its name.
Page wallFigure(const std::string& output, const GreyImage& guide, std::span<const WallSight> sights);

}  // namespace fantascope::plot
