#pragma once

#include "media/image.h"

#include <filesystem>
#include <string>
#include <vector>

namespace fantascope {

// A video as a player sees it.
struct Video {
    std::string codec;
    double seconds = 0;          // how long it says that it lasts
    double framesPerSecond = 0;  // that it states
    std::vector<double> times;   // seconds, of each frame that can be decoded
    std::vector<Rgba16Image> frames;
};

// Decodes all of it; stops the program if it cannot be read.
Video readVideo(const std::filesystem::path& file);

}  // namespace fantascope
