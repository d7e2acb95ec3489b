#include "plot/night_figure.h"

#include "core/file.h"
#include "plot/chart.h"
#include "plot/page.h"
#include "plot/palette.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace fantascope::plot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The figure's charts lie between these columns of the page.
constexpr int kLeft = 80, kRight = 1170;

RgbaImage drawn(const Night& night) {
    const ScratchFolder folder;
    EXPECT_TRUE(nightFigure(night).write(folder / "n.png"));
    return readRgba(folder / "n.png").value();
}

// Whether a pixel has an output's colour, or at least half of it, as at the edge of a line.
bool isOf(Rgba8 pixel, std::size_t output) {
    const glm::dvec3 ink = 255.0 - glm::dvec3(pixel.r, pixel.g, pixel.b), full = 255.0 - 255.0 * actorColour(output);
    const double share = glm::dot(ink, full) / glm::dot(full, full);
    return share > 0.45 && share < 1.1 && glm::length(ink - share * full) < 25;
}

// The rows in which a column has a colour, from the top, below the legend.
std::vector<int> rowsWith(const RgbaImage& page, int x, std::size_t output) {
    std::vector<int> rows;
    for (int y = 80; y < page.height(); ++y)
        if (isOf(page.at(x, y), output)) rows.push_back(y);
    return rows;
}

// The columns of a bar: those in which at least 8 pixels below each other have the colour.
std::vector<std::pair<int, int>> bars(const RgbaImage& page, int y, std::size_t output) {
    std::vector<std::pair<int, int>> found;
    for (int x = kLeft; x < kRight; ++x) {
        if (!isOf(page.at(x, y), output)) continue;
        if (found.empty() || found.back().second != x) found.emplace_back(x, x);
        found.back().second = x + 1;
    }
    return found;
}

int columnAt(double share) { return static_cast<int>(std::lround(kLeft + share * (kRight - kLeft))); }

TEST(Thinned, keeps_ends_and_extremes_of_each_column_in_their_order) {
    const std::vector<glm::dvec2> points{{0, 5}, {0.1, 1}, {0.2, 6}, {0.3, 9}, {0.4, 7}, {1, 2}, {1.5, 2}, {3, 4}};
    EXPECT_THAT(thinned(points, 0, 4, 4),
                ElementsAre(glm::dvec2(0, 5), glm::dvec2(0.1, 1), glm::dvec2(0.3, 9), glm::dvec2(0.4, 7), glm::dvec2(1, 2),
                            glm::dvec2(1.5, 2), glm::dvec2(3, 4)));
    EXPECT_TRUE(thinned({}, 0, 1, 10).empty());
}

// Eight hours, ten scores a second; one of them is bad.
TEST(NightFigure, shows_a_single_bad_score_of_a_long_night) {
    Night night{.seconds = 8 * 3600};
    night.outputs.push_back({.name = "left"});
    std::vector<glm::dvec2>& z = night.outputs[0].z;
    for (int i = 0; i < 288000; ++i) z.emplace_back(i / 10.0, 0.02);
    const int quiet = static_cast<int>(rowsWith(drawn(night), columnAt(0.25), 0).size());
    z[72000].y = 0.3;
    const RgbaImage page = drawn(night);
    int tallest = 0;
    for (int x = columnAt(0.25) - 1; x <= columnAt(0.25) + 1; ++x)
        tallest = std::max(tallest, static_cast<int>(rowsWith(page, x, 0).size()));
    EXPECT_LT(quiet, 5);
    EXPECT_GT(tallest, 100);
    EXPECT_LT(rowsWith(page, columnAt(0.75), 0).size(), 5u);
}

