#include "media/image.h"

#include "core/file.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string_view>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t kMaxSide = 16384, kMaxPixels = std::uint64_t{1} << 26;  // 8192 x 8192

// OpenCV's view of an image's memory.
cv::Mat view(const GreyImage& image) {
    return {image.height(), image.width(), CV_32FC1, const_cast<float*>(image.pixels().data())};
}
cv::Mat view(const RgbaImage& image) {
    return {image.height(), image.width(), CV_8UC4, const_cast<Rgba8*>(image.pixels().data())};
}
cv::Mat view(const Rgba16Image& image) {
    return {image.height(), image.width(), CV_16UC4, const_cast<Rgba16*>(image.pixels().data())};
}

// A picture's header. Pixels are counted before decoding: a file of two megabytes can hold a
// gigabyte of them.
struct Head {
    std::string_view bytes;

    bool has(std::size_t at, std::size_t count) const { return at <= bytes.size() && count <= bytes.size() - at; }
    bool begins(std::string_view with) const { return bytes.starts_with(with); }
    bool isPng() const { return begins("\x89PNG"); }
    bool isJpeg() const { return begins("\xff\xd8"); }
    bool isWebp() const { return begins("RIFF") && has(0, 12) && bytes.substr(8, 4) == "WEBP"; }
    bool isBmp() const { return begins("BM"); }
    bool isTiff() const { return begins({"II*\0", 4}) || begins({"MM\0*", 4}) || begins({"II+\0", 4}) || begins({"MM\0+", 4}); }
    bool isKnown() const { return isPng() || isJpeg() || isWebp() || isBmp() || isTiff(); }

    // An unsigned integer of `count` bytes; bytes beyond the end are 0.
    std::uint64_t little(std::size_t at, std::size_t count) const {
        std::uint64_t value = 0;
        for (std::size_t i = count; i-- > 0;) value = value << 8 | byteAt(at + i);
        return value;
    }
    std::uint64_t big(std::size_t at, std::size_t count) const {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < count; ++i) value = value << 8 | byteAt(at + i);
        return value;
    }
    std::size_t byteAt(std::size_t at) const { return has(at, 1) ? static_cast<unsigned char>(bytes[at]) : 0; }

    // Width and height; nothing if they are not in these bytes.
    using Size = glm::vec<2, std::uint64_t>;
    std::optional<Size> size() const;

    // The segments of a JPEG's header begin with 0xff, a marker and a length that includes itself.
    // Returns where the first segment with `isLast(marker)` begins, or the end of the last segment.
    // A thumbnail in a segment is a whole JPEG with its own end marker.
    static constexpr std::size_t kMarker = 0xff, kStartOfScan = 0xda;
    template <class IsLast>
    std::size_t jpegSegment(IsLast isLast) const {
        for (std::size_t at = 2;; at += 2 + big(at + 2, 2)) {                               // after the start of the image
            while (has(at, 2) && byteAt(at) == kMarker && byteAt(at + 1) == kMarker) ++at;  // a marker may be padded
            if (!has(at, 4) || byteAt(at) != kMarker || isLast(byteAt(at + 1))) return at;
        }
    }

private:
    std::optional<Size> jpegSize() const;
    std::optional<Size> webpSize() const;
    std::optional<Size> bmpSize() const;
    std::optional<Size> tiffSize() const;
};

std::optional<Head::Size> Head::jpegSize() const {
    // Markers of a frame header: 0xc0 .. 0xcf except three.
    const auto isFrame = [](std::size_t marker) {
        return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    };
    const std::size_t at = jpegSegment(isFrame);
    if (!has(at, 9) || byteAt(at) != kMarker || !isFrame(byteAt(at + 1))) return std::nullopt;
    return Size(big(at + 7, 2), big(at + 5, 2));
}

