#include "pattern/search/measure.h"
#include "pattern/search/silhouette.h"

#include "plot/figures.h"
#include "plot/palette.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace fantascope::plot {
namespace {

constexpr double kCell = 2;                    // side of a cell, in sides of a square with a shape's area
constexpr std::size_t kMaxInstanceCells = 50;  // more would hide the picture
constexpr double kText = 13;                   // points

// Per instance: the side of a square with its area on the canvas, in canvas heights.
std::vector<double> sidesOf(const pattern::ShapePattern& pattern) {
    std::vector<pattern::Silhouette> silhouettes;
    for (const pattern::ElementalShape& shape : pattern.shapes) silhouettes.emplace_back(shape.mesh);
    pattern::SilhouetteScanner scanner(pattern.width, pattern.height);
    std::vector<double> sides;
    for (const pattern::ShapeInstance& instance : pattern.instances) {
        double area = 0;  // pixels
        scanner.scan(silhouettes[instance.shape], {instance.centre, instance.size, instance.rotation},
                     [&](int, int begin, int end) { area += end - begin; });
        sides.push_back(std::sqrt(area) / pattern.height);
    }
    return sides;
}

// Draws the colour scale's legend, from -1 at the left to 1 at the right.
void drawKey(Page& page, glm::dvec2 topLeft, glm::dvec2 bottomRight) {
    constexpr int kSteps = 200;
    RgbaImage colours(kSteps + 1, 1);
    for (int i = 0; i <= kSteps; ++i) colours.at(i, 0) = stored(diverging(2.0 * i / kSteps - 1));
    page.picture(colours, topLeft, bottomRight);
    page.frame(topLeft, bottomRight, {});
    for (const double value : {-1.0, -0.5, 0.0, 0.5, 1.0})
        page.text(fmt::format("{:g}", value), {glm::mix(topLeft.x, bottomRight.x, (value + 1) / 2), bottomRight.y + kText}, kText,
                  Anchor::Middle);
    const double middle = (topLeft.y + bottomRight.y) / 2;
    page.text("only pattern", {topLeft.x - 10, middle}, kText, Anchor::Right);
    page.text("only guide", {bottomRight.x + 10, middle}, kText, Anchor::Left);
}

}  // namespace

RgbaImage differencePicture(const pattern::ShapePattern& pattern, const GreyImage& guide) {
    const GreyImage wanted = resized(guide, pattern.width, pattern.height),
                    drawn = drawWhiteOnBlack(pattern, pattern.width, pattern.height);
    RgbaImage picture(pattern.width, pattern.height);
    for (int y = 0; y < pattern.height; ++y)
        for (int x = 0; x < pattern.width; ++x) picture.at(x, y) = stored(diverging(double{wanted.at(x, y)} - drawn.at(x, y)));
    return picture;
}

Page differenceFigure(const pattern::ShapePattern& pattern, const GreyImage& guide) {
    constexpr Stroke kLattice{{0.36, 0.2, 0.08}, 0.8, 0.7}, kInstance{{0.93, 0.72, 0}, 1.6};
    constexpr double kMargin = 20, kBelow = 90, kWidth = 1200;
    const double height = kWidth / pattern.aspect();  // which is also the number of points per canvas height
    const glm::dvec2 origin(kMargin), end = origin + glm::dvec2(kWidth, height);
    Page page(static_cast<int>(kWidth + 2 * kMargin), static_cast<int>(std::lround(height + 2 * kMargin + kBelow)));
    page.picture(differencePicture(pattern, guide), origin, end);

    const std::vector<double> sides = sidesOf(pattern);
    page.clip(origin, end);
    if (!sides.empty()) {
        double mean = 0;
        for (const double side : sides) mean += side / static_cast<double>(sides.size());
        const double cell = std::max(kCell * mean, 2.0 / pattern.height) * height;
        for (double x = origin.x + cell; x < end.x; x += cell) page.line({x, origin.y}, {x, end.y}, kLattice);
        for (double y = origin.y + cell; y < end.y; y += cell) page.line({origin.x, y}, {end.x, y}, kLattice);
    }
    const std::size_t step = std::max<std::size_t>(1, sides.size() / kMaxInstanceCells);
    for (std::size_t i = 0; i < sides.size(); i += step) {
        const glm::dvec2 centre = origin + height * pattern.instances[i].centre, half(kCell / 2 * sides[i] * height);
        page.frame(centre - half, centre + half, kInstance);
    }
    page.endClip();
    page.frame(origin, end, {});

    const double key = end.y + 22, middle = kMargin + kWidth / 2;
    drawKey(page, {middle - 200, key}, {middle + 200, key + 16});
    page.text(
        fmt::format("difference guide - pattern for {}; brown: evaluation lattice; yellow: the cells of every {} instance of {}",
                    pattern.guide.filename().string(), step == 1 ? "" : fmt::format("{}th", step), sides.size()),
        {middle, key + 58}, kText, Anchor::Middle);
    return page;
}

}  // namespace fantascope::plot
