#pragma once

#include "core/check.h"
#include "core/result.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace fantascope {

// A picture in memory: row 0 at the top, rows without padding, the centre of pixel (x, y) at (x +
// 0.5, y + 0.5).
template <class Pixel>
class Image {
public:
    Image() = default;
    Image(int width, int height, Pixel fill = Pixel{}) : width_(width), height_(height) {
        FANTASCOPE_CHECK(width >= 0 && height >= 0, "an image has no negative size");
        pixels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill);
    }

    int width() const { return width_; }
    int height() const { return height_; }
    bool empty() const { return pixels_.empty(); }
    Pixel& at(int x, int y) { return pixels_[index(x, y)]; }
    const Pixel& at(int x, int y) const { return pixels_[index(x, y)]; }
    std::span<Pixel> row(int y) { return std::span(pixels_).subspan(index(0, y), static_cast<std::size_t>(width_)); }
    std::span<const Pixel> row(int y) const { return std::span(pixels_).subspan(index(0, y), static_cast<std::size_t>(width_)); }
    std::span<Pixel> pixels() { return pixels_; }
    std::span<const Pixel> pixels() const { return pixels_; }

    friend bool operator==(const Image&, const Image&) = default;

private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    int width_ = 0, height_ = 0;
    std::vector<Pixel> pixels_;
};

// Stored (not linear) 8-bit values, as in a PNG and as sent to a projector.
struct Rgba8 {
    std::uint8_t r = 0, g = 0, b = 0, a = 255;
    friend bool operator==(const Rgba8&, const Rgba8&) = default;
};

// The same in 16 bits.
struct Rgba16 {
    std::uint16_t r = 0, g = 0, b = 0, a = 65535;
    friend bool operator==(const Rgba16&, const Rgba16&) = default;
};

using RgbaImage = Image<Rgba8>;
using Rgba16Image = Image<Rgba16>;
using GreyImage = Image<float>;  // values 0..1; each use says whether stored or linear

// The sRGB transfer function (IEC 61966-2-1), 0..1 to 0..1.
float linearFromSrgb(float stored);
float srgbFromLinear(float linear);
// The linear light of each stored byte.
const std::array<float, 256>& linearOfBytes();

// Read PNG, JPEG, TIFF, BMP and WebP. Grey: stored values / the type's maximum, colours weighted as
// Rec. 601 luma; an alpha channel is composed over black. Error: names the file: missing, not a
// regular file, truncated, not a picture; or, before decoding, larger than 16384 in a dimension or
// more than 2^26 pixels.
Result<GreyImage> readGrey(const std::filesystem::path& path);
Result<RgbaImage> readRgba(const std::filesystem::path& path);
Result<Rgba16Image> readRgba16(const std::filesystem::path& path);
// Width and height of a picture, from its header only, so that a picture that is too large is
// refused without decoding. Error: names the file: missing, or no such picture.
Result<glm::ivec2> pictureSize(const std::filesystem::path& path);

// Write a PNG to a temporary file, then rename it. 8 bits per channel if the picture has no more.
// Alpha is straight (not premultiplied). The same picture gives the same bytes.
Result<void> writePng(const std::filesystem::path& path, const GreyImage& image);
Result<void> writePng(const std::filesystem::path& path, const RgbaImage& image);
Result<void> writePng(const std::filesystem::path& path, const Rgba16Image& image);

// The bytes of a JPEG file, without alpha. quality: 1 is small, 100 good. The same picture gives
// the same bytes.
std::vector<std::uint8_t> jpegOf(const RgbaImage& image, int quality);

// Area-averaging when shrinking, bilinear when growing. width, height > 0.
GreyImage resized(const GreyImage& image, int width, int height);
RgbaImage resized(const RgbaImage& image, int width, int height);
// The same for the light of stored sRGB values, as seen from far away: fine bright shapes do not
// darken.
RgbaImage resizedLight(const RgbaImage& image, int width, int height);

// 1 minus every value.
GreyImage inverted(GreyImage image);

// A separable Gaussian, in pixels; the border repeats the edge pixel. sigma > 0.
GreyImage blurred(const GreyImage& image, double sigma);

}  // namespace fantascope
