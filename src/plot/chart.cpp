#include "plot/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::plot {
namespace {

constexpr double kText = 12;  // points
constexpr Stroke kFrame{{0.2, 0.2, 0.2}, 1};
constexpr Stroke kGrid{{0.88, 0.88, 0.88}, 1};

// The value's place on the axis, 0..1.
double along(const Axis& axis, double value) {
    if (axis.logarithmic) return std::log(value / axis.from) / std::log(axis.to / axis.from);
    return (value - axis.from) / (axis.to - axis.from);
}

// A tick's label. Powers of ten are written as such, since 0.0001 takes too much room.
std::string labelOf(const Axis& axis, double tick) {
    return axis.logarithmic && std::abs(std::log10(tick)) > 2.5 ? fmt::format("1e{}", std::lround(std::log10(tick)))
                                                                : fmt::format("{:.4g}", tick);
}

}  // namespace

std::vector<double> ticks(const Axis& axis, int max) {
    std::vector<double> marks;
    if (axis.logarithmic) {
        const int first = static_cast<int>(std::ceil(std::log10(axis.from) - 1e-9)),
                  last = static_cast<int>(std::floor(std::log10(axis.to) + 1e-9));
        const int step = std::max(1, (last - first + max) / std::max(1, max));
        for (int exponent = first; exponent <= last; exponent += step) marks.push_back(std::pow(10, exponent));
        return marks;
    }
    const double minStep = (axis.to - axis.from) / max, decade = std::pow(10, std::floor(std::log10(minStep)));
    double step = 10 * decade;
    for (const double round : {5, 2, 1})
        if (round * decade >= minStep) step = round * decade;
    for (double i = std::ceil(axis.from / step - 1e-9); i * step <= axis.to + 1e-9 * step; ++i)
        marks.push_back(i * step + 0.0);  // never -0
    return marks;
}

Axis axisAround(std::span<const double> values, std::string label) {
    double low = 0, high = 0;
    for (const double value : values) low = std::min(low, value), high = std::max(high, value);
    if (low == high) high = 1;
    const double room = 0.05 * (high - low);
    return {low < 0 ? low - room : 0, high > 0 ? high + room : 0, std::move(label)};
}

std::vector<glm::dvec2> thinned(std::span<const glm::dvec2> points, double from, double to, int columns) {
    const auto columnOf = [&](glm::dvec2 point) { return std::floor((point.x - from) / (to - from) * columns); };
    const auto lower = [](glm::dvec2 a, glm::dvec2 b) { return a.y < b.y; };
    std::vector<glm::dvec2> kept;
    for (std::size_t first = 0, end = 0; first < points.size(); first = end) {
        while (end < points.size() && columnOf(points[end]) == columnOf(points[first])) ++end;
        const auto column = points.subspan(first, end - first);
        const auto [lowest, highest] = std::minmax_element(column.begin(), column.end(), lower);
        const auto [one, other] = std::minmax(lowest, highest);
        auto last = column.end();
        for (const auto point : {column.begin(), one, other, column.end() - 1})
            if (point != last) kept.push_back(*point), last = point;
    }
    return kept;
}

Chart::Chart(Page& page, glm::dvec2 topLeft, glm::dvec2 bottomRight, Axis x, Axis y)
    : page_(page), topLeft_(topLeft), bottomRight_(bottomRight), x_(std::move(x)), y_(std::move(y)) {
    const glm::dvec2 size = bottomRight - topLeft;
    const auto ticksOf = [](const Axis& axis, double points) {
        return axis.marks == Axis::Marks::None ? std::vector<double>() : ticks(axis, std::max(2, static_cast<int>(points)));
    };
    for (const double tick : ticksOf(x_, size.x / 80)) {
        const double at = topLeft.x + along(x_, tick) * size.x;
        page.line({at, topLeft.y}, {at, bottomRight.y}, kGrid);
        if (x_.marks == Axis::Marks::Numbers)
            page.text(fmt::format("{:.4g}", tick), {at, bottomRight.y + kText}, kText, Anchor::Middle);
    }
    for (const double tick : ticksOf(y_, size.y / 40)) {
        const double at = bottomRight.y - along(y_, tick) * size.y;
        page.line({topLeft.x, at}, {bottomRight.x, at}, kGrid);
        if (y_.marks == Axis::Marks::Numbers) page.text(labelOf(y_, tick), {topLeft.x - 6, at}, kText, Anchor::Right);
    }
    page.frame(topLeft, bottomRight, kFrame);
    page.text(x_.label, {(topLeft.x + bottomRight.x) / 2, bottomRight.y + 2.4 * kText}, kText, Anchor::Middle);
    page.text(y_.label, {topLeft.x - 5 * kText, (topLeft.y + bottomRight.y) / 2}, kText, Anchor::Middle, true);
}

glm::dvec2 Chart::onPage(glm::dvec2 point) const {
    const glm::dvec2 size = bottomRight_ - topLeft_;
    return {topLeft_.x + along(x_, point.x) * size.x, bottomRight_.y - along(y_, point.y) * size.y};
}

void Chart::line(std::span<const glm::dvec2> points, const Stroke& stroke) {
    std::vector<glm::dvec2> placed;
    for (const glm::dvec2 point : points) placed.push_back(onPage(point));
    page_.clip(topLeft_, bottomRight_);
    page_.line(placed, stroke);
    page_.endClip();
}

void Chart::discs(std::span<const glm::dvec2> points, double radius, glm::dvec3 colour) {
    page_.clip(topLeft_, bottomRight_);
    for (const glm::dvec2 point : points) page_.disc(onPage(point), radius, colour);
    page_.endClip();
}

void Chart::box(glm::dvec2 low, glm::dvec2 high, glm::dvec3 colour) {
    const glm::dvec2 a = onPage(low), b = onPage(high);
    page_.clip(topLeft_, bottomRight_);
    page_.box({a.x, b.y}, {b.x, a.y}, colour);
    page_.endClip();
}

void Chart::area(std::span<const glm::dvec2> outline, glm::dvec3 colour, double opacity) {
    std::vector<glm::dvec2> placed;
    for (const glm::dvec2 point : outline) placed.push_back(onPage(point));
    page_.clip(topLeft_, bottomRight_);
    page_.area(placed, colour, opacity);
    page_.endClip();
}

void Chart::note(std::string_view text, glm::dvec2 at) {
    const glm::dvec2 begin = onPage(at) + glm::dvec2(kText / 2, 0);
    page_.cover(begin - glm::dvec2(2, 0.7 * kText), begin + glm::dvec2(page_.textWidth(text, kText) + 2, 0.7 * kText), 0.9);
    page_.text(text, begin, kText, Anchor::Left);
}

void Chart::title(std::string_view text) { page_.text(text, {topLeft_.x, topLeft_.y - kText}, kText + 2, Anchor::Left); }

void Chart::legend(std::string_view text, const Stroke& stroke) {
    const double y = topLeft_.y + (1 + 1.4 * legends_++) * kText, x = bottomRight_.x - 8;
    page_.cover({x - 36 - page_.textWidth(text, kText), y - 0.7 * kText}, {x + 4, y + 0.7 * kText}, 0.8);
    page_.line({x - 24, y}, {x, y}, {stroke.colour, std::max(stroke.width, 2.0), 1, stroke.dashed});
    page_.text(text, {x - 30, y}, kText, Anchor::Right);
}

}  // namespace fantascope::plot
