#include "plot/wall_figure.h"

#include "plot/page.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace fantascope::plot {
namespace {

// 16 x 9 cells: the left half is wanted white; seen is white on the right. The last column is not
// seen.
WallSight mirroredSight() {
    WallSight sight{"camera-1.png", GreyImage(16, 9), GreyImage(48, 27), GreyImage(16, 9), GreyImage(16, 9, 1), 0.5, 0.4};
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 16; ++x) {
            sight.wanted.at(x, y) = x < 8 ? 1 : 0;
            sight.difference.at(x, y) = x < 8 ? -0.3f : 0.3f;
            if (x == 15) sight.inSight.at(x, y) = 0;
        }
    for (int y = 0; y < 27; ++y)
        for (int x = 24; x < 48; ++x) sight.seen.at(x, y) = 1;
    return sight;
}

RgbaImage drawnWall(const std::vector<WallSight>& sights) {
    const ScratchFolder folder;
    GreyImage guide(16, 9);
    for (int y = 0; y < 9; ++y) guide.at(4, y) = 1;
    EXPECT_TRUE(wallFigure("left", guide, sights).write(folder / "w.png"));
    return readRgba(folder / "w.png").value();
}

// A place of a panel of the first row, in shares of its width and height.
Rgba8 inPanel(const RgbaImage& page, int panel, double x, double y) {
    constexpr double kWidth = 380, kTop = 104 + 30;
    return page.at(static_cast<int>(20 + panel * (kWidth + 14) + x * kWidth), static_cast<int>(kTop + y * kWidth * 9 / 16));
}

TEST(WallFigure, shows_guide_wanted_seen_and_their_difference_side_by_side) {
    const RgbaImage page = drawnWall({mirroredSight()});
    const auto isWhite = [](Rgba8 p) { return p.r > 240 && p.g > 240 && p.b > 240; };
    const auto isBlack = [](Rgba8 p) { return p.r < 15 && p.g < 15 && p.b < 15; };
    EXPECT_TRUE(isWhite(inPanel(page, 0, 4.5 / 16, 0.5)));
    EXPECT_TRUE(isBlack(inPanel(page, 0, 0.1, 0.5)));
    EXPECT_TRUE(isWhite(inPanel(page, 1, 0.25, 0.5)));
    EXPECT_TRUE(isBlack(inPanel(page, 1, 0.75, 0.5)));
    EXPECT_TRUE(isBlack(inPanel(page, 2, 0.25, 0.5)));
    EXPECT_TRUE(isWhite(inPanel(page, 2, 0.75, 0.5)));
    const Rgba8 tooDark = inPanel(page, 3, 0.25, 0.5), tooBright = inPanel(page, 3, 0.75, 0.5);
    EXPECT_TRUE(tooDark.b > 100 && tooDark.r < 60) << "blue where light is missing";
    EXPECT_TRUE(tooBright.r > 100 && tooBright.b < 60) << "red where there is too much";
    for (const int panel : {1, 2, 3}) EXPECT_EQ(inPanel(page, panel, 15.6 / 16, 0.5), (Rgba8{150, 150, 150, 255})) << panel;
}

TEST(WallFigure, has_a_row_for_each_picture) {
    const int one = drawnWall({mirroredSight()}).height();
    const RgbaImage two = drawnWall({mirroredSight(), mirroredSight()});
    EXPECT_GT(two.height(), one + 380 * 9 / 16);
    const auto blue = std::count_if(two.pixels().begin(), two.pixels().end(), [](Rgba8 p) { return p.b > 100 && p.r < 60; });
    EXPECT_GT(blue, 2 * 380 * 200 * 45 / 100);
}

}  // namespace
}  // namespace fantascope::plot
