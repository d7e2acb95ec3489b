#include "app/lens/board_sheet.h"

#include "vision/lens_board.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace fantascope::app {
namespace {

using vision::LensBoard;

constexpr double kPoint = 72 / 25.4;  // points a millimetre
constexpr glm::dvec3 kBlack{0.0}, kWhite{1.0};

void drawBoard(plot::Page& page, glm::dvec2 topLeft, double cell) {
    for (const LensBoard::Box& box : LensBoard::boxes())
        page.box(topLeft + cell * glm::dvec2(box.low), topLeft + cell * glm::dvec2(box.high), box.dark ? kBlack : kWhite);
}

// Lines of text below the board, from `top` on, as large as they fit into `height`.
void write(plot::Page& page, const std::array<std::string, 2>& lines, double top, double height) {
    double size = 0.3 * height;
    for (const std::string& line : lines) size = std::min(size, 0.92 * page.width() / page.textWidth(line, 1));
    for (std::size_t i = 0; i < lines.size(); ++i)
        page.text(lines[i], {page.width() / 2.0, top + height * (0.32 + 0.4 * static_cast<double>(i))}, size,
                  plot::Anchor::Middle);
}

std::string nameOfBoard() {
    return fmt::format("Fantascope lens board, {} x {} squares", LensBoard::kSquares.x, LensBoard::kSquares.y);
}

}  // namespace

double squareMm(Paper paper) { return paper == Paper::A4 ? 28 : 40; }

plot::Page boardSheet(Paper paper) {
    const bool isA4 = paper == Paper::A4;
    const double square = squareMm(paper);
    plot::Page page(isA4 ? 842 : 1191, isA4 ? 595 : 842);  // the nearest points
    const glm::dvec2 size = square * kPoint * glm::dvec2(LensBoard::kSquares);
    const glm::dvec2 low = (glm::dvec2(page.width(), page.height()) - size) / 2.0;
    drawBoard(page, low, square * kPoint / LensBoard::kCells);
    const glm::dvec2 mm = square * glm::dvec2(LensBoard::kSquares);
    // The outermost 6 mm of the paper are left to the printer.
    write(page,
          {fmt::format("{} of {:g} mm. Print it at 100 % and glue it flat on a stiff plate.", nameOfBoard(), square),
           fmt::format("Measure it: {:g} mm wide and {:g} mm high. Any other size will do if both are off by the same share.",
                       mm.x, mm.y)},
          low.y + size.y, low.y - 6 * kPoint);
    return page;
}

Result<plot::Page> boardPicture(glm::ivec2 size) {
    constexpr double kMargin = 1;  // square on each side
    const glm::dvec2 room = glm::dvec2(size) / (glm::dvec2(LensBoard::kSquares) + 2 * kMargin);
    const int cell = static_cast<int>(std::min(room.x, room.y)) / LensBoard::kCells;
    constexpr int kLeastCell = 3;  // pixels, for a camera to see
    if (cell < kLeastCell) {
        const glm::ivec2 least = kLeastCell * LensBoard::kCells * (LensBoard::kSquares + 2);
        return Error(fmt::format("a picture of {} x {} pixels is too small for the lens board; it needs {} x {}", size.x, size.y,
                                 least.x, least.y));
    }
    plot::Page page(size.x, size.y);
    const glm::ivec2 board = cell * LensBoard::kCells * LensBoard::kSquares, low = (size - board) / 2;
    drawBoard(page, low, cell);
    write(page,
          {fmt::format("{} of {} pixels. Show it in its own size, on a flat screen.", nameOfBoard(), cell * LensBoard::kCells),
           "Its squares must be squares where it is seen: measure width and height of one."},
          low.y + board.y, size.y - low.y - board.y);
    return page;
}

}  // namespace fantascope::app
