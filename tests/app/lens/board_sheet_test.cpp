// Holds the sheet that is printed against a ruler: the board in the written file is measured.

#include "app/lens/board_sheet.h"

#include "vision/lens_board.h"

#include "core/file.h"
#include "media/image.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

namespace fantascope::app {
namespace {

using testing::HasSubstr;
using testing::Not;
using vision::LensBoard;

constexpr double kMm = 25.4 / 72;  // a point

// The drawing of a PDF: the compressed stream that fills rectangles.
std::string drawingIn(const std::string& pdf) {
    for (std::size_t at = 0; (at = pdf.find("stream\n", at)) != std::string::npos;) {
        at += std::string_view("stream\n").size();
        std::string text(1 << 20, '\0');
        uLongf length = text.size();
        const auto* bytes = reinterpret_cast<const Bytef*>(pdf.data() + at);
        if (uncompress(reinterpret_cast<Bytef*>(text.data()), &length, bytes, pdf.find("endstream", at) - at) != Z_OK) continue;
        text.resize(length);
        if (text.find(" re f") != std::string::npos) return text;
    }
    return "";
}

struct Rectangle {
    glm::dvec2 low, size;  // points
};
std::vector<Rectangle> rectanglesIn(const std::string& drawing) {
    std::vector<Rectangle> found;
    static const std::regex kRectangle("([-0-9.]+) ([-0-9.]+) ([-0-9.]+) ([-0-9.]+) re f");
    for (auto at = std::sregex_iterator(drawing.begin(), drawing.end(), kRectangle); at != std::sregex_iterator(); ++at) {
        const auto number = [&](std::size_t i) { return std::stod((*at)[i]); };
        found.push_back({{number(1), number(2)}, {number(3), number(4)}});
    }
    return found;
}

TEST(BoardSheet, has_its_squares_in_true_size) {
    const ScratchFolder folder;
    for (const auto& [paper, square, wide, high] : {std::tuple(Paper::A4, 28.0, 297.0, 210.0), {Paper::A3, 40.0, 420.0, 297.0}}) {
        ASSERT_TRUE(boardSheet(paper).writeAsPaper(folder / "b.pdf"));
        const std::string pdf = readFile(folder / "b.pdf").value(), drawing = drawingIn(pdf);
        std::smatch page;
        ASSERT_TRUE(std::regex_search(pdf, page, std::regex("MediaBox \\[ 0 0 ([0-9.]+) ([0-9.]+) \\]")));
        EXPECT_NEAR(std::stod(page[1]) * kMm, wide, 0.3);
        EXPECT_NEAR(std::stod(page[2]) * kMm, high, 0.3);
        EXPECT_THAT(drawing, Not(HasSubstr(" cm"))) << "nothing is scaled";

        std::vector<Rectangle> all = rectanglesIn(drawing);
        ASSERT_GT(all.size(), 54u);
        EXPECT_GT(all[0].size.x * kMm, wide - 1) << "the white paper";
        all.erase(all.begin());
        glm::dvec2 low(1e9), end(0);
        int squares = 0, markers = 0;
        for (const Rectangle& one : all) {
            low = glm::min(low, one.low);
            end = glm::max(end, one.low + one.size);
            const glm::dvec2 mm = one.size * kMm;
            squares += std::abs(mm.x - square) < 0.01 && std::abs(mm.y - square) < 0.01;
            markers += std::abs(mm.x - 0.75 * square) < 0.01 && std::abs(mm.y - 0.75 * square) < 0.01;
        }
        EXPECT_EQ(squares, 27);
        EXPECT_EQ(markers, 27);
        EXPECT_NEAR((end.x - low.x) * kMm, 9 * square, 0.01);
        EXPECT_NEAR((end.y - low.y) * kMm, 6 * square, 0.01);
        EXPECT_GT(std::min(low.x, low.y) * kMm, 15) << "white margin, which no printer cuts off";
    }
}

TEST(BoardPicture, is_found_with_all_its_corners) {
    const ScratchFolder folder;
    for (const glm::ivec2 size : {glm::ivec2(1920, 1080), glm::ivec2(600, 800)}) {
        const auto page = boardPicture(size);
        ASSERT_TRUE(page);
        ASSERT_TRUE(page->write(folder / "b.png"));
        const RgbaImage picture = readRgba(folder / "b.png").value();
        EXPECT_EQ(glm::ivec2(picture.width(), picture.height()), size);
        const auto view = vision::findBoard(picture);
        ASSERT_TRUE(view);
        ASSERT_EQ(view->corners.size(), std::size_t{LensBoard::kCorners});
        // Every square has the same whole number of pixels.
        const glm::dvec2 first = view->corners.front().pixel, last = view->corners.back().pixel;
        const glm::dvec2 square = (last - first) / glm::dvec2(LensBoard::kSquares - 2);
        EXPECT_NEAR(square.x, square.y, 0.02);
        EXPECT_NEAR(square.x, 8 * std::round(square.x / 8), 0.02);
    }
    EXPECT_THAT(boardPicture({200, 200}).error().message(), HasSubstr("264 x 192"));
}

}  // namespace
}  // namespace fantascope::app
