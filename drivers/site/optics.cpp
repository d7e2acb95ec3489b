#include "drivers/site/optics.h"

#include <algorithm>
#include <cmath>

namespace fantascope::site {
namespace {

// One half of a Gaussian, from its middle on; the whole adds up to 1.
std::vector<float> gaussian(double sigma) {
    std::vector<double> weights;
    double sum = 0;
    for (int i = 0; i <= static_cast<int>(std::ceil(4 * sigma)); ++i) {
        weights.push_back(std::exp(-i * i / (2 * sigma * sigma)));
        sum += (i == 0 ? 1 : 2) * weights.back();
    }
    std::vector<float> half;
    for (const double weight : weights) half.push_back(static_cast<float>(weight / sum));
    return half;
}

// Rows first, then columns: a Gaussian is the product of both.
template <class Light>
void blur(Image<Light>& light, double sigma) {
    if (sigma <= 0 || light.empty()) return;
    const std::vector<float> half = gaussian(sigma);
    const int reach = static_cast<int>(half.size()) - 1;
    const auto weightAt = [&](int offset) { return half[static_cast<std::size_t>(std::abs(offset))]; };
    Image<Light> across(light.width(), light.height());
    std::vector<Light> wide(static_cast<std::size_t>(light.width() + 2 * reach));
    for (int y = 0; y < light.height(); ++y) {
        const auto row = light.row(y), out = across.row(y);
        std::fill_n(wide.begin(), reach, row.front());
        std::copy(row.begin(), row.end(), wide.begin() + reach);
        std::fill_n(wide.end() - reach, reach, row.back());
        for (int offset = -reach; offset <= reach; ++offset)
            for (std::size_t x = 0; x < out.size(); ++x)
                out[x] += weightAt(offset) * wide[x + static_cast<std::size_t>(reach + offset)];
    }
    for (int y = 0; y < light.height(); ++y) {
        const auto out = light.row(y);
        std::fill(out.begin(), out.end(), Light(0));
        for (int offset = -reach; offset <= reach; ++offset) {
            const auto row = across.row(std::clamp(y + offset, 0, light.height() - 1));
            for (std::size_t x = 0; x < out.size(); ++x) out[x] += weightAt(offset) * row[x];
        }
    }
}

}  // namespace

void blurLight(Image<glm::vec3>& light, double sigma) { blur(light, sigma); }
void blurLight(Image<glm::vec4>& light, double sigma) { blur(light, sigma); }

void vignette(Image<glm::vec3>& light, double loss) {
    if (loss <= 0) return;
    const double width = light.width(), height = light.height();
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width(); ++x) {
            const double across = 2 * x + 1 - width, down = 2 * y + 1 - height;
            light.at(x, y) *= static_cast<float>(1 - loss * (across * across + down * down) / (width * width + height * height));
        }
}

void coverPart(Image<glm::vec3>& light, glm::dvec2 low, glm::dvec2 high, glm::vec3 luminance) {
    const glm::dvec2 size(light.width(), light.height());
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width(); ++x) {
            const glm::dvec2 share = glm::dvec2(x + 0.5, y + 0.5) / size;
            if (low.x <= share.x && share.x < high.x && low.y <= share.y && share.y < high.y) light.at(x, y) = luminance;
        }
}

void veil(Image<glm::vec3>& light, double share) {
    if (share <= 0) return;
    glm::dvec3 sum(0.0);
    for (const glm::vec3& pixel : light.pixels()) sum += glm::dvec3(pixel);
    const glm::vec3 added = sum * (share / static_cast<double>(light.pixels().size()));
    for (glm::vec3& pixel : light.pixels()) pixel += added;
}

}  // namespace fantascope::site
