#include "plot/edit_sheet.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fantascope::plot {
namespace {

constexpr double kTolerance = 0.05;  // pixels between a curve and its chords
constexpr double kBright = 1, kDim = 0.45;

}  // namespace

EditSheet::EditSheet(const EditView& edited)
    : view(edited),
      warp(view.projection.warp),
      part(warp.shape().part),
      wall(view.projection),
      sheet(wall.size()),
      unit(sheet.unit()),
      light(view.chosen ? kBright : kDim) {
    const std::array<glm::dvec2, 5> ring{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}};
    for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
        const auto side = straight(inPart(ring[i]), inPart(ring[i + 1]));
        outline.insert(outline.end(), side.begin(), side.end());
    }
    Box box{outline.front(), outline.front()};
    for (const glm::dvec2 point : outline) box = {glm::min(box.low, point), glm::max(box.high, point)};
    const Box visible{glm::clamp(box.low, sheet.all().low, sheet.all().high),
                      glm::clamp(box.high, sheet.all().low, sheet.all().high)};
    // A sliver of a picture is too small for texts.
    const glm::dvec2 share = visible.size() / sheet.all().size();
    seen = std::min(share.x, share.y) > 0.2 ? visible : sheet.all();
}

// Follows a curve by chords that are at most kTolerance off. `unitCanvas`: the curve, 0..1 along
// it. `pieces`: it is divided into so many parts before that.
std::vector<glm::dvec2> EditSheet::curve(const std::function<glm::dvec2(double)>& unitCanvas, int pieces) const {
    const auto at = [&](double along) { return onWall(unitCanvas(along)); };
    std::vector<glm::dvec2> points{at(0)};
    const auto reach = [&](const auto& self, double from, double to, glm::dvec2 end, int depth) -> void {
        const glm::dvec2 begin = points.back(), middle = at((from + to) / 2);
        if (depth == 0 || glm::distance(middle, (begin + end) / 2.0) < kTolerance) {
            points.push_back(middle);
            points.push_back(end);
            return;
        }
        self(self, from, (from + to) / 2, middle, depth - 1);
        self(self, (from + to) / 2, to, end, depth - 1);
    };
    for (int i = 0; i < pieces; ++i) reach(reach, double(i) / pieces, double(i + 1) / pieces, at(double(i + 1) / pieces), 8);
    return points;
}

std::vector<glm::dvec2> EditSheet::straight(glm::dvec2 from, glm::dvec2 to) const {
    // A line may have a kink at every border of the mesh's cells; in so many pieces, none has two
    // kinks.
    const glm::ivec2 cells = glm::max(warp.shape().mesh.points - 1, 1);
    return curve([&](double along) { return from + along * (to - from); }, 2 * std::max(cells.x, cells.y));
}

std::vector<glm::dvec2> EditSheet::circle(glm::dvec2 centre, double radius) const {
    return curve(
        [&](double along) {
            const double angle = 2 * std::numbers::pi * along;
            return centre + radius * glm::dvec2(std::cos(angle) / view.aspect, std::sin(angle));
        },
        32);
}

bool EditSheet::isInside(glm::dvec2 point) const {
    const glm::dvec2 size = sheet.all().high;
    return point.x >= 0 && point.y >= 0 && point.x <= size.x && point.y <= size.y;
}

double EditSheet::chosenReach() const { return std::max(3.0, 34 * unit); }

void EditSheet::pointAt(glm::dvec2 at, const std::string& label, double value, bool chosen) {
    const double size = (chosen ? 1.0 : 0.6) * chosenReach();
    const glm::dvec2 all = sheet.all().high, margin = glm::min(glm::dvec2(2 * sheet.thin()), all / 2.0);
    const glm::dvec2 tip = glm::clamp(at, margin, all - margin);
    const glm::dvec2 along = glm::normalize(at - tip), across(-along.y, along.x);
    const std::array<glm::dvec2, 3> shape{
        {tip - size * along + 0.45 * size * across, tip, tip - size * along - 0.45 * size * across}};
    sheet.add(shape);
    if (chosen) sheet.add(tip - 1.8 * size * along, tip);
    sheet.rimmedStroke((chosen ? 2 : 1) * sheet.thin(), value);
    labelBeside(tip - (chosen ? 1.8 : 1.0) * size * along, 0, label, chosen);
}

void EditSheet::labelBeside(glm::dvec2 at, double clear, const std::string& label, bool chosen) {
    if (label.empty()) return;
    const glm::dvec2 all = sheet.all().high;
    const double size = sheet.fontSize(label, 0.4 * all.x, std::max(8.0, (chosen ? 28 : 20) * unit));
    const glm::dvec2 half(sheet.textWidth(label, size) / 2, size / 2), away = half + clear + 0.3 * size;
    const glm::dvec2 side = glm::mix(glm::dvec2(1), glm::dvec2(-1), glm::greaterThan(at + away + half, all));
    sheet.text(label, glm::clamp(at + side * away, half, glm::max(half, all - half)), size, light, true);
}

}  // namespace fantascope::plot
