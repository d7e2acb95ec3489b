#include "drivers/site/texture.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::site {
namespace {

constexpr double kMostSpots = 16;  // along the long side; a view more grazing than that is averaged sideways, too

int wrapped(int index, int size) { return (index % size + size) % size; }

// How much of fine cell `index` lies in a coarse cell that reaches from `low` to `high`.
double overlap(int index, double low, double high) {
    return std::max(0.0, std::min(index + 1.0, high) - std::max<double>(index, low));
}

}  // namespace

glm::dvec3 Rectangle::normal() const { return glm::normalize(glm::cross(right, up)); }

glm::dvec2 Rectangle::placeOf(glm::dvec3 point) const {
    const glm::dvec3 across = glm::cross(right, up), offset = point - corner;
    const double area2 = glm::dot(across, across);
    return {glm::dot(glm::cross(offset, up), across) / area2, glm::dot(glm::cross(right, offset), across) / area2};
}

Texture::Texture(const RgbaImage& picture, const Rectangle& rectangle, std::optional<glm::dvec2> tile)
    : rectangle_(rectangle), repeats_(tile.has_value()) {
    FANTASCOPE_CHECK(!picture.empty(), "a texture has pixels");
    const glm::dvec2 edges(glm::length(rectangle.right), glm::length(rectangle.up)), size = tile.value_or(edges);
    tiles_ = edges / size;
    cellsPerMetre_ = std::max(picture.width() / size.x, picture.height() / size.y);
    Cells cells(picture.width(), picture.height());
    const auto linear = [](std::uint8_t stored) { return linearFromSrgb(static_cast<float>(stored) / 255); };
    std::transform(picture.pixels().begin(), picture.pixels().end(), cells.pixels().begin(),
                   [&](Rgba8 pixel) { return glm::vec3(linear(pixel.r), linear(pixel.g), linear(pixel.b)); });
    levels_.push_back(std::move(cells));
    while (levels_.back().width() > 1 || levels_.back().height() > 1) levels_.push_back(halved(levels_.back()));
}

// Each coarse cell is the mean of exactly what it covers, so that a picture with an odd number of
// pixels does not shift from level to level.
Texture::Cells Texture::halved(const Cells& fine) {
    Cells coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2);
    const glm::dvec2 ratio(static_cast<double>(fine.width()) / coarse.width(),
                           static_cast<double>(fine.height()) / coarse.height());
    for (int y = 0; y < coarse.height(); ++y)
        for (int x = 0; x < coarse.width(); ++x) {
            const glm::dvec2 low(x * ratio.x, y * ratio.y), high = low + ratio;
            glm::dvec3 sum(0.0);
            for (int v = static_cast<int>(low.y); v < fine.height() && v < high.y; ++v)
                for (int u = static_cast<int>(low.x); u < fine.width() && u < high.x; ++u)
                    sum += glm::dvec3(fine.at(u, v)) * (overlap(u, low.x, high.x) * overlap(v, low.y, high.y));
            coarse.at(x, y) = sum / (ratio.x * ratio.y);
        }
    return coarse;
}

glm::vec3 Texture::at(const Cells& cells, glm::dvec2 place) const {
    const glm::ivec2 size(cells.width(), cells.height());
    const glm::dvec2 inside = repeats_ ? place - glm::floor(place) : glm::clamp(place, glm::dvec2(0), glm::dvec2(1));
    const glm::dvec2 cell = glm::dvec2(inside.x, 1 - inside.y) * glm::dvec2(size) - 0.5;
    const glm::ivec2 low = glm::floor(cell);
    const glm::vec2 share = cell - glm::dvec2(low);
    const auto value = [&](int x, int y) {
        return repeats_ ? cells.at(wrapped(x, size.x), wrapped(y, size.y))
                        : cells.at(std::clamp(x, 0, size.x - 1), std::clamp(y, 0, size.y - 1));
    };
    return glm::mix(glm::mix(value(low.x, low.y), value(low.x + 1, low.y), share.x),
                    glm::mix(value(low.x, low.y + 1), value(low.x + 1, low.y + 1), share.x), share.y);
}

// A spot that is longer than wide, as on the ground before the camera, is a row of round spots.
glm::vec3 Texture::around(glm::dvec3 point, glm::dvec3 longSide, double width) const {
    const double length = std::max(glm::length(longSide), width);
    const double spots = std::clamp(std::ceil(length / std::max(width, 1e-9)), 1.0, kMostSpots);
    const double cells = std::max(1.0, length / spots * cellsPerMetre_);
    const auto level = std::min(static_cast<std::size_t>(std::lround(std::log2(cells))), levels_.size() - 1);
    glm::vec3 sum(0);
    for (int i = 0; i < static_cast<int>(spots); ++i)
        sum += at(levels_[level], rectangle_.placeOf(point + longSide * ((i + 0.5) / spots - 0.5)) * tiles_);
    return sum / static_cast<float>(spots);
}

}  // namespace fantascope::site