TEST(NightFigure, has_no_line_where_the_camera_saw_nothing) {
    Night night{.seconds = 100};
    night.outputs.push_back({.name = "left"});
    for (int i = 0; i < 1000; ++i)
        if (i < 300 || i >= 700) night.outputs[0].z.emplace_back(i / 10.0, 0.02);
    const RgbaImage page = drawn(night);
    EXPECT_FALSE(rowsWith(page, columnAt(0.2), 0).empty());
    EXPECT_TRUE(rowsWith(page, columnAt(0.5), 0).empty());
    EXPECT_FALSE(rowsWith(page, columnAt(0.8), 0).empty());
}

TEST(NightFigure, draws_each_output_in_its_colour_with_band_and_correction) {
    Night night{.seconds = 10};
    night.outputs = {{.name = "left"}, {.name = "right"}};
    for (int i = 0; i <= 100; ++i) {
        night.outputs[0].z.emplace_back(i / 10.0, 0.02), night.outputs[1].z.emplace_back(i / 10.0, 0.04);
        night.outputs[0].tone.emplace_back(i / 10.0, 0.04), night.outputs[1].tone.emplace_back(i / 10.0, 0.02);
    }
    const RgbaImage scores = drawn(night);
    const auto left = rowsWith(scores, columnAt(0.55), 0), right = rowsWith(scores, columnAt(0.55), 1);
    ASSERT_FALSE(left.empty() || right.empty());
    EXPECT_GT(left.front(), right.front()) << "the higher z lies higher";
    EXPECT_LT(left.back(), right.back()) << "the higher tone lies higher";

    Night watched{.seconds = 10};
    watched.outputs = {{.name = "left"}};
    for (int i = 0; i <= 10; ++i) watched.outputs[0].sights.push_back({double(i), 10, 4, 0});
    const RgbaImage still = drawn(watched);
    const auto line = rowsWith(still, columnAt(0.55), 0);
    ASSERT_FALSE(line.empty());
    const Rgba8 band = still.at(columnAt(0.55), line.front() - 12);
    EXPECT_TRUE(band.b < 215 && band.b > 150 && band.r > 240) << "no band beside the line";
    for (Night::Sight& sight : watched.outputs[0].sights) sight.moved = 5;
    const auto isDark = [](Rgba8 p) { return p.r > 110 && p.r < 160 && p.g > 70 && p.g < 110 && p.b < 40; };
    const auto count = [&](const RgbaImage& page) { return std::count_if(page.pixels().begin(), page.pixels().end(), isDark); };
    EXPECT_LT(count(still), 20);
    EXPECT_GT(count(drawn(watched)), 300) << "no dashed line";
}

TEST(NightFigure, has_a_bar_for_each_cause_and_fault_from_its_beginning_to_its_end) {
    constexpr std::size_t kFault = 6;
    Night night{.seconds = 100};
    night.outputs = {{.name = "left"}, {.name = "right"}};
    night.causes = {{"right", "out of place", 20, 30.0}, {"right", "out of place", 60, std::nullopt}};
    night.faults = {{"camera", "unplugged", 40, 50.0}};
    const RgbaImage page = drawn(night);
    const auto yOf = [&](double share, std::size_t colour) { return rowsWith(page, columnAt(share), colour); };
    const auto cause = yOf(0.25, 1), fault = yOf(0.45, kFault);
    ASSERT_GT(cause.size(), 5u);
    ASSERT_GT(fault.size(), 5u);
    using Bars = std::vector<std::pair<int, int>>;
    EXPECT_EQ(bars(page, cause[3], 1), (Bars{{columnAt(0.2), columnAt(0.3)}, {columnAt(0.6), kRight}}));
    EXPECT_EQ(bars(page, fault[3], kFault), (Bars{{columnAt(0.4), columnAt(0.5)}}));
    EXPECT_GT(fault.front(), cause.back()) << "causes stand above faults";
    EXPECT_TRUE(yOf(0.25, 0).empty()) << "the bar has its output's colour";
}

