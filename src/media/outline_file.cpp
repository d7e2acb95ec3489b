#include "media/outline_file.h"

#include "core/file.h"
#include "media/image.h"
#include "media/svg.h"

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace fantascope {
namespace {

namespace fs = std::filesystem;

// Pixels: pictures are scaled to this size before tracing. At most a few thousandths are lost.
constexpr int kTracedSide = 1024;
// Tolerance of the outline, as a share of the side. Every triangle costs time in each of a thousand
// copies.
constexpr double kTolerance = 0.003;
constexpr std::size_t kMaxPoints = 80, kMaxRings = 20;
// Pixels of the picture: without smoothing, the pixel edges of a small picture would become
// corners.
constexpr double kSmoothing = 0.5, kStairs = 0.35;
constexpr double kMinClear = 0.01;      // share of transparent pixels; fewer are the edge of a filled page
constexpr double kMinContrast = 0.1;    // between the region and the rest, 0..1
constexpr double kMinPart = 1.0 / 500;  // of the largest part's area

constexpr std::array<std::string_view, 8> kPictures = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp", ".svg"};

// How much of each pixel belongs to the region, 0..1, with the border at 1/2; nothing if the
// picture has one colour.
std::optional<cv::Mat> regionOf(const RgbaImage& picture) {
    const cv::Mat pixels(picture.height(), picture.width(), CV_8UC4, const_cast<Rgba8*>(picture.pixels().data()));
    cv::Mat alpha, region;
    cv::extractChannel(pixels, alpha, 3);
    if (cv::countNonZero(alpha < 128) > kMinClear * double(alpha.total())) {
        alpha.convertTo(region, CV_32F, 1.0 / 255);
        return region;
    }
    cv::Mat grey, light;
    cv::cvtColor(pixels, grey, cv::COLOR_RGBA2GRAY);
    cv::threshold(grey, light, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
    const int lightCount = cv::countNonZero(light);
    if (lightCount == 0 || lightCount == light.rows * light.cols) return std::nullopt;
    const double lightMean = cv::mean(grey, light)[0] / 255, darkMean = cv::mean(grey, ~light)[0] / 255;
    if (lightMean - darkMean < kMinContrast) return std::nullopt;
    // The background is the majority of the border.
    const double lightBorder = cv::mean(light.row(0))[0] + cv::mean(light.row(light.rows - 1))[0] + cv::mean(light.col(0))[0] +
                               cv::mean(light.col(light.cols - 1))[0];
    const double sign = lightBorder > 2 * 255 ? -1 : 1;
    grey.convertTo(region, CV_32F, sign / 255, 0.5 - sign * (lightMean + darkMean) / 2);
    return cv::Mat(cv::min(cv::max(region, 0), 1));
}

// The rings around the region, scaled to `side`, in shares of the side.
Outline traced(const cv::Mat& region, int side) {
    const int largest = std::max(region.cols, region.rows);
    const double scale = double(side) / largest;
    // A region that touches the picture's edge ends there.
    constexpr int kMargin = 3;
    cv::Mat smooth;
    cv::copyMakeBorder(region, smooth, kMargin, kMargin, kMargin, kMargin, cv::BORDER_CONSTANT, cv::Scalar(0));
    if (scale > 1) cv::GaussianBlur(smooth, smooth, {}, kSmoothing);
    cv::resize(smooth, smooth, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);

    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(cv::Mat(smooth >= 0.5), contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
    double largestArea = 0;
    for (const auto& contour : contours) largestArea = std::max(largestArea, cv::contourArea(contour));
    Outline outline;
    for (const auto& contour : contours) {
        if (contour.size() < 3 || cv::contourArea(contour) <= kMinPart * largestArea) continue;
        auto& ring = outline.rings.emplace_back();
        for (const cv::Point point : contour) ring.emplace_back(point.x / double(side), -point.y / double(side));
    }
    return outline;
}

}  // namespace

bool isOutlineFile(const fs::path& path) {
    return std::find(kPictures.begin(), kPictures.end(), endingOf(path)) != kPictures.end();
}

Result<Outline> readOutline(const fs::path& path) {
    const auto refused = [&](std::string_view why) { return Error(fmt::format("{}: {}", path.string(), why)); };
    const bool isSvg = endingOf(path) == ".svg";
    const RgbaImage picture = isSvg ? TRY(readSvg(path, kTracedSide)) : TRY(readRgba(path));
    auto region = regionOf(picture);
    if (!region) {
        if (!isSvg) return refused("is of one colour; draw the shape on a transparent ground, dark on light or light on dark");
        region = cv::Mat(picture.height(), picture.width(), CV_32F, cv::Scalar(1));  // a drawing that fills its box
    }
    const Outline rings = traced(*region, kTracedSide);
    if (rings.rings.size() > kMaxRings)
        return refused(
            fmt::format("is too intricate: it has {} parts and holes; the maximum is {}", rings.rings.size(), kMaxRings));
    const double pixel = 1.0 / std::max(picture.width(), picture.height());
    Outline outline = simplified(rings, std::max(kTolerance, kStairs * pixel), kMaxPoints);
    if (outline.rings.empty()) return refused("shows nothing that has an area; fill the shape, or draw it larger");
    return outline;
}

}  // namespace fantascope
