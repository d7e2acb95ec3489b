#include "theatre/pose_problem.h"

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

constexpr double kMargin = 1.0 / 3;  // of the silhouette's height, around it

void sampleContour(PoseTarget& target, std::size_t points) {
    target.area = static_cast<double>(target.mask.count());
    const ContourDisc disc(std::max(1.0, kDiscRadius / target.pixelsOf256));
    for (const glm::ivec2 point : sampled(outerContour(target.mask), points))
        target.contour.push_back(disc.at(target.mask, point));
}

}  // namespace

Result<PoseTarget> PoseTarget::from(const GreyImage& picture, const Stage& stage, double height, int rows) {
    BitMask whole(picture.width(), picture.height());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x)
            if (picture.at(x, y) > 0.5f) whole.fill(y, x, x + 1);
    if (whole.count() == 0) return Error("nothing in it is white; a silhouette is white on black");
    if (whole.count() == std::int64_t{picture.width()} * picture.height())
        return Error("all of it is white; a silhouette is white on black, with some black around");
    int left = picture.width(), right = 0;
    for (const glm::ivec2 pixel : outerContour(whole)) left = std::min(left, pixel.x), right = std::max(right, pixel.x + 1);
    int top = whole.rowsFrom(), bottom = whole.rowsTo();

    // One pixel of the mask is `step` pixels of the picture; it is sampled at the mask's pixels' centres by area.
    const double step = double(bottom - top) / rows, pixel = height / rows;
    const int margin = static_cast<int>(std::lround(kMargin * rows)),
              columns = static_cast<int>(std::ceil((right - left) / step));
    const int width = columns + 2 * margin, above = rows + margin;
    const double middle = 0.5 * (left + right);
    PoseTarget target{ScreenFrame(stage, stage.light.x - 0.5 * width * pixel, above * pixel, pixel, width, above),
                      BitMask(width, above),
                      0,
                      {},
                      256.0 / rows};
    for (int y = 0; y < above; ++y)
        for (int x = 0; x < width; ++x) {
            // 3 x 3 samples a pixel, or the picture's own pixels where they are fewer.
            int white = 0;
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i)
                    white += whole.at(static_cast<int>(std::floor(middle + (x + (i + 0.5) / 3 - 0.5 * width) * step)),
                                      static_cast<int>(std::floor(bottom - (above - y - (j + 0.5) / 3) * step)));
            if (white > 4) target.mask.fill(y, x, x + 1);
        }
    sampleContour(target, kContourPoints);
    return target;
}

PoseTarget PoseTarget::halved(const Stage& stage) const {
    const int width = (mask.width() + 1) / 2, height = (mask.height() + 1) / 2;
    const glm::dvec2 leftBottom = frame.metresAt({0, mask.height()});
    const double pixel = 2 * frame.pixel();
    PoseTarget target{ScreenFrame(stage, leftBottom.x, leftBottom.y + height * pixel, pixel, width, height),
                      BitMask(width, height),
                      0,
                      {},
                      2 * pixelsOf256};
    // From the floor up; a pixel is white if half of it is.
    const int cut = 2 * height - mask.height();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            int white = 0;
            for (int i = 0; i < 4; ++i) white += mask.at(2 * x + i % 2, 2 * y - cut + i / 2);
            if (white >= 2) target.mask.fill(y, x, x + 1);
        }
    sampleContour(target, contour.size() / 2);
    return target;
}

}  // namespace fantascope::theatre