// Each has a row of its own.
TEST(NightFigure, has_a_bar_for_what_was_done) {
    Night night{.seconds = 100};
    const int bare = drawn(night).height();
    night.actions = {{"drawing: the pattern was fitted to the wall", 40, 40}, {"relays were switched off", 60, std::nullopt}};
    const RgbaImage page = drawn(night);
    EXPECT_EQ(drawn({.seconds = 100, .actions = {night.actions[0]}}).height(), bare);
    EXPECT_EQ(page.height() - bare, 32);
    const auto isGreen = [](Rgba8 p) { return p.g > p.r + 30 && p.g > p.b + 30; };
    const auto greens = [&](int x) {
        int count = 0;
        for (int y = 80; y < page.height(); ++y) count += isGreen(page.at(x, y)) ? 1 : 0;
        return count;
    };
    EXPECT_GT(greens(columnAt(0.4) + 1), 5);
    EXPECT_EQ(greens(columnAt(0.5)), 0);
    EXPECT_GT(greens(columnAt(0.6) + 2), 5);
    EXPECT_GT(greens(kRight - 2), 5);
}

// The rows in which a column is dark, in the chart whose upper edge is at `top`.
std::vector<int> darkRows(const RgbaImage& page, int x, int top) {
    std::vector<int> rows;
    for (int y = top + 3; y < top + 167; ++y)
        if (page.at(x, y).r < 128 && page.at(x, y).b < 128) rows.push_back(y);
    return rows;
}

TEST(NightFigure, shows_the_other_light_and_what_the_lamps_are_given) {
    Night night{.seconds = 100};
    for (int i = 0; i <= 100; ++i) {
        const double ambient = i < 50 ? 0.02 : 0.1;
        night.otherLight.push_back({double(i), 0.4 * ambient, ambient, i < 50 ? 1 : 0.3});
    }
    const RgbaImage page = drawn(night);
    constexpr int kFirst = 74 + 26 + 18, kSecond = kFirst + 170 + 8 + 26;
    const auto usual = darkRows(page, columnAt(0.255), kFirst), risen = darkRows(page, columnAt(0.755), kFirst);
    ASSERT_FALSE(usual.empty() || risen.empty());
    EXPECT_GT(usual.front(), risen.back()) << "more light lies higher";
    const auto full = darkRows(page, columnAt(0.255), kSecond), dimmed = darkRows(page, columnAt(0.755), kSecond);
    ASSERT_FALSE(full.empty() || dimmed.empty());
    EXPECT_NEAR(dimmed.front() - full.front(), 170 * 0.7 / 1.05, 3);
    int dashes = 0;
    for (int x = columnAt(0.55); x < columnAt(0.95); ++x) dashes += darkRows(page, x, kFirst).front() < risen.back() - 20 ? 1 : 0;
    EXPECT_GT(dashes, 100) << "the ambient light";
    EXPECT_LT(dashes, 380) << "is dashed";
}

// Example failure: a line that failed all night fills a page as high as a house.
TEST(NightFigure, has_a_limited_number_of_rows_however_much_failed) {
    const auto heightWith = [](int faults) {
        Night night{.seconds = 100};
        for (int i = 0; i < faults; ++i)
            night.faults.push_back({fmt::format("device {}", i), "unplugged", double(i), std::nullopt});
        return drawn(night).height();
    };
    EXPECT_GT(heightWith(16), heightWith(15));
    EXPECT_EQ(heightWith(17), heightWith(16));
    EXPECT_EQ(heightWith(80), heightWith(16));
}

// Example failure: a fault of the last moment ends where it begins and cannot be seen.
TEST(NightFigure, shows_a_fault_that_took_no_time) {
    Night night{.seconds = 28800};
    night.faults = {{"road", "did not switch", 14400, 14400.0}, {"road", "did not switch", 28800, std::nullopt}};
    const RgbaImage page = drawn(night);
    EXPECT_GT(rowsWith(page, columnAt(0.5) + 1, 6).size(), 5u);
    EXPECT_GT(rowsWith(page, kRight - 2, 6).size(), 5u);
}

