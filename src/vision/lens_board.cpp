#include "vision/lens_board.h"

#include "core/check.h"

#include <glm/geometric.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fantascope::vision {
namespace {

constexpr int kMarkerCells = 6;  // with its dark rim of one cell
constexpr int kBits = kMarkerCells - 2;

cv::Ptr<cv::aruco::CharucoBoard> board() {
    return cv::aruco::CharucoBoard::create(LensBoard::kSquares.x, LensBoard::kSquares.y, LensBoard::kCells, kMarkerCells,
                                           cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50));
}

// The library's point, in cells, from the board's top left.
glm::dvec2 placeOf(const cv::Point3f& point) { return {point.x, point.y}; }

// The marker's boxes: a dark one, and its white bits as runs in both directions, so that no seam
// shows between two of them.
void addMarker(glm::ivec2 low, const cv::Mat& bits, std::vector<LensBoard::Box>& boxes) {
    boxes.push_back({low, low + kMarkerCells, true});
    for (const bool across : {true, false})
        for (int line = 0; line < kBits; ++line)
            for (int from = 0, to = 0; from < kBits; from = to + 1) {
                const auto isWhite = [&](int i) {
                    return i < kBits && (across ? bits.at<std::uint8_t>(line, i) : bits.at<std::uint8_t>(i, line)) != 0;
                };
                for (to = from; isWhite(to);) ++to;
                if (to == from) continue;
                const glm::ivec2 first = across ? glm::ivec2(from, line) : glm::ivec2(line, from);
                const glm::ivec2 last = across ? glm::ivec2(to - 1, line) : glm::ivec2(line, to - 1);
                boxes.push_back({low + 1 + first, low + 2 + last, false});
            }
}

// Finds each corner to a fraction of a pixel, in a window that holds the four squares and no
// marker. The module's points count from the corner of the first pixel, as ours do; cornerSubPix()
// counts from its middle.
void refine(const cv::Mat& grey, const std::vector<int>& corners, std::vector<cv::Point2f>& pixels) {
    constexpr int kLeast = 2, kMost = 12;  // pixels to each side
    constexpr double kPart = 1.0 / LensBoard::kCells;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        double nearest = std::numeric_limits<double>::infinity();  // in pixels a square
        for (std::size_t j = 0; j < corners.size(); ++j) {
            const double squares = glm::distance(LensBoard::placeOf(corners[i]), LensBoard::placeOf(corners[j]));
            if (j != i) nearest = std::min(nearest, cv::norm(pixels[i] - pixels[j]) / squares);
        }
        const int side = std::clamp(static_cast<int>(std::lround(kPart * nearest)), kLeast, kMost);
        std::vector<cv::Point2f> one{pixels[i] - cv::Point2f(0.5f, 0.5f)};
        cv::cornerSubPix(grey, one, {side, side}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-3});
        pixels[i] = one[0] + cv::Point2f(0.5f, 0.5f);
    }
}

// Luma, as the library wants it.
cv::Mat greyOf(const RgbaImage& picture) {
    const cv::Mat colours(picture.height(), picture.width(), CV_8UC4, const_cast<Rgba8*>(picture.pixels().data()));
    cv::Mat grey;
    cv::cvtColor(colours, grey, cv::COLOR_RGBA2GRAY);
    return grey;
}

}  // namespace

std::vector<LensBoard::Box> LensBoard::boxes() {
    const auto drawn = board();
    std::vector<Box> boxes;
    std::array<bool, kSquares.x * kSquares.y> hasMarker{};
    std::vector<Box> markers;
    for (std::size_t i = 0; i < drawn->ids.size(); ++i) {
        const glm::ivec2 low(vision::placeOf(drawn->objPoints[i][0]));
        FANTASCOPE_CHECK(glm::ivec2(vision::placeOf(drawn->objPoints[i][2])) == low + kMarkerCells, "the board's y axis is down");
        hasMarker[static_cast<std::size_t>(low.y / kCells * kSquares.x + low.x / kCells)] = true;
        const cv::Mat code = drawn->dictionary->bytesList.row(drawn->ids[i]);
        addMarker(low, cv::aruco::Dictionary::getBitsFromByteList(code, kBits), markers);
    }
    for (int y = 0; y < kSquares.y; ++y)
        for (int x = 0; x < kSquares.x; ++x)
            if (!hasMarker[static_cast<std::size_t>(y * kSquares.x + x)])
                boxes.push_back({kCells * glm::ivec2(x, y), kCells * glm::ivec2(x + 1, y + 1), true});
    boxes.insert(boxes.end(), markers.begin(), markers.end());
    return boxes;
}

glm::dvec2 LensBoard::placeOf(int corner) {
    FANTASCOPE_CHECK(corner >= 0 && corner < kCorners, "the board has this corner");
    static const std::vector<cv::Point3f> kPlaces = board()->chessboardCorners;
    return vision::placeOf(kPlaces[static_cast<std::size_t>(corner)]) / static_cast<double>(kCells);
}

std::optional<BoardView> findBoard(const RgbaImage& picture) {
    const auto wanted = board();
    const cv::Mat grey = greyOf(picture);
    const auto how = cv::aruco::DetectorParameters::create();
    how->adaptiveThreshWinSizeStep = 4;
    std::vector<std::vector<cv::Point2f>> markers;
    std::vector<int> ids;
    cv::aruco::detectMarkers(grey, wanted->dictionary, markers, ids, how);
    if (ids.empty()) return std::nullopt;
    std::vector<cv::Point2f> pixels;
    std::vector<int> corners;
    constexpr int kMarkers = 1;  // beside a corner, of the two that there are
    cv::aruco::interpolateCornersCharuco(markers, ids, grey, wanted, pixels, corners, cv::noArray(), cv::noArray(), kMarkers);
    if (corners.size() < kFewestCorners || cv::aruco::testCharucoCornersCollinear(wanted, corners)) return std::nullopt;
    refine(grey, corners, pixels);
    BoardView view{{picture.width(), picture.height()}, {}};
    for (std::size_t i = 0; i < corners.size(); ++i) view.corners.push_back({corners[i], {pixels[i].x, pixels[i].y}});
    return view;
}

}  // namespace fantascope::vision
