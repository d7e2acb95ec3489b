#include "render/source/penumbra.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace fantascope::render {
namespace {

// Finer painting makes no visible difference behind the blur.
constexpr int kLargestBlock = 4;

// The side of a filter with a radius of `radius` pixels.
int sideFor(double radius) { return 2 * std::max(0, static_cast<int>(std::ceil(radius - 0.5))) + 1; }

GreyImage divided(GreyImage filter, double sum) {
    for (float& value : filter.pixels()) value = static_cast<float>(value / sum);
    return filter;
}

// A picture of `width` pixels, divided into `count` equal parts, is centred on `side` pixels:
// [pixel][part] is the share of each part that lies in each pixel.
std::vector<std::vector<double>> overlaps(int side, double width, int count) {
    std::vector<std::vector<double>> all(static_cast<std::size_t>(side), std::vector<double>(static_cast<std::size_t>(count)));
    for (int pixel = 0; pixel < side; ++pixel)
        for (int part = 0; part < count; ++part) {
            const double scale = count / width, low = (pixel - side / 2.0 + width / 2) * scale, high = low + scale;
            all[static_cast<std::size_t>(pixel)][static_cast<std::size_t>(part)] =
                std::max(0.0, std::min<double>(high, part + 1) - std::max<double>(low, part));
        }
    return all;
}

}  // namespace

double penumbraWidth(double distance, double angle) { return distance * std::tan(angle); }

GreyImage discFilter(double diameter) {
    // A pixel is divided into so many strips; each strip's overlap with the disc is exact along the
    // strip.
    constexpr int kStrips = 64;
    const double radius = diameter / 2;
    const int side = sideFor(radius);
    if (side == 1) return GreyImage(1, 1, 1.0f);
    GreyImage disc(side, side);
    double sum = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            double area = 0;
            for (int strip = 0; strip < kStrips; ++strip) {
                const double height = y + (strip + 0.5) / kStrips - side / 2.0, left = x - side / 2.0;
                const double reach = std::sqrt(std::max(0.0, radius * radius - height * height));
                area += std::max(0.0, std::min(left + 1, reach) - std::max(left, -reach)) / kStrips;
            }
            disc.at(x, y) = static_cast<float>(area);
            sum += area;
        }
    return divided(std::move(disc), sum);
}

GreyImage pictureFilter(const GreyImage& light, double width) {
    const double height = width * light.height() / light.width();
    GreyImage filter(sideFor(width / 2), sideFor(height / 2));
    const auto across = overlaps(filter.width(), width, light.width()), down = overlaps(filter.height(), height, light.height());
    double sum = 0;
    std::vector<double> row(static_cast<std::size_t>(light.width()));
    for (int y = 0; y < filter.height(); ++y) {
        std::fill(row.begin(), row.end(), 0.0);
        for (int part = 0; part < light.height(); ++part) {
            const double share = down[static_cast<std::size_t>(y)][static_cast<std::size_t>(part)];
            if (share == 0) continue;
            for (int x = 0; x < light.width(); ++x)
                row[static_cast<std::size_t>(x)] += share * static_cast<double>(light.at(x, part));
        }
        for (int x = 0; x < filter.width(); ++x) {
            const std::vector<double>& shares = across[static_cast<std::size_t>(x)];
            const double value = std::inner_product(shares.begin(), shares.end(), row.begin(), 0.0);
            filter.at(x, y) = static_cast<float>(value);
            sum += value;
        }
    }
    FANTASCOPE_CHECK(sum > 0, "a filter is not all 0");
    return divided(std::move(filter), sum);
}

BlurGrid BlurGrid::forFilter(const ShadowFilter& filter, double aspect, double rows) {
    const double finest = 1 / rows;
    BlurGrid grid;
    grid.pitch = finest;
    while (filter.width / 2 / (2 * grid.pitch) >= (grid.block == 1 ? kMinRadius : 2 * kMinRadius)) {
        grid.pitch *= 2;
        grid.block = std::min(2 * grid.block, kLargestBlock);
    }
    grid.size = glm::ivec2(std::ceil(aspect / grid.pitch), std::ceil(1 / grid.pitch)) + 2;
    const double width = filter.width / grid.pitch;
    if (!filter.picture) {
        // A coarse grid blurs by itself: its pixels' area, the filter's pixels and the
        // interpolation between pixels add variances of 1/12, 1/12 and 1/6 square pixels. The disc
        // is made smaller to compensate; its variance is 1/16 of its squared diameter.
        const double coarse = grid.pitch > finest ? 16.0 / 3 : 0;
        grid.filter = discFilter(std::sqrt(std::max(width * width - coarse, 0.0)));
    } else {
        grid.filter = pictureFilter(*filter.picture, width);
    }
    return grid;
}

}  // namespace fantascope::render
