#include "vision/watch/surface_texture.h"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace fantascope::vision {
namespace {

constexpr float kWellLit = 0.5f;        // least light within a cell's neighbourhood, for its texture to be seen
constexpr int kPictures = 100;          // a cell is known from so many pictures, and then stays as it is
constexpr int kTrusted = 10;            // after so many, a picture that differs much is not believed,
constexpr float kDiffersMuch = 0.4f;    // such as one with somebody in front
constexpr int kFilledEvery = 5;         // pictures
constexpr double kNearCells = 3;        // cells: standard deviation of what a guess is made from
constexpr double kSmooth = 12;          // cells: standard deviation of what is smoother than any texture
constexpr float kDarkest = 0.1f;        // of the mean: dark joints only amplify noise
constexpr double kCorrelatedCells = 4;  // so many neighbouring cells say as much as one

// Where a cell's neighbourhood is well lit: the light there.
std::optional<float> wellLit(const GreyImage& light, glm::dvec2 at) {
    const glm::ivec2 cell(glm::floor(at));
    if (cell.x < 1 || cell.y < 1 || cell.x + 2 > light.width() || cell.y + 2 > light.height()) return std::nullopt;
    for (int i = 0; i < 9; ++i)
        if (light.at(cell.x + i % 3 - 1, cell.y + i / 3 - 1) < kWellLit) return std::nullopt;
    return light.at(cell.x, cell.y);
}

// What is smooth in an image; places that are 0 do not count.
GreyImage smoothed(const GreyImage& image) {
    GreyImage weight(image.width(), image.height());
    for (std::size_t i = 0; i < image.pixels().size(); ++i) weight.pixels()[i] = image.pixels()[i] > 0 ? 1.0f : 0.0f;
    GreyImage smooth = blurred(image, kSmooth);
    weight = blurred(weight, kSmooth);
    for (std::size_t i = 0; i < image.pixels().size(); ++i)
        smooth.pixels()[i] = image.pixels()[i] > 0 ? smooth.pixels()[i] / weight.pixels()[i] : 0;
    return smooth;
}

}  // namespace

SurfaceTexture::SurfaceTexture(const GreyImage& full, bool isMeasured)
    : full_(full), isMeasured_(isMeasured), known_(full.width(), full.height()), count_(full.width(), full.height()) {
    if (isMeasured_) known_ = full_;
    fallOff_ = isMeasured_ ? smoothed(full_) : full_;
    forget();
}

void SurfaceTexture::forget() {
    if (!isMeasured_) {
        std::ranges::fill(known_.pixels(), 0.0f);
        std::ranges::fill(count_.pixels(), std::uint8_t{0});
    }
    fill();
}

// Known cells are what they are. Others have the mean of known ones nearby, as far as the fall-off
// allows.
void SurfaceTexture::fill() {
    sinceFilled_ = 0;
    GreyImage ratio(full_.width(), full_.height()), weight(full_.width(), full_.height());
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < full_.pixels().size(); ++i) {
        if (known_.pixels()[i] <= 0 || full_.pixels()[i] <= 0) continue;
        ratio.pixels()[i] = known_.pixels()[i] / full_.pixels()[i];
        weight.pixels()[i] = 1;
        sum += ratio.pixels()[i];
        ++count;
    }
    level_ = count > 0 ? sum / count : 1;
    const auto mean = static_cast<float>(level_);
    if (!isMeasured_) {
        ratio = blurred(ratio, kNearCells);
        weight = blurred(weight, kNearCells);
    }
    filled_ = full_;
    for (std::size_t i = 0; i < full_.pixels().size(); ++i) {
        constexpr float kFew = 0.02f;
        const float guess = weight.pixels()[i] > kFew ? ratio.pixels()[i] / weight.pixels()[i] : mean;
        filled_.pixels()[i] *= std::max(guess, kDarkest * mean);
        if (known_.pixels()[i] > 0) filled_.pixels()[i] = std::max(known_.pixels()[i], kDarkest * mean * full_.pixels()[i]);
    }
}

GreyImage SurfaceTexture::shareOf(const GreyImage& seen) const {
    GreyImage share(seen.width(), seen.height());
    for (std::size_t i = 0; i < share.pixels().size(); ++i)
        if (filled_.pixels()[i] > 0) share.pixels()[i] = seen.pixels()[i] / filled_.pixels()[i];
    return share;
}

void SurfaceTexture::learn(const GreyImage& seen, const GreyImage& light, const GreyImage& mask,
                           const Homography& shownFromPlace) {
    if (isMeasured_) return;
    for (int y = 0; y < seen.height(); ++y)
        for (int x = 0; x < seen.width(); ++x) {
            std::uint8_t& count = count_.at(x, y);
            if (mask.at(x, y) <= 0 || count >= kPictures) continue;
            const auto lit = wellLit(light, shownFromPlace({x + 0.5, y + 0.5}));
            if (!lit) continue;
            const float now = seen.at(x, y) / *lit;
            float& known = known_.at(x, y);
            if (now <= 0 || (count >= kTrusted && std::abs(now - known) > kDiffersMuch * known)) continue;
            ++count;
            known += (now - known) / static_cast<float>(count);
        }
    if (++sinceFilled_ >= kFilledEvery) fill();
}

double SurfaceTexture::stayed(const GreyImage& seen, const GreyImage& light, const GreyImage& mask,
                              const Homography& shownFromPlace, const Homography& moved, double gain) const {
    double sum = 0, squares = 0;
    for (int y = 0; y < seen.height(); ++y)
        for (int x = 0; x < seen.width(); ++x) {
            if (mask.at(x, y) <= 0 || known_.at(x, y) <= 0) continue;
            const glm::dvec2 middle(x + 0.5, y + 0.5);
            const glm::ivec2 from(glm::floor(moved(middle)));
            if (from.x < 0 || from.y < 0 || from.x >= seen.width() || from.y >= seen.height() || known_.at(from.x, from.y) <= 0)
                continue;
            const auto lit = wellLit(light, shownFromPlace(middle));
            if (!lit) continue;
            // All relative to the fall-off there.
            const double now = seen.at(x, y) / (gain * *lit * fallOff_.at(x, y)), here = known_.at(x, y) / fallOff_.at(x, y),
                         there = known_.at(from.x, from.y) / fallOff_.at(from.x, from.y);
            const double difference =
                std::clamp((now - there) * (now - there) - (now - here) * (now - here), -here * here, here * here);
            sum += difference;
            squares += difference * difference;
        }
    return squares > 0 ? sum / std::sqrt(kCorrelatedCells * squares) : 0;
}

}  // namespace fantascope::vision
