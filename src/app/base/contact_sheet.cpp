#include "app/base/contact_sheet.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace fantascope::app {

RgbaImage contactSheet(const std::vector<LabelledPicture>& pictures, int columns) {
    if (pictures.empty()) return {};
    constexpr int kMargin = 8, kLabelHeight = 24;
    constexpr Rgba8 kPaper{24, 24, 28, 255};
    const int width = pictures[0].image.width(), height = pictures[0].image.height();
    columns = std::min(columns, static_cast<int>(pictures.size()));
    const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
    const int stepX = width + kMargin, stepY = height + kLabelHeight + kMargin;
    RgbaImage sheet(columns * stepX + kMargin, rows * stepY + kMargin, kPaper);
    cv::Mat canvas(sheet.height(), sheet.width(), CV_8UC4, sheet.pixels().data());
    for (int i = 0; i < static_cast<int>(pictures.size()); ++i) {
        const LabelledPicture& picture = pictures[static_cast<std::size_t>(i)];
        const int left = kMargin + i % columns * stepX, top = kMargin + i / columns * stepY;
        const RgbaImage fitted = picture.image.width() == width && picture.image.height() == height
                                     ? picture.image
                                     : resized(picture.image, width, height);
        for (int y = 0; y < height; ++y) std::copy_n(fitted.row(y).begin(), width, sheet.row(top + y).begin() + left);
        cv::putText(canvas, picture.label, {left + 2, top + height + 17}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {225, 225, 225, 255}, 1,
                    cv::LINE_AA);
    }
    return sheet;
}

}  // namespace fantascope::app