std::optional<Head::Size> Head::webpSize() const {
    constexpr std::size_t kChunk = 12, kData = 20;
    if (!has(kData, 10)) return std::nullopt;
    const std::string_view chunk = bytes.substr(kChunk, 4);
    if (chunk == "VP8 ") return Size(little(kData + 6, 2) & 0x3fff, little(kData + 8, 2) & 0x3fff);
    if (chunk == "VP8L") return Size((little(kData + 1, 4) & 0x3fff) + 1, (little(kData + 1, 4) >> 14 & 0x3fff) + 1);
    if (chunk == "VP8X") return Size(little(kData + 4, 3) + 1, little(kData + 7, 3) + 1);
    return std::nullopt;
}

std::optional<Head::Size> Head::bmpSize() const {
    constexpr std::size_t kLength = 14, kOld = 12;
    if (!has(0, 26)) return std::nullopt;
    if (little(kLength, 4) == kOld) return Size(little(18, 2), little(20, 2));
    const auto height = static_cast<std::int32_t>(little(22, 4));  // below 0: the top row comes first
    return Size(little(18, 4), static_cast<std::uint64_t>(std::abs(std::int64_t{height})));
}

// The size of the first picture (TIFF 6.0, section 2; BigTIFF with 8-byte offsets).
std::optional<Head::Size> Head::tiffSize() const {
    const auto number = [&](std::size_t at, std::size_t count) { return begins("I") ? little(at, count) : big(at, count); };
    const bool isBig = number(2, 2) == 43;
    const std::size_t place = isBig ? 8 : 4, counted = isBig ? 8 : 2, entry = isBig ? 20 : 12, value = isBig ? 12 : 8;
    const std::size_t directory = number(isBig ? 8 : 4, place);
    if (!has(directory, counted)) return std::nullopt;
    constexpr std::uint64_t kWidth = 256, kHeight = 257, kShort = 3;
    std::optional<std::uint64_t> width, height;
    std::size_t at = directory + counted;
    for (std::uint64_t left = number(directory, counted); left > 0 && has(at, entry); --left, at += entry) {
        const std::uint64_t tag = number(at, 2), found = number(at + value, number(at + 2, 2) == kShort ? 2 : place);
        if (tag == kWidth) width = found;
        if (tag == kHeight) height = found;
    }
    if (!width || !height) return std::nullopt;
    return Size(*width, *height);
}

std::optional<Head::Size> Head::size() const {
    if (isPng()) return has(16, 8) ? std::optional(Size(big(16, 4), big(20, 4))) : std::nullopt;
    return isJpeg() ? jpegSize() : isWebp() ? webpSize() : isBmp() ? bmpSize() : isTiff() ? tiffSize() : std::nullopt;
}

// JPEG decoders fill missing data with grey and only warn, but a truncated picture must be refused.
bool endsEarly(const Head& head) {
    const auto isStartOfScan = [](std::size_t marker) { return marker == Head::kStartOfScan; };
    if (head.isJpeg()) return head.bytes.find("\xff\xd9", head.jpegSegment(isStartOfScan)) == std::string_view::npos;
    return head.isPng() && head.bytes.find("IEND") == std::string_view::npos;
}

Result<cv::Mat> decode(const fs::path& path) {
    const auto refused = [&](std::string_view why) {
        return Error(fmt::format("{}: {}; save it again as a PNG, 8 or 16 bits a channel", path.string(), why));
    };
    constexpr std::string_view kNoPicture = "not a picture that can be read, or a damaged one";
    constexpr std::size_t kKind = 12;  // bytes that identify the format
    const auto kind = readStart(path, kKind);
    if (!kind) return kind.error();
    if (kind->empty()) return refused("the file is empty");
    if (!Head{*kind}.isKnown()) return refused(kNoPicture);
    const auto read = readFile(path, kMaxFileBytes);
    if (!read) return read.error();
    const std::string& bytes = *read;
    const Head head{bytes};
    if (endsEarly(head)) return refused("the picture is truncated");
    const auto size = head.size();
    if (!size) return refused(kNoPicture);
    if (std::max(size->x, size->y) > kMaxSide || size->x * size->y > kMaxPixels)
        return Error(
            fmt::format("{}: {} x {} pixels: a picture may not be larger than {} in a dimension, nor have more than {} million "
                        "pixels; make it smaller",
                        path.string(), size->x, size->y, kMaxSide, kMaxPixels / 1'000'000));
    cv::Mat picture;
    try {
        picture = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data())),
                               cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {  // reported below like any other undecodable picture
        picture.release();
    }
    if (picture.empty()) return refused(kNoPicture);
    if (picture.channels() == 2 || picture.channels() > 4) return refused(fmt::format("has {} channels", picture.channels()));
    if (!cv::checkRange(picture)) return refused("has a value that is not a number");
    return picture;
}

