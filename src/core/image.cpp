#include "core/image.h"

#include "core/file.h"

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
constexpr int kLargestSide = 16384;

// OpenCV's view of an image's own memory.
cv::Mat view(const GreyImage& image) {
    return {image.height(), image.width(), CV_32FC1, const_cast<float*>(image.pixels().data())};
}
cv::Mat view(const RgbaImage& image) {
    return {image.height(), image.width(), CV_8UC4, const_cast<Rgba8*>(image.pixels().data())};
}
cv::Mat view(const Rgba16Image& image) {
    return {image.height(), image.width(), CV_16UC4, const_cast<Rgba16*>(image.pixels().data())};
}

std::size_t byteAt(std::string_view bytes, std::size_t index) { return static_cast<unsigned char>(bytes[index]); }
// Big-endian, as in PNG and JPEG.
std::size_t wordAt(std::string_view bytes, std::size_t index) { return 256 * byteAt(bytes, index) + byteAt(bytes, index + 1); }

// The segments of a JPEG's head begin with 0xff, a marker and a length that counts itself.
constexpr std::size_t kMarker = 0xff, kStartOfScan = 0xda;

// Goes through these segments until `isLast(marker)`: where that one begins, or what follows the last of them. A thumbnail in one of them
// is a whole JPEG, with an end of its own.
template <class IsLast>
std::size_t jpegSegment(std::string_view bytes, IsLast isLast) {
    std::size_t at = 2;  // after the start of the image
    while (at + 4 <= bytes.size() && byteAt(bytes, at) == kMarker && !isLast(byteAt(bytes, at + 1)))
        at += 2 + wordAt(bytes, at + 2);
    return at;
}

// JPEG decoders fill what is missing with grey and call it a warning; a picture that ends early must be refused.
bool endsEarly(std::string_view bytes) {
    const auto isStartOfScan = [](std::size_t marker) { return marker == kStartOfScan; };
    if (bytes.starts_with("\xff\xd8")) return bytes.find("\xff\xd9", jpegSegment(bytes, isStartOfScan)) == std::string_view::npos;
    if (bytes.starts_with("\x89PNG")) return bytes.find("IEND") == std::string_view::npos;
    return false;
}

Result<cv::Mat> decode(const fs::path& path) {
    const std::string bytes = TRY(readFile(path));
    const auto refused = [&](std::string_view why) {
        return Error(fmt::format("{}: {}; save it again as a PNG, 8 or 16 bits a channel", path.string(), why));
    };
    if (bytes.empty()) return refused("the file is empty");
    if (endsEarly(bytes)) return refused("the picture is truncated");
    cv::Mat picture;
    try {
        picture = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data())),
                               cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {  // reported below like any other picture that cannot be decoded
        picture.release();
    }
    if (picture.empty()) return refused("not a picture that can be read, or a damaged one");
    if (std::max(picture.cols, picture.rows) > kLargestSide) return refused(fmt::format("larger than {} pixels", kLargestSide));
    if (picture.channels() == 2 || picture.channels() > 4) return refused(fmt::format("has {} channels", picture.channels()));
    if (!cv::checkRange(picture)) return refused("holds a value that is not a number");
    return picture;
}

// A row's channels, one after the other; whole numbers as shares of their type's largest. A row at a time, so that a picture is in memory
// once and not three times.
void rowOf(const cv::Mat& picture, int y, cv::Mat& row) {
    const int depth = picture.depth();
    picture.row(y).convertTo(row, CV_32F, depth == CV_8U ? 1.0 / 255 : depth == CV_16U ? 1.0 / 65535 : 1.0);
}

std::uint8_t toByte(float value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255.0f)); }

// `effort`: 1 is quick, 9 small.
Result<void> encode(const fs::path& path, const cv::Mat& picture, int effort) {
    FANTASCOPE_CHECK(!picture.empty(), "an empty image was to be written");
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, effort});
    return writeFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

template <class Pixel>
Result<void> encodeColours(const fs::path& path, const Image<Pixel>& image, int effort) {
    cv::Mat swapped;
    cv::cvtColor(view(image), swapped, cv::COLOR_RGBA2BGRA);
    return encode(path, swapped, effort);
}

template <class Pixel>
Image<Pixel> resizedImage(const Image<Pixel>& image, int width, int height) {
    Image<Pixel> result(width, height);
    cv::Mat target = view(result);
    const bool shrinks = width < image.width() || height < image.height();
    cv::resize(view(image), target, target.size(), 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    return result;
}

}  // namespace

float linearFromSrgb(float stored) { return stored <= 0.04045f ? stored / 12.92f : std::pow((stored + 0.055f) / 1.055f, 2.4f); }

