#pragma once

#include "core/check.h"
#include "core/result.h"

#include <glm/vec2.hpp>

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
using GreyImage = Image<float>;  // values 0..1; whether stored or linear is said where one is used

// The sRGB transfer function (IEC 61966-2-1), 0..1 to 0..1.
float linearFromSrgb(float stored);
float srgbFromLinear(float linear);

// Reads PNG, JPEG, TIFF, BMP and WebP. Grey: stored values / the type's maximum, colours weighted
// as Rec. 601 luma; an alpha channel is laid over black. Error: names the file: missing, no regular
// file, truncated, not a picture; or, before it is decoded, larger than 16384 in a dimension or
// more than 2^26 pixels.
Result<GreyImage> readGrey(const std::filesystem::path& path);
Result<RgbaImage> readRgba(const std::filesystem::path& path);
// Width and height of a picture, from its head alone: one that is too large need not be decoded to
// be refused. Error: names the file: missing, or no such picture.
Result<glm::ivec2> pictureSize(const std::filesystem::path& path);

// PNG, 8 bits a channel where the picture has no more, written aside and renamed. Alpha is straight
// (not premultiplied). The same picture gives the same bytes.
Result<void> writePng(const std::filesystem::path& path, const GreyImage& image);
Result<void> writePng(const std::filesystem::path& path, const RgbaImage& image);
Result<void> writePng(const std::filesystem::path& path, const Rgba16Image& image);

// The bytes of a JPEG file; alpha is left out. quality: 1 is small, 100 good. The same picture
// gives the same bytes.
std::vector<std::uint8_t> jpegOf(const RgbaImage& image, int quality);

// Area-averaging when it shrinks, bilinear when it grows. width, height > 0.
GreyImage resized(const GreyImage& image, int width, int height);
RgbaImage resized(const RgbaImage& image, int width, int height);
// The same of the light that stored sRGB values stand for, as an eye far away sees it: fine bright
// shapes do not darken.
RgbaImage resizedLight(const RgbaImage& image, int width, int height);

// Light for dark: 1 minus every value.
GreyImage inverted(GreyImage image);

// A separable Gaussian, in pixels; the border repeats the edge pixel. sigma > 0.
GreyImage blurred(const GreyImage& image, double sigma);

}  // namespace fantascope
