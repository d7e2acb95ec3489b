#include "vision/watch/output_view.h"

#include "core/check.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace fantascope::vision {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr int kLeastCells = 24;     // across and down: fewer say too little
constexpr float kFaint = 0.05f;     // share of the strongest light that a cell needs
constexpr double kLargestStep = 4;  // between neighbouring camera pixels, of the usual step: more is an edge of the surface

// The four neighbouring camera pixels from (x, y) on: where the projector lights them.
std::optional<std::array<glm::vec2, 4>> quadAt(const ProjectorMap& map, int x, int y) {
    if (!map.isKnown(x, y) || !map.isKnown(x + 1, y) || !map.isKnown(x, y + 1) || !map.isKnown(x + 1, y + 1)) return std::nullopt;
    return std::array{map.at.at(x, y), map.at.at(x + 1, y), map.at.at(x + 1, y + 1), map.at.at(x, y + 1)};
}

float cross(glm::vec2 a, glm::vec2 b) { return a.x * b.y - a.y * b.x; }

// The median of the steps between neighbouring camera pixels, projector pixels; 0: none are known.
double usualStep(const ProjectorMap& map) {
    std::vector<float> steps;
    for (int y = 0; y + 1 < map.at.height(); ++y)
        for (int x = 0; x + 1 < map.at.width(); ++x)
            if (const auto quad = quadAt(map, x, y))
                steps.push_back(std::sqrt(std::abs(cross((*quad)[2] - (*quad)[0], (*quad)[3] - (*quad)[1])) / 2));
    if (steps.empty()) return 0;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

// Gives the cells whose middle lies in a triangle of projector pixels their place in the camera's
// picture, and their light.
struct Corner {
    glm::vec2 projector, camera;
    float light;
};
void fill(const std::array<Corner, 3>& corners, int cellSize, Image<glm::vec2>& camera, GreyImage& full) {
    const auto size = static_cast<float>(cellSize);
    const glm::vec2 a = corners[0].projector, b = corners[1].projector, c = corners[2].projector;
    const float area = cross(b - a, c - a);
    if (area == 0) return;
    const glm::vec2 low = glm::min(a, glm::min(b, c)) / size, high = glm::max(a, glm::max(b, c)) / size;
    for (int y = std::max(0, static_cast<int>(low.y - 0.5f)); y < camera.height() && static_cast<float>(y) + 0.5f <= high.y; ++y)
        for (int x = std::max(0, static_cast<int>(low.x - 0.5f)); x < camera.width() && static_cast<float>(x) + 0.5f <= high.x;
             ++x) {
            const glm::vec2 at = (glm::vec2(x, y) + 0.5f) * size;
            const float first = cross(b - at, c - at) / area, second = cross(c - at, a - at) / area, third = 1 - first - second;
            if (first < 0 || second < 0 || third < 0) continue;
            camera.at(x, y) = first * corners[0].camera + second * corners[1].camera + third * corners[2].camera;
            full.at(x, y) = first * corners[0].light + second * corners[1].light + third * corners[2].light;
        }
}

}  // namespace

ProjectorMap nominalMap(const NominalView& view) {
    const glm::ivec2 size = view.camera.size;
    ProjectorMap map{Image<glm::vec2>(size.x, size.y, glm::vec2(kUnknown)), GreyImage(size.x, size.y), 0, 0};
    float strongest = 0;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const auto point = view.surface.hitBy(view.camera.rayThrough({x + 0.5, y + 0.5}));
            const auto pixel = point ? view.projector.pixelFromWorld(*point) : std::nullopt;
            if (!pixel || !view.projector.inPicture(*pixel)) continue;
            map.at.at(x, y) = *pixel;
            map.light.at(x, y) = static_cast<float>(view.projector.pixelsPerArea(*point, view.surface.normal));
            strongest = std::max(strongest, map.light.at(x, y));
            ++map.lit;
        }
    map.known = map.lit;
    for (float& light : map.light.pixels()) light = strongest > 0 ? light / strongest : 0;
    return map;
}

std::optional<OutputView> OutputView::of(const ProjectorMap& map, glm::ivec2 projector, double gamma, int step) {
    const double usual = usualStep(map);
    if (usual <= 0) return std::nullopt;
    OutputView view;
    view.projector_ = projector;
    view.cellSize_ = std::max(1, static_cast<int>(std::lround(usual * step)));
    const int width = projector.x / view.cellSize_, height = projector.y / view.cellSize_;
    if (width < kLeastCells || height < kLeastCells) return std::nullopt;
    view.camera_ = Image<glm::vec2>(width, height, glm::vec2(kUnknown));
    view.full_ = GreyImage(width, height);
    for (int y = 0; y + 1 < map.at.height(); ++y)
        for (int x = 0; x + 1 < map.at.width(); ++x) {
            const auto quad = quadAt(map, x, y);
            if (!quad) continue;
            std::array<Corner, 4> corners;
            float longest = 0;
            for (int i = 0; i < 4; ++i) {
                const glm::ivec2 at(x + (i == 1 || i == 2), y + (i >= 2));
                corners[static_cast<std::size_t>(i)] = {(*quad)[static_cast<std::size_t>(i)], glm::vec2(at) + 0.5f,
                                                        map.light.at(at.x, at.y)};
                longest = std::max(
                    longest, glm::distance((*quad)[static_cast<std::size_t>(i)], (*quad)[static_cast<std::size_t>((i + 1) % 4)]));
            }
            if (longest > kLargestStep * usual) continue;
            fill({corners[0], corners[1], corners[2]}, view.cellSize_, view.camera_, view.full_);
            fill({corners[0], corners[2], corners[3]}, view.cellSize_, view.camera_, view.full_);
        }
    const float strongest = *std::ranges::max_element(view.full_.pixels());
    std::size_t seen = 0;
    for (float& light : view.full_.pixels()) {
        if (light < kFaint * strongest) light = 0;
        seen += light > 0;
    }
    if (seen < static_cast<std::size_t>(kLeastCells) * kLeastCells) return std::nullopt;
    for (std::size_t i = 0; i < view.light_.size(); ++i)
        view.light_[i] = static_cast<float>(std::pow(static_cast<double>(i) / 255, gamma) / 3);
    return view;
}

GreyImage OutputView::lightOf(const RgbaImage& frame) const {
    FANTASCOPE_CHECK(frame.width() == projector_.x && frame.height() == projector_.y, "a frame has its projector's size");
    GreyImage light(camera_.width(), camera_.height());
    const float share = 1 / static_cast<float>(cellSize_ * cellSize_);
    for (int y = 0; y < light.height(); ++y) {
        const auto cells = light.row(y);
        for (int row = y * cellSize_; row < (y + 1) * cellSize_; ++row) {
            const Rgba8* pixel = frame.row(row).data();
            for (float& cell : cells)
                for (int i = 0; i < cellSize_; ++i, ++pixel) cell += light_[pixel->r] + light_[pixel->g] + light_[pixel->b];
        }
        for (float& cell : cells) cell *= share;
    }
    return light;
}

}  // namespace fantascope::vision
