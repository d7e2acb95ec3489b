#include "vision/corner_markers.h"

#include <fmt/format.h>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

namespace fantascope::vision {
namespace {

// Cells of three pixels are decoded in a picture that is enlarged so many times.
constexpr int kEnlarged = 3;
constexpr double kBrightPart = 0.99;  // the picture is shown so that this share of it is not white

auto cornerDictionary() { return cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50); }

// As a camera would store it, with its bright places at white.
cv::Mat enlarged(const GreyImage& light) {
    std::vector<float> values(light.pixels().begin(), light.pixels().end());
    const auto bright = values.begin() + static_cast<std::ptrdiff_t>(kBrightPart * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, bright);
    const float white = std::max(*bright, 1e-6f);
    cv::Mat stored(light.height(), light.width(), CV_8UC1);
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width(); ++x)
            stored.at<std::uint8_t>(y, x) =
                static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(std::clamp(light.at(x, y) / white, 0.0f, 1.0f))));
    cv::Mat large;
    cv::resize(stored, large, {}, kEnlarged, kEnlarged, cv::INTER_CUBIC);
    return large;
}

// Where the diagonals of a marker meet.
glm::dvec2 middleOf(const std::vector<cv::Point2f>& corners) {
    const cv::Point2d a = corners[0], across = cv::Point2d(corners[2]) - a, b = corners[1], down = cv::Point2d(corners[3]) - b;
    const double share = (b - a).cross(down) / across.cross(down);
    const cv::Point2d middle = a + share * across;
    return glm::dvec2(middle.x, middle.y) / double(kEnlarged);
}

}  // namespace

std::vector<bool> CornerMarker::darkCells(std::size_t marker) {
    cv::Mat drawn;
    cornerDictionary()->drawMarker(static_cast<int>(marker), kCells, drawn, 1);
    std::vector<bool> dark;
    for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells; ++x) dark.push_back(drawn.at<std::uint8_t>(y, x) == 0);
    return dark;
}

Result<std::array<glm::dvec2, 4>> findCornerMarkers(const GreyImage& light) {
    const auto how = cv::aruco::DetectorParameters::create();
    how->adaptiveThreshWinSizeStep = 4;
    how->minMarkerPerimeterRate = 0.01;
    how->cornerRefinementMethod = cv::aruco::CORNER_REFINE_CONTOUR;
    std::vector<std::vector<cv::Point2f>> markers;
    std::vector<int> numbers;
    cv::aruco::detectMarkers(enlarged(light), cornerDictionary(), markers, numbers, how);
    std::array<std::optional<glm::dvec2>, 4> found;
    std::string missing;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const auto count = std::ranges::count(numbers, static_cast<int>(i));
        if (count > 1)
            return Error(fmt::format("the camera sees two markers of the {} corner; take one away", CornerMarker::kNames[i]));
        const auto at = std::ranges::find(numbers, static_cast<int>(i)) - numbers.begin();
        if (count == 1) found[i] = middleOf(markers[static_cast<std::size_t>(at)]);
        if (count == 0) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", CornerMarker::kNames[i]);
    }
    if (!missing.empty())
        return Error(fmt::format(
            "the camera does not see these markers: {}; each must lie in the outputs' light, unhidden, and be at least 18 of the "
            "camera's pixels wide",
            missing));
    return std::array{*found[0], *found[1], *found[2], *found[3]};
}

}  // namespace fantascope::vision
