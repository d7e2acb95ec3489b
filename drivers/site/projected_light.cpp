#include "drivers/site/projected_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::site {
namespace {

constexpr int kLevels = 5;  // cells of up to 16 pixels: a camera that sees a whole output in 40 pixels

}  // namespace

ProjectedLight::ProjectedLight(glm::ivec2 size, double gamma, double blackLevel) : size_(size) {
    for (std::size_t stored = 0; stored < lightOf_.size(); ++stored)
        lightOf_[stored] = static_cast<float>(blackLevel + (1 - blackLevel) * std::pow(static_cast<double>(stored) / 255, gamma));
    for (int level = 0; level < kLevels; ++level, size = (size + 1) / 2) levels_.emplace_back(size.x, size.y);
}

void ProjectedLight::show(std::shared_ptr<const RgbaImage> frame) {
    if (frame == frame_) return;
    frame_ = std::move(frame);
    if (dark()) return;
    const bool fits = frame_->width() == size_.x && frame_->height() == size_.y;
    const RgbaImage stretched = fits ? RgbaImage() : resized(*frame_, size_.x, size_.y);
    const RgbaImage& stored = fits ? *frame_ : stretched;
    std::transform(stored.pixels().begin(), stored.pixels().end(), levels_[0].pixels().begin(),
                   [&](Rgba8 pixel) { return glm::vec4(lightOf_[pixel.r], lightOf_[pixel.g], lightOf_[pixel.b], 0); });
    for (std::size_t level = 1; level < levels_.size(); ++level) {
        const LightImage& fine = levels_[level - 1];
        LightImage& coarse = levels_[level];
        for (int y = 0; y < coarse.height(); ++y) {
            const auto above = fine.row(2 * y), below = fine.row(std::min(2 * y + 1, fine.height() - 1));
            const auto out = coarse.row(y);
            for (std::size_t x = 0; x < out.size(); ++x) {
                const std::size_t left = 2 * x, right = std::min(2 * x + 1, above.size() - 1);
                out[x] = 0.25f * (above[left] + above[right] + below[left] + below[right]);
            }
        }
    }
}

int ProjectedLight::levelFor(double footprint) {
    return std::clamp(static_cast<int>(std::lround(std::log2(std::max(footprint, 1.0)))), 0, kLevels - 1);
}

glm::vec4 ProjectedLight::at(int level, glm::vec2 pixel) const {
    const LightImage& cells = levels_[static_cast<std::size_t>(level)];
    const float scale = 1.0f / static_cast<float>(1 << level);
    const float x = std::clamp(pixel.x * scale - 0.5f, 0.0f, static_cast<float>(cells.width() - 1));
    const float y = std::clamp(pixel.y * scale - 0.5f, 0.0f, static_cast<float>(cells.height() - 1));
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, cells.width() - 1), y1 = std::min(y0 + 1, cells.height() - 1);
    const float u = x - static_cast<float>(x0), v = y - static_cast<float>(y0);
    const glm::vec4 top = cells.at(x0, y0) * (1 - u) + cells.at(x1, y0) * u;
    const glm::vec4 bottom = cells.at(x0, y1) * (1 - u) + cells.at(x1, y1) * u;
    return top * (1 - v) + bottom * v;
}

glm::vec4 ProjectedLight::mean() const {
    glm::vec4 sum(0);
    for (const glm::vec4& cell : levels_.back().pixels()) sum += cell;
    return sum / static_cast<float>(levels_.back().pixels().size());
}

}  // namespace fantascope::site