float srgbFromLinear(float linear) {
    return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

Result<GreyImage> readGrey(const fs::path& path) {
    const cv::Mat picture = TRY(decode(path));
    GreyImage image(picture.cols, picture.rows);
    const int channels = picture.channels();
    cv::Mat row;
    for (int y = 0; y < picture.rows; ++y) {
        rowOf(picture, y, row);
        const float* pixel = row.ptr<float>();
        for (int x = 0; x < picture.cols; ++x, pixel += channels) {
            float value = channels == 1 ? pixel[0] : 0.114f * pixel[0] + 0.587f * pixel[1] + 0.299f * pixel[2];
            if (channels == 4) value *= pixel[3];
            image.at(x, y) = std::clamp(value, 0.0f, 1.0f);
        }
    }
    return image;
}

Result<RgbaImage> readRgba(const fs::path& path) {
    const cv::Mat picture = TRY(decode(path));
    RgbaImage image(picture.cols, picture.rows);
    const int channels = picture.channels();
    cv::Mat row;
    for (int y = 0; y < picture.rows; ++y) {
        rowOf(picture, y, row);
        const float* pixel = row.ptr<float>();
        for (int x = 0; x < picture.cols; ++x, pixel += channels) {
            const auto channel = [&](int index) { return toByte(pixel[channels == 1 ? 0 : index]); };
            image.at(x, y) = {channel(2), channel(1), channel(0), channels == 4 ? toByte(pixel[3]) : std::uint8_t{255}};
        }
    }
    return image;
}

Result<glm::ivec2> pictureSize(const fs::path& path) {
    constexpr std::size_t kHead = 1 << 20;  // bytes; what a camera writes before the size is less
    const auto head = readStart(path, kHead);
    if (!head) return head.error();
    const std::string_view bytes = *head;
    const auto sizeAt = [&](std::size_t width, std::size_t height) {
        return glm::ivec2(wordAt(bytes, width), wordAt(bytes, height));
    };
    if (bytes.starts_with("\x89PNG") && bytes.size() >= 24) {
        // 32 bits each; more than 16 are more than anybody reads.
        const bool isHuge = wordAt(bytes, 16) != 0 || wordAt(bytes, 20) != 0;
        return isHuge ? glm::ivec2(0xffff) : sizeAt(18, 22);
    }
    if (bytes.starts_with("\xff\xd8")) {
        // A frame's head: 0xc0 .. 0xcf but for three of them.
        const auto isFrame = [](std::size_t marker) {
            return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        };
        const std::size_t at = jpegSegment(bytes, isFrame);
        if (at + 9 <= bytes.size() && byteAt(bytes, at) == kMarker && isFrame(byteAt(bytes, at + 1)))
            return sizeAt(at + 7, at + 5);
    }
    return Error(fmt::format("{}: not a PNG or JPEG picture; save it again as a PNG", path.string()));
}

Result<void> writePng(const fs::path& path, const GreyImage& image) {
    Image<std::uint8_t> bytes(image.width(), image.height());
    std::transform(image.pixels().begin(), image.pixels().end(), bytes.pixels().begin(), toByte);
    return encode(path, {bytes.height(), bytes.width(), CV_8UC1, bytes.pixels().data()}, 6);
}

Result<void> writePng(const fs::path& path, const RgbaImage& image) { return encodeColours(path, image, 6); }
Result<void> writePng(const fs::path& path, const Rgba16Image& image) {
    return encodeColours(path, image, 3);
}  // they come by the thousand

std::vector<std::uint8_t> jpegOf(const RgbaImage& image, int quality) {
    FANTASCOPE_CHECK(!image.empty(), "an empty image has no file");
    cv::Mat swapped;
    cv::cvtColor(view(image), swapped, cv::COLOR_RGBA2BGR);
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", swapped, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    return bytes;
}

GreyImage resized(const GreyImage& image, int width, int height) { return resizedImage(image, width, height); }
RgbaImage resized(const RgbaImage& image, int width, int height) { return resizedImage(image, width, height); }

RgbaImage resizedLight(const RgbaImage& image, int width, int height) {
    static const cv::Mat kLight = [] {
        cv::Mat table(1, 256, CV_32FC4);
        for (int value = 0; value < 256; ++value) {
            const float stored = static_cast<float>(value) / 255, light = linearFromSrgb(stored);
            table.at<cv::Vec4f>(value) = {light, light, light, stored};
        }
        return table;
    }();
    cv::Mat light, resized;
    cv::LUT(view(image), kLight, light);
    const bool shrinks = width < image.width() || height < image.height();
    cv::resize(light, resized, {width, height}, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    RgbaImage result(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto stored = [](float value) { return static_cast<std::uint8_t>(std::lround(value * 255)); };
            const cv::Vec4f& pixel = resized.at<cv::Vec4f>(y, x);
            result.at(x, y) = {stored(srgbFromLinear(pixel[0])), stored(srgbFromLinear(pixel[1])),
                               stored(srgbFromLinear(pixel[2])), stored(pixel[3])};
        }
    return result;
}

GreyImage inverted(GreyImage image) {
    for (float& value : image.pixels()) value = 1 - value;
    return image;
}

GreyImage blurred(const GreyImage& image, double sigma) {
    GreyImage result(image.width(), image.height());
    cv::Mat target = view(result);
    cv::GaussianBlur(view(image), target, {}, sigma, sigma, cv::BORDER_REPLICATE);
    return result;
}

}  // namespace fantascope
