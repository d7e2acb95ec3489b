#pragma once
// Videos that tests make for themselves.

#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace fantascope {

// How a video is coded.
struct VideoCoding {
    std::string encoder = "libx264";  // libav's name; the container is known by the file's ending
    std::string pixels = "yuv420p";   // libav's name of the format
    glm::ivec2 size{64, 64};
    int rate = 25, rateDivisor = 1;  // frames a second: rate / rateDivisor
    int bFrames = 0;                 // in a row
    int keyEvery = 12;               // frames
    bool openGroups = false;         // frames may refer to both sides of a keyframe
    std::string matrix = "bt709";    // libav's names; "unknown": the file does not say
    std::string range = "tv";
};

// Writes a video: frame i shows pictureOf(i) and begins after begins[i] frame periods; the last one
// lasts one. The picture is converted by this function's own arithmetic, in the matrix and range of
// the coding ("unknown": bt709); an empty one gives zeros in a format of one plane. Stops the
// program if it cannot be made.
void writeVideo(const std::filesystem::path& file, const VideoCoding& coding, const std::vector<std::int64_t>& begins,
                const std::function<RgbaImage(int)>& pictureOf);
// The same of a steady rate.
void writeVideo(const std::filesystem::path& file, const VideoCoding& coding, int frames,
                const std::function<RgbaImage(int)>& pictureOf);

// A picture that carries a number of 16 bits as 4 x 4 blocks, light and dark, and how it is read
// again.
RgbaImage numbered(glm::ivec2 size, int number);
int numberOn(const RgbaImage& picture);
// The same with noise, which is large when coded, so that damage to a file is within frames.
RgbaImage noisy(glm::ivec2 size, int number);

// Overwrites the bytes between two shares of a file's length.
void damage(const std::filesystem::path& file, double from, double to);

}  // namespace fantascope
