#include "drivers/site/projected_light.h"

#include "drivers/site/optics.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::site {
namespace {

constexpr std::size_t kLevels = 5;  // cells of up to 16 pixels, enough for a camera that sees a whole output in 40 pixels

glm::ivec2 halved(glm::ivec2 cells) { return (cells + 1) / 2; }
bool canBeLookedInto(glm::ivec2 cells) { return std::min(cells.x, cells.y) >= ProjectedLight::kMinSide; }

}  // namespace

ProjectedLight::ProjectedLight(glm::ivec2 size, double gamma, double blackLevel, glm::vec3 white)
    : size_(size), white_(white, 0) {
    for (std::size_t stored = 0; stored < lightOf_.size(); ++stored)
        lightOf_[stored] = static_cast<float>(blackLevel + (1 - blackLevel) * std::pow(static_cast<double>(stored) / 255, gamma));
    FANTASCOPE_CHECK(canBeLookedInto(size), "a frame is at least kMinSide pixels each way");
    for (; levels_.size() < kLevels && canBeLookedInto(size); size = halved(size)) levels_.emplace_back(size.x, size.y);
}

void ProjectedLight::show(std::shared_ptr<const RgbaImage> frame, double blur, double level) {
    if (frame == frame_ && blur == blur_ && level == level_) return;
    frame_ = std::move(frame);
    blur_ = blur;
    level_ = level;
    if (dark()) return;
    const bool fits = frame_->width() == size_.x && frame_->height() == size_.y;
    const RgbaImage stretched = fits ? RgbaImage() : resized(*frame_, size_.x, size_.y);
    const RgbaImage& stored = fits ? *frame_ : stretched;
    std::transform(stored.pixels().begin(), stored.pixels().end(), levels_[0].pixels().begin(),
                   [&](Rgba8 pixel) { return glm::vec4(lightOf_[pixel.r], lightOf_[pixel.g], lightOf_[pixel.b], 0); });
    const glm::vec4 factor = static_cast<float>(level) * white_;
    if (factor != glm::vec4(1, 1, 1, 0))
        for (glm::vec4& pixel : levels_[0].pixels()) pixel *= factor;
    blurLight(levels_[0], blur);
    for (std::size_t i = 1; i < levels_.size(); ++i) {
        const LightImage& fine = levels_[i - 1];
        LightImage& coarse = levels_[i];
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

ProjectedLight::Place ProjectedLight::placeOf(glm::ivec2 size, glm::vec2 pixel, double footprint) {
    const auto wanted = static_cast<std::size_t>(std::lround(std::log2(std::max(footprint, 1.0))));
    Place place;
    while (place.level < std::min(wanted, kLevels - 1) && canBeLookedInto(halved(size))) {
        size = halved(size);
        ++place.level;
    }
    const glm::vec2 last = size - 1;
    const glm::vec2 at = glm::clamp(pixel / static_cast<float>(1 << place.level) - 0.5f, glm::vec2(0), last);
    const glm::vec2 corner = glm::min(glm::floor(at), last - 1.0f);
    place.corner =
        static_cast<std::uint32_t>(corner.y) * static_cast<std::uint32_t>(size.x) + static_cast<std::uint32_t>(corner.x);
    place.share = at - corner;
    return place;
}

glm::vec4 ProjectedLight::mean() const {
    glm::vec4 sum(0);
    for (const glm::vec4& cell : levels_.back().pixels()) sum += cell;
    return sum / static_cast<float>(levels_.back().pixels().size());
}

}  // namespace fantascope::site
