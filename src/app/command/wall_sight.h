#pragma once

#include "core/result.h"
#include "plot/page.h"

#include <filesystem>
#include <string>

namespace fantascope::app {

// Which pictures of the site's camera to compare with what was wanted there.
struct WallRequest {
    std::filesystem::path site, guide;  // `guide`: a *.pattern.yaml, or a drawing
    std::string output;
    std::filesystem::path before;  // a picture to compare with; empty: none
    friend bool operator==(const WallRequest&, const WallRequest&) = default;
};

// plot::wallFigure() of a camera picture, by the comparison that gives z_camera. Error: what is
// missing or does not fit, and what to do.
Result<plot::Page> drawWall(const std::filesystem::path& picture, const WallRequest& request);

}  // namespace fantascope::app