// A row's channels in sequence; integers are divided by their type's maximum. Row by row, so that a
// picture is in memory once, not three times.
void rowOf(const cv::Mat& picture, int y, cv::Mat& row) {
    const int depth = picture.depth();
    picture.row(y).convertTo(row, CV_32F, depth == CV_8U ? 1.0 / 255 : depth == CV_16U ? 1.0 / 65535 : 1.0);
}

// 0..1 as a stored value of the type, rounded to the nearest.
template <class Stored>
Stored toStored(float value) {
    constexpr float kMost = std::numeric_limits<Stored>::max();
    return static_cast<Stored>(std::lround(std::clamp(value, 0.0f, 1.0f) * kMost));
}

template <class Pixel>
Result<Image<Pixel>> readColours(const fs::path& path) {
    using Stored = decltype(Pixel::r);
    const cv::Mat picture = TRY(decode(path));
    Image<Pixel> image(picture.cols, picture.rows);
    const int channels = picture.channels();
    cv::Mat row;
    for (int y = 0; y < picture.rows; ++y) {
        rowOf(picture, y, row);
        const float* pixel = row.ptr<float>();
        for (int x = 0; x < picture.cols; ++x, pixel += channels) {
            const auto channel = [&](int index) { return toStored<Stored>(pixel[channels == 1 ? 0 : index]); };
            image.at(x, y) = {channel(2), channel(1), channel(0),
                              channels == 4 ? channel(3) : std::numeric_limits<Stored>::max()};
        }
    }
    return image;
}

// `effort`: 1 is fast, 9 small.
Result<void> encode(const fs::path& path, const cv::Mat& picture, int effort) {
    FANTASCOPE_CHECK(!picture.empty(), "an empty image cannot be written");
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

const std::array<float, 256>& linearOfBytes() {
    static const std::array<float, 256> linear = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = linearFromSrgb(static_cast<float>(i) / 255);
        return values;
    }();
    return linear;
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

Result<RgbaImage> readRgba(const fs::path& path) { return readColours<Rgba8>(path); }
Result<Rgba16Image> readRgba16(const fs::path& path) { return readColours<Rgba16>(path); }

Result<glm::ivec2> pictureSize(const fs::path& path) {
    constexpr std::size_t kHead = 1 << 20;  // bytes; more than a camera writes before the size
    const auto bytes = readStart(path, kHead);
    if (!bytes) return bytes.error();
    const auto size = Head{*bytes}.size();
    if (!size) return Error(fmt::format("{}: not a PNG or JPEG picture; save it again as a PNG", path.string()));
    return glm::ivec2(glm::min(*size, Head::Size(0xffff)));  // larger than any readable picture
}

Result<void> writePng(const fs::path& path, const GreyImage& image) {
    Image<std::uint8_t> bytes(image.width(), image.height());
    std::transform(image.pixels().begin(), image.pixels().end(), bytes.pixels().begin(), toStored<std::uint8_t>);
    return encode(path, {bytes.height(), bytes.width(), CV_8UC1, bytes.pixels().data()}, 6);
}

Result<void> writePng(const fs::path& path, const RgbaImage& image) { return encodeColours(path, image, 6); }
Result<void> writePng(const fs::path& path, const Rgba16Image& image) {
    return encodeColours(path, image, 3);
}  // written by the thousand

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
