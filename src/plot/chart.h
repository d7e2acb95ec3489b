#pragma once

#include "plot/page.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::plot {

struct Axis {
    double from = 0, to = 1;  // from < to; of a logarithmic one > 0
    std::string label;        // with its unit
    bool logarithmic = false;
};

// Where an axis has its marks: round numbers, some `most` of them at most; powers of ten on a
// logarithmic one.
std::vector<double> ticks(const Axis& axis, int most);
// The smallest axis from 0 or below to 0 or above, with some room, that all values lie on.
Axis axisAround(std::span<const double> values, std::string label);

// Two axes in a rectangle of a page. Points off the axes are cut at the rectangle.
class Chart {
public:
    // Draws frame, marks and labels; these stand outside the rectangle, 60 points left of it and 40
    // below.
    Chart(Page& page, glm::dvec2 topLeft, glm::dvec2 bottomRight, Axis x, Axis y);

    void line(std::span<const glm::dvec2> points, const Stroke& stroke);
    void discs(std::span<const glm::dvec2> points, double radius, glm::dvec3 colour);
    void title(std::string_view text);
    // A sample of a line and what it stands for; one below the other from the top right.
    void legend(std::string_view text, const Stroke& stroke);

private:
    glm::dvec2 onPage(glm::dvec2 point) const;

    Page& page_;
    glm::dvec2 topLeft_, bottomRight_;
    Axis x_, y_;
    int legends_ = 0;
};

}  // namespace fantascope::plot
