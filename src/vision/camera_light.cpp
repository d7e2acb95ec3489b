#include "vision/camera_light.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

namespace fantascope::vision {
namespace {

auto placeOf(glm::ivec2 pixel) { return std::tuple(pixel.y, pixel.x); }

}  // namespace

CameraLight::CameraLight(std::span<const double> response, std::span<const glm::ivec2> hotPixels) {
    if (!response.empty()) {
        FANTASCOPE_CHECK(response.size() >= 2, "a response has two ends");
        for (std::size_t stored = 0; stored < linear_.size(); ++stored) {
            const double at = static_cast<double>(stored) / 255 * static_cast<double>(response.size() - 1);
            const std::size_t low = std::min(static_cast<std::size_t>(at), response.size() - 2);
            linear_[stored] = static_cast<float>(std::lerp(response[low], response[low + 1], at - static_cast<double>(low)));
        }
    }
    std::vector<glm::ivec2> sorted(hotPixels.begin(), hotPixels.end());
    std::ranges::sort(sorted, {}, placeOf);
    const auto isHot = [&](glm::ivec2 pixel) { return std::ranges::binary_search(sorted, placeOf(pixel), {}, placeOf); };
    for (const glm::ivec2 pixel : sorted) {
        int beside = 1;
        while (pixel.x - beside >= 0 && isHot({pixel.x - beside, pixel.y})) ++beside;
        int after = 1;
        while (isHot({pixel.x + after, pixel.y})) ++after;
        hot_.emplace_back(pixel, pixel.x - beside >= 0 && beside <= after ? pixel.x - beside : pixel.x + after);
    }
}

glm::vec3 CameraLight::at(const RgbaImage& frame, int x, int y) const {
    x = std::clamp(x, 0, frame.width() - 1);
    y = std::clamp(y, 0, frame.height() - 1);
    if (!hot_.empty()) {
        const auto hot = std::ranges::lower_bound(hot_, std::tuple(y, x), {}, [](const auto& one) { return placeOf(one.first); });
        if (hot != hot_.end() && hot->first == glm::ivec2(x, y) && hot->second < frame.width()) x = hot->second;
    }
    const Rgba8& stored = frame.at(x, y);
    return {linear_[stored.r], linear_[stored.g], linear_[stored.b]};
}

void CameraLight::addTo(GreyImage& sum, const RgbaImage& frame) const {
    const auto lightOf = [&](const Rgba8& pixel) {
        const bool saturated = std::max({pixel.r, pixel.g, pixel.b}) == 255;
        return saturated ? 1 : (linear_[pixel.r] + linear_[pixel.g] + linear_[pixel.b]) / 3;
    };
    for (std::size_t i = 0; i < sum.pixels().size(); ++i) sum.pixels()[i] += lightOf(frame.pixels()[i]);
    for (const auto& [pixel, column] : hot_)
        if (pixel.y < frame.height() && std::max(pixel.x, column) < frame.width())
            sum.at(pixel.x, pixel.y) += lightOf(frame.at(column, pixel.y)) - lightOf(frame.at(pixel.x, pixel.y));
}

}  // namespace fantascope::vision
