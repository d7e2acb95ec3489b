#include "app/base/drawing.h"

#include "media/outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

// Paper may be a little grey and ink a little worn. Shares of the picture's edge, of its pixels.
constexpr float kPaper = 0.8f, kInk = 0.4f;
constexpr double kEdgeOfPaper = 0.95, kMostlyPaper = 0.5, kLeastInk = 0.001;

// Twice the signed area within a ring.
double turnedArea(const std::vector<glm::dvec2>& ring) {
    double area = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
        area += a.x * b.y - b.x * a.y;
    }
    return area;
}

}  // namespace

Result<void> checkDrawn(const GreyImage& drawing, const std::filesystem::path& file) {
    const auto [least, most] = std::minmax_element(drawing.pixels().begin(), drawing.pixels().end());
    if (*most - *least >= 1.0f / 255) return {};
    return Error(fmt::format("{}: nothing is drawn, it is {} all over; draw light on black", file.string(),
                             *most < kInk     ? "black"
                             : *most > kPaper ? "white"
                                              : "one grey"));
}

bool isInkOnPaper(const GreyImage& drawing) {
    std::size_t paper = 0, ink = 0, edge = 0, paperAtEdge = 0;
    for (int y = 0; y < drawing.height(); ++y)
        for (int x = 0; x < drawing.width(); ++x) {
            const float value = drawing.at(x, y);
            paper += value > kPaper;
            ink += value < kInk;
            if (x > 0 && y > 0 && x + 1 < drawing.width() && y + 1 < drawing.height()) continue;
            ++edge;
            paperAtEdge += value > kPaper;
        }
    const auto all = static_cast<double>(drawing.pixels().size());
    return static_cast<double>(paperAtEdge) >= kEdgeOfPaper * static_cast<double>(edge) &&
           static_cast<double>(paper) >= kMostlyPaper * all && static_cast<double>(ink) >= kLeastInk * all;
}

std::string oddHolesIn(const GreyImage& silhouette) {
    const Outline borders = tracedBorders(silhouette);
    const std::vector<glm::dvec2>* largest = nullptr;
    double top = silhouette.height(), bottom = 0;
    for (const auto& ring : borders.rings) {
        if (largest == nullptr || std::abs(turnedArea(ring)) > std::abs(turnedArea(*largest))) largest = &ring;
        for (const glm::dvec2 point : ring) top = std::min(top, point.y), bottom = std::max(bottom, point.y);
    }
    std::size_t count = 0;
    glm::dvec2 first{0};
    const double narrowest = kNarrowest * (bottom - top);
    for (const auto& ring : borders.rings) {
        const double area = turnedArea(ring) / 2;
        if (area * turnedArea(*largest) > 0 || std::abs(area) >= narrowest * narrowest) continue;
        if (count++ == 0) first = ring.front();
    }
    if (count == 0) return "";
    return fmt::format(
        "it has {} of less than {:.0f} % of its height, at column {:.0f}, row {:.0f}{}: people leave no such gaps; fill {}, or "
        "draw "
        "{} larger",
        count == 1 ? "a hole" : fmt::format("{} holes", count), 100 * kNarrowest, first.x, first.y,
        count == 1 ? "" : " the first", count == 1 ? "it" : "them", count == 1 ? "it" : "them");
}

}  // namespace fantascope::app