TEST(NightFigure, leaves_out_what_the_run_does_not_have) {
    const ScratchFolder folder;
    Night night{.seconds = 10};
    const RgbaImage bare = drawn(night);
    night.outputs = {{.name = "left"}};
    night.outputs[0].z = {{1, 0.02}, {2, 0.03}};
    const RgbaImage one = drawn(night);
    night.outputs[0].tone = night.outputs[0].z;
    night.outputs[0].sights = {{1, 0, 0, 0}, {2, 1, 0, 0}};
    const RgbaImage three = drawn(night);
    EXPECT_EQ(three.height() - one.height(), 2 * (one.height() - bare.height()));
    EXPECT_GT(one.height(), bare.height());
    EXPECT_EQ(one.width(), 1200);
    EXPECT_TRUE(nightFigure({}).write(folder / "none.png")) << "a run that ended before it began";
}

// Grey columns of the cues, in the middle of the strip.
std::vector<int> linesIn(const RgbaImage& page, int y) {
    std::vector<int> found;
    for (int x = kLeft + 2; x < kRight - 2; ++x) {
        const Rgba8 p = page.at(x, y);
        if (p.r < 222 && p.r == p.g && p.g == p.b && (found.empty() || x > found.back() + 1)) found.push_back(x);
    }
    return found;
}

TEST(NightFigure, marks_cues_by_lines_and_many_cues_by_short_marks) {
    Night night{.seconds = 100};
    night.outputs = {{.name = "left"}};
    night.outputs[0].z = {{0, 0.02}, {100, 0.02}};
    night.cues = {{"Dusk", 25}, {"Full", 75}};
    const auto near = [](double share) {
        return testing::AllOf(testing::Ge(columnAt(share) - 1), testing::Le(columnAt(share) + 1));
    };
    constexpr int kMiddle = 74 + 26 + 18 + 85, kEdge = 74 + 26 + 18 + 4;  // of the first chart
    EXPECT_THAT(linesIn(drawn(night), kMiddle), ElementsAre(near(0.25), near(0.75)));
    night.cues.clear();
    for (int i = 1; i < 90; ++i) night.cues.push_back({"Full", double(i)});
    EXPECT_TRUE(linesIn(drawn(night), kMiddle).empty());
    EXPECT_EQ(linesIn(drawn(night), kEdge).size(), 89u);
}

// Texts are told apart by what is drawn for them.
TEST(NightFigure, names_cues_only_where_they_fit) {
    const auto inkOfNames = [](const std::vector<Night::Cue>& cues) {
        Night night{.seconds = 100};
        night.cues = cues;
        const RgbaImage page = drawn(night);
        int ink = 0;
        for (int x = kLeft; x < page.width(); ++x)
            for (int y = 74 + 26 + 2; y < 74 + 26 + 17; ++y) ink += page.at(x, y).r < 128;
        return ink;
    };
    const int one = inkOfNames({{"Farewell", 20}});
    EXPECT_GT(one, 20);
    EXPECT_EQ(inkOfNames({{"Farewell", 20}, {"Farewell", 21}}), one);
    EXPECT_NEAR(inkOfNames({{"Farewell", 20}, {"Farewell", 60}}), 2 * one, one / 4);
    EXPECT_EQ(inkOfNames({{"Farewell", 99}}), 0) << "it would leave the page";
}

TEST(Page, shortens_a_text_to_a_width_between_characters) {
    const Page page(10, 10);
    EXPECT_EQ(page.shortened("camera", 12, 200), "camera");
    const std::string text = "äöüäöüäöüäöüäöüäöü", kept = page.shortened(text, 12, 80);
    EXPECT_LE(page.textWidth(kept, 12), 80);
    EXPECT_GT(page.textWidth(kept, 12), 60);
    EXPECT_TRUE(kept.ends_with("..."));
    EXPECT_EQ(text.find(kept.substr(0, kept.size() - 3)), 0u);
    EXPECT_EQ((kept.size() - 3) % 2, 0u) << "a character was cut in two";
}

}  // namespace
}  // namespace fantascope::plot
