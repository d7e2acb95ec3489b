#include "plot/wall_figure.h"

#include "plot/palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fantascope::plot {
namespace {

constexpr double kWallMargin = 20, kPanelWidth = 380, kBetween = 14, kWallText = 13;  // points, as all sizes
constexpr double kWallHeader = 104, kRowTitle = 30, kBelowRow = 12, kWallKey = 54;
constexpr double kFullColour = 0.3;  // the difference that has the darkest colour
constexpr Rgba8 kOutOfSight{150, 150, 150, 255};

// `ofValue`: the colour of a pixel. Pixels whose cell is out of sight are grey.
template <class OfValue>
RgbaImage inColours(const GreyImage& values, const GreyImage& inSight, OfValue ofValue) {
    RgbaImage picture(values.width(), values.height(), kOutOfSight);
    for (int y = 0; y < values.height(); ++y)
        for (int x = 0; x < values.width(); ++x)
            if (inSight.at(x * inSight.width() / values.width(), y * inSight.height() / values.height()) > 0)
                picture.at(x, y) = stored(ofValue(values.at(x, y)));
    return picture;
}

glm::dvec3 wallGrey(double value) { return glm::dvec3(std::clamp(value, 0.0, 1.0)); }

// Too much light is red, so the scale's sign is turned.
glm::dvec3 ofDifference(double difference) { return diverging(-std::clamp(difference / kFullColour, -1.0, 1.0)); }

double panelLeft(int column) { return kWallMargin + column * (kPanelWidth + kBetween); }

void drawWallHeader(Page& page, const std::string& output) {
    struct Column {
        const char *name, *what;
    };
    constexpr std::array<Column, 4> kColumns{{{"guide", "the drawing"},
                                              {"wanted", "blurred as from afar, with intended fall-off"},
                                              {"seen", "by the camera; exposure fitted, other light removed"},
                                              {"difference", "both blurred; red: too bright, blue: too dark"}}};
    page.text(fmt::format("'{}' on the wall", output), {kWallMargin, 26}, kWallText + 4, Anchor::Left);
    for (int i = 0; i < 4; ++i) {
        const auto& [name, what] = kColumns[static_cast<std::size_t>(i)];
        page.text(name, {panelLeft(i), 62}, kWallText + 2, Anchor::Left);
        page.text(what, {panelLeft(i), 84}, kWallText, Anchor::Left);
    }
}

void drawWallKey(Page& page, double top, bool isSomethingHidden) {
    constexpr int kSteps = 200;
    RgbaImage colours(kSteps + 1, 1);
    for (int i = 0; i <= kSteps; ++i) colours.at(i, 0) = stored(ofDifference(kFullColour * (2.0 * i / kSteps - 1)));
    const double left = panelLeft(3) + 10, right = left + kPanelWidth - 20;
    page.picture(colours, {left, top}, {right, top + 14});
    page.frame({left, top}, {right, top + 14}, {});
    for (const double value : {-kFullColour, -kFullColour / 2, 0.0, kFullColour / 2, kFullColour})
        page.text(fmt::format("{:g}", value), {glm::mix(left, right, (value / kFullColour + 1) / 2), top + 26}, kWallText,
                  Anchor::Middle);
    if (isSomethingHidden)
        page.text("grey: the camera does not see it, or the output does not show it", {kWallMargin, top + 7}, kWallText,
                  Anchor::Left);
}

}  // namespace

Page wallFigure(const std::string& output, const GreyImage& guide, std::span<const WallSight> sights) {
    const double panelHeight = std::round(kPanelWidth * guide.height() / guide.width());
    const double rowHeight = kRowTitle + panelHeight + kBelowRow;
    Page page(static_cast<int>(panelLeft(4) - kBetween + kWallMargin),
              static_cast<int>(kWallHeader + static_cast<double>(sights.size()) * rowHeight + kWallKey));
    drawWallHeader(page, output);
    double top = kWallHeader;
    bool isSomethingHidden = false;
    for (const WallSight& sight : sights) {
        const std::string tone = sight.tone ? fmt::format("{:.4f}", *sight.tone) : "none";
        const std::string scores = fmt::format(":  z {:.4f}, tone {}", sight.z, tone);
        const std::string name = page.shortened(sight.name, kWallText + 1, panelLeft(3) - page.textWidth(scores, kWallText + 1));
        page.text(name + scores, {kWallMargin, top + kRowTitle / 2}, kWallText + 1, Anchor::Left);
        const RgbaImage pictures[] = {
            inColours(guide, GreyImage(1, 1, 1), wallGrey), inColours(sight.wanted, sight.inSight, wallGrey),
            inColours(sight.seen, sight.inSight, wallGrey), inColours(sight.difference, sight.inSight, ofDifference)};
        for (int i = 0; i < 4; ++i) {
            const glm::dvec2 corner(panelLeft(i), top + kRowTitle), end = corner + glm::dvec2(kPanelWidth, panelHeight);
            page.picture(pictures[i], corner, end);
            page.frame(corner, end, {});
        }
        const auto cells = sight.inSight.pixels();
        isSomethingHidden = isSomethingHidden || std::find(cells.begin(), cells.end(), 0.0f) != cells.end();
        top += rowHeight;
    }
    drawWallKey(page, top + 6, isSomethingHidden);
    return page;
}

}  // namespace fantascope::plot
