#include "pattern/search/goal.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace fantascope::pattern {
Goal::Goal(const GreyImage& guide, const GreyImage* surface) : width_(guide.width()), height_(guide.height()) {
    if (surface != nullptr) {
        FANTASCOPE_CHECK(surface->width() == width_ && surface->height() == height_, "guide and surface have one resolution");
        surface_ = *surface;
        for (float& light : surface_.pixels()) light = std::clamp(light, 0.0f, kMostLight);
    }
    const std::size_t columns = static_cast<std::size_t>(width_) + 1;
    sums_.assign(columns * (static_cast<std::size_t>(height_) + 1), 0);
    whiteCosts_.assign(columns * static_cast<std::size_t>(height_), 0);
    for (int y = 0; y < height_; ++y) {
        std::int64_t rowSum = 0;
        std::int64_t* above = sums_.data() + static_cast<std::size_t>(y) * columns;
        std::int32_t* costs = whiteCosts_.data() + static_cast<std::size_t>(y) * columns;
        for (int x = 0; x < width_; ++x) {
            const auto value = static_cast<std::int32_t>(std::lround(guide.at(x, y) * kWhite));
            rowSum += value;
            above[columns + static_cast<std::size_t>(x) + 1] = above[x + 1] + rowSum;
            const auto white = static_cast<std::int32_t>(std::lround(light(x, y) * kWhite));
            costs[x + 1] = costs[x] + std::abs(white - value) - value;  // |I - light| - |I - 0|
        }
    }
}

std::int64_t Goal::guideSum(const PixelRectangle& cell) const {
    const auto corner = [&](int x, int y) {
        return sums_[static_cast<std::size_t>(y) * (static_cast<std::size_t>(width_) + 1) + static_cast<std::size_t>(x)];
    };
    return corner(cell.end.x, cell.end.y) - corner(cell.begin.x, cell.end.y) - corner(cell.end.x, cell.begin.y) +
           corner(cell.begin.x, cell.begin.y);
}

double Goal::mean() const {
    const PixelRectangle all{{0, 0}, {width_, height_}};
    return static_cast<double>(guideSum(all)) / (static_cast<double>(kWhite) * static_cast<double>(all.area()));
}

double Goal::wantedCoverage() const {
    if (isEven()) return mean();
    double sum = 0;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x)
            if (const double wanted = value(x, y); wanted > 0) sum += std::min(1.0, wanted / std::max(light(x, y), 1e-6));
    return sum / (double(width_) * height_);
}

double Goal::bound() const {
    const std::size_t columns = static_cast<std::size_t>(width_) + 1;
    std::int64_t gain = 0;  // of covering exactly the pixels that are better lit
    for (int y = 0; y < height_; ++y) {
        const std::int32_t* costs = whiteCosts_.data() + static_cast<std::size_t>(y) * columns;
        for (int x = 0; x < width_; ++x) gain += std::min(0, costs[x + 1] - costs[x]);
    }
    return mean() + static_cast<double>(gain) / (static_cast<double>(kWhite) * width_ * height_);
}

double Goal::z(const Coverage& pattern) const {
    FANTASCOPE_CHECK(pattern.width() == width_ && pattern.height() == height_, "guide and pattern have one resolution");
    const std::size_t columns = static_cast<std::size_t>(width_) + 1;
    std::int64_t sum = guideSum({{0, 0}, {width_, height_}});  // all black
    pattern.forEachRun([&](int y, int begin, int end) {
        const std::int32_t* costs = whiteCosts_.data() + static_cast<std::size_t>(y) * columns;
        sum += costs[end] - costs[begin];
    });
    return static_cast<double>(sum) / (static_cast<double>(kWhite) * width_ * height_);
}

double Goal::differenceIndex(const PixelRectangle& cell, const Coverage& pattern) const {
    FANTASCOPE_CHECK(isEven(), "difference indices are those of an even surface");
    const std::int64_t difference = guideSum(cell) - kWhite * pattern.count(cell);
    return static_cast<double>(difference) / (static_cast<double>(kWhite) * static_cast<double>(cell.area()));
}

}  // namespace fantascope::pattern
