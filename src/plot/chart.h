#pragma once

#include "plot/page.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::plot {

struct Axis {
    enum class Marks { Numbers, Lines, None };
    double from = 0, to = 1;  // from < to; on a logarithmic axis > 0
    std::string label{};      // with its unit
    bool logarithmic = false;
    Marks marks = Marks::Numbers;  // Lines: ticks without numbers
};

// An axis's tick values: round numbers, or powers of ten on a logarithmic axis. About `max` of them
// at most.
std::vector<double> ticks(const Axis& axis, int max);
// An axis that contains 0 and all values, with a margin.
Axis axisAround(std::span<const double> values, std::string label);

// A series with few points per column that looks the same when it is drawn: of all points of a
// column it keeps the first, the lowest, the highest and the last. `columns`: into how many columns
// from `from` to `to` the series is divided. The points are ordered by x.
std::vector<glm::dvec2> thinned(std::span<const glm::dvec2> points, double from, double to, int columns);

// Two axes in a rectangle of a page. The rectangle clips.
class Chart {
public:
    // Draws frame, ticks and labels. Labels need 60 points to the left of the rectangle and 40
    // below it.
    Chart(Page& page, glm::dvec2 topLeft, glm::dvec2 bottomRight, Axis x, Axis y);

    void line(std::span<const glm::dvec2> points, const Stroke& stroke);
    void discs(std::span<const glm::dvec2> points, double radius, glm::dvec3 colour);
    void box(glm::dvec2 low, glm::dvec2 high, glm::dvec3 colour);
    // Fills a polygon.
    void area(std::span<const glm::dvec2> outline, glm::dvec3 colour, double opacity);
    // Writes a text that begins a little to the right of a point, on a nearly white ground.
    void note(std::string_view text, glm::dvec2 at);
    void title(std::string_view text);
    // Adds a line to the legend at the top right: a sample of the stroke and its meaning.
    void legend(std::string_view text, const Stroke& stroke);

private:
    glm::dvec2 onPage(glm::dvec2 point) const;

    Page& page_;
    glm::dvec2 topLeft_, bottomRight_;
    Axis x_, y_;
    int legends_ = 0;
};

}  // namespace fantascope::plot
