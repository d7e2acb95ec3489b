#include "vision/watch/wall_reflectance.h"

#include "core/median.h"

#include <glm/common.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace fantascope::vision {
namespace {

constexpr int kStride = 8, kWindow = 16;  // cells: between blocks, and across the window of one
constexpr int kLeastCells = kWindow * kWindow / 2;
constexpr double kTells = 0.05;             // the picture in a window must vary so much, as a share of full light
constexpr double kFound = 0.8;              // and the correlation with what is seen be so high
constexpr std::size_t kLeastBlocks = 12;    // of a picture that counts
constexpr std::size_t kLeastPictures = 12;  // in which a block must be measured
constexpr double kNear = 1.5;               // blocks: from how far others are guessed
constexpr float kFew = 0.02f;               // the least weight of a guess
constexpr std::array<double, 6> kSoft{0, 0.5, 0.8, 1.2, 1.8, 2.7};  // cells: how much the devices may blur

cv::Mat matOf(const GreyImage& image) {
    return {image.height(), image.width(), CV_32F, const_cast<float*>(image.pixels().data())};
}

// What a window says: the factor, and how well the picture is found in it.
struct Told {
    double factor = 0, correlation = 0;
};
Told tell(const LightMeter::Sight& sight, const cv::Mat& lit, glm::ivec2 from) {
    double count = 0, seen = 0, shown = 0, full = 0, seenSeen = 0, seenShown = 0, shownShown = 0;
    for (int y = std::max(0, from.y); y < std::min(from.y + kWindow, lit.rows); ++y)
        for (int x = std::max(0, from.x); x < std::min(from.x + kWindow, lit.cols); ++x) {
            if (sight.surface.at(x, y) <= 0 || sight.mask.at(x, y) <= 0) continue;
            const double s = sight.seen.at(x, y), p = lit.at<float>(y, x);
            ++count;
            seen += s, shown += p, full += sight.surface.at(x, y);
            seenSeen += s * s, seenShown += s * p, shownShown += p * p;
        }
    if (count < kLeastCells) return {};
    seenSeen -= seen * seen / count, seenShown -= seen * shown / count, shownShown -= shown * shown / count;
    if (shownShown / count < kTells * kTells * full * full / (count * count) || seenSeen <= 0) return {};
    return {seenShown / shownShown, seenShown / std::sqrt(seenSeen * shownShown)};
}

std::vector<Told> tellAll(const LightMeter::Sight& sight, const cv::Mat& lit, glm::ivec2 blocks) {
    std::vector<Told> told;
    const glm::ivec2 margin((kWindow - kStride) / 2);
    for (int y = 0; y < blocks.y; ++y)
        for (int x = 0; x < blocks.x; ++x) told.push_back(tell(sight, lit, glm::ivec2(x, y) * kStride - margin));
    return told;
}

}  // namespace

double WallChange::at(glm::dvec2 pixel) const {
    if (factor.empty()) return 1;
    const glm::dvec2 place = pixel / block - 0.5, corner = glm::floor(place), share = place - corner;
    const auto value = [&](double x, double y) {
        return double(factor.at(std::clamp(static_cast<int>(x), 0, factor.width() - 1),
                                std::clamp(static_cast<int>(y), 0, factor.height() - 1)));
    };
    return std::lerp(std::lerp(value(corner.x, corner.y), value(corner.x + 1, corner.y), share.x),
                     std::lerp(value(corner.x, corner.y + 1), value(corner.x + 1, corner.y + 1), share.x), share.y);
}

bool WallReflectance::add(const LightMeter::Sight& sight) {
    blocks_ = {(sight.seen.width() + kStride - 1) / kStride, (sight.seen.height() + kStride - 1) / kStride};
    const GreyImage placed = placedLight(sight.light, sight.shownFromPlace);
    const cv::Mat shown = matOf(placed), surface = matOf(sight.surface);
    // The blur at which the picture is found best: with too little, small shapes would seem weak.
    std::vector<Told> best;
    double highest = 0;
    for (const double sigma : kSoft) {
        cv::Mat soft = shown;
        if (sigma > 0) cv::GaussianBlur(shown, soft, {}, sigma, sigma, cv::BORDER_REPLICATE);
        std::vector<Told> told = tellAll(sight, soft.mul(surface), blocks_);
        double sum = 0;
        for (const Told& block : told) sum += block.correlation;
        if (sum > highest) highest = sum, best = std::move(told);
    }
    std::vector<double> factors;
    for (const Told& block : best)
        if (block.correlation > kFound) factors.push_back(block.factor);
    if (factors.size() < kLeastBlocks) return false;
    const double common = medianOf(std::move(factors));
    std::vector<float> picture;
    for (const Told& block : best)
        picture.push_back(block.correlation > kFound ? static_cast<float>(block.factor / common) : 0.0f);
    if (pictures_.size() >= static_cast<std::size_t>(kPictures)) pictures_.erase(pictures_.begin());
    pictures_.push_back(std::move(picture));
    return true;
}

WallChange WallReflectance::change(double cell) const {
    WallChange change{GreyImage(blocks_.x, blocks_.y, 1), GreyImage(blocks_.x, blocks_.y), kStride * cell, pictures()};
    GreyImage sum(blocks_.x, blocks_.y), weight(blocks_.x, blocks_.y);
    std::vector<double> factors, off;
    for (std::size_t block = 0; block < change.factor.pixels().size(); ++block) {
        factors.clear();
        for (const std::vector<float>& picture : pictures_)
            if (picture[block] > 0) factors.push_back(picture[block]);
        // Measured in few of them, something else was there in most.
        if (factors.size() < std::max(kLeastPictures, pictures_.size() / 2)) continue;
        const double middle = medianOf(factors);
        off.clear();
        for (const double factor : factors) off.push_back(std::abs(factor - middle));
        constexpr double kDeviation = 1.4826 * 1.2533;  // of the median, from the median deviation of one picture
        change.factor.pixels()[block] = sum.pixels()[block] = static_cast<float>(middle);
        change.sigma.pixels()[block] =
            static_cast<float>(std::max(1e-4, kDeviation * medianOf(off) / std::sqrt(static_cast<double>(factors.size()))));
        weight.pixels()[block] = 1;
    }
    const GreyImage near = blurred(sum, kNear), count = blurred(weight, kNear);
    for (std::size_t block = 0; block < change.factor.pixels().size(); ++block)
        if (weight.pixels()[block] <= 0 && count.pixels()[block] > kFew)
            change.factor.pixels()[block] = near.pixels()[block] / count.pixels()[block];
    return change;
}

}  // namespace fantascope::vision
