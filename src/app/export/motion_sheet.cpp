#include "app/export/motion_sheet.h"

#include "app/base/contact_sheet.h"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

constexpr int kCell = 288, kColumns = 6;  // the longer side, pixels; columns of cells
constexpr std::size_t kMaxFrames = 47;    // eight full rows together with the one at rest
const cv::Scalar kGrid(60, 110, 200, 255), kMoving(240, 120, 20, 255), kFixed(40, 120, 255, 255);

// A picture scaled to a cell, to draw on.
class Cell {
public:
    explicit Cell(const GreyImage& picture)
        : scale_(double(kCell) / std::max(picture.width(), picture.height())),
          picture_(opaque(resized(picture, std::max(1, static_cast<int>(std::lround(scale_ * picture.width()))),
                                  std::max(1, static_cast<int>(std::lround(scale_ * picture.height())))))) {}

    void line(glm::dvec2 from, glm::dvec2 to, const cv::Scalar& colour) {
        cv::line(canvas(), at(from), at(to), colour, 1, cv::LINE_AA, kShift);
    }
    void dot(glm::dvec2 place, const cv::Scalar& colour) {
        constexpr int kRadius = 4;
        cv::circle(canvas(), at(place), kRadius << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
    }
    RgbaImage picture() && { return std::move(picture_); }

private:
    static constexpr int kShift = 4;  // fractional bits of a coordinate
    cv::Mat canvas() { return {picture_.height(), picture_.width(), CV_8UC4, picture_.pixels().data()}; }
    cv::Point at(glm::dvec2 place) const {
        // OpenCV's pixel centres are at integers.
        const glm::dvec2 scaled = (place * scale_ - 0.5) * double(1 << kShift);
        return {static_cast<int>(std::lround(scaled.x)), static_cast<int>(std::lround(scaled.y))};
    }

    double scale_;
    RgbaImage picture_;
};

}  // namespace

GreyImage pictureOf(const theatre::TriangulatedSilhouette& silhouette, const DeformedFrame& frame, glm::ivec2 size) {
    return drawn(silhouette.outlineAt(frame.vertices), size.x, size.y);
}

RgbaImage opaque(const GreyImage& picture) {
    RgbaImage result(picture.width(), picture.height());
    std::transform(picture.pixels().begin(), picture.pixels().end(), result.pixels().begin(), [](float value) {
        const auto level = static_cast<std::uint8_t>(std::lround(255 * value));
        return Rgba8{level, level, level};
    });
    return result;
}

RgbaImage motionSheet(const theatre::TriangulatedSilhouette& silhouette, const theatre::HandleMotion& motion,
                      const DeformedFrame& rest, std::span<const DeformedFrame> frames, glm::ivec2 size) {
    const auto withHandles = [&](Cell cell, const DeformedFrame& frame) {
        for (std::size_t i = 0; i < frame.places.size(); ++i)
            cell.dot(frame.places[i], motion.handles[i].keys.empty() ? kFixed : kMoving);
        return std::move(cell).picture();
    };
    Cell first(pictureOf(silhouette, rest, size));
    for (const glm::uvec3& triangle : silhouette.rest.triangles)
        for (int corner = 0; corner < 3; ++corner)
            first.line(rest.vertices[triangle[corner]], rest.vertices[triangle[(corner + 1) % 3]], kGrid);
    std::vector<LabelledPicture> cells = {
        {fmt::format("at rest, {} triangles", silhouette.rest.triangles.size()), withHandles(std::move(first), rest)}};
    const std::size_t count = std::min(frames.size(), kMaxFrames);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t number = count == 1 ? 0 : i * (frames.size() - 1) / (count - 1);
        const DeformedFrame& frame = frames[number];
        cells.push_back({fmt::format("frame {}, {:.2f} s", number + 1, frame.time),
                         withHandles(Cell(pictureOf(silhouette, frame, size)), frame)});
    }
    return contactSheet(cells, kColumns);
}

}  // namespace fantascope::app
