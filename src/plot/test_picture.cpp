#include "plot/test_picture.h"

#include "core/check.h"
#include "plot/edit_marks.h"
#include "plot/edit_sheet.h"

#include <cairo.h>
#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <span>

namespace fantascope::plot {
namespace {

// Everything except the colour cards is grey, so that it is visible with any projector's primaries.
constexpr double kLines = 0.8;  // grey value
constexpr double kCell = 0.1;   // of the grid, canvas heights

class TestPictureDrawing {
public:
    explicit TestPictureDrawing(EditSheet& edit)
        : edit_(edit),
          view_(edit.view),
          part_(edit.part),
          wall_(edit.wall),
          sheet_(edit.sheet),
          seen_(edit.seen),
          unit_(edit.unit),
          light_(edit.light) {}

    void draw() {
        switch (view_.picture) {
            case TestPicture::None:
            case TestPicture::Bars:
            case TestPicture::Ramp:
                break;
            case TestPicture::Grid:
                grid();
                break;
            case TestPicture::Corners:
                corners();
                break;
            case TestPicture::Numbers:
                numbers();
                break;
            case TestPicture::Focus:
                focus();
                break;
            case TestPicture::Identify:
                identify();
                break;
        }
    }

private:
    // The places of grid lines from `low` to `high`, canvas heights.
    static std::vector<double> multiples(double low, double high) {
        std::vector<double> found;
        for (int i = int(std::ceil(low / kCell - 1e-9)); i * kCell <= high + 1e-9; ++i) found.push_back(i * kCell);
        return found;
    }
    std::vector<double> columns() const { return multiples(part_.low.x * view_.aspect, part_.high.x * view_.aspect); }
    std::vector<double> rows() const { return multiples(part_.low.y, part_.high.y); }

    void background() { sheet_.rectangle(sheet_.all(), 0); }
    void gridLines(double value) {
        for (const bool heavy : {false, true}) {
            // Every fifth line is heavier, to help counting.
            const auto isOf = [&](double at) { return (std::lround(at / kCell) % 5 == 0) == heavy; };
            for (const double x : columns())
                if (isOf(x)) sheet_.add(edit_.straight({x / view_.aspect, part_.low.y}, {x / view_.aspect, part_.high.y}));
            for (const double y : rows())
                if (isOf(y)) sheet_.add(edit_.straight({part_.low.x, y}, {part_.high.x, y}));
            sheet_.stroke(sheet_.thin(), heavy ? value : 0.6 * value);
        }
    }

    void grid() {
        background();
        gridLines(kLines);
        const glm::dvec2 side = (part_.high - part_.low) * glm::dvec2(view_.aspect, 1);
        const double radius = std::min(side.x, side.y) / 2;
        sheet_.add(edit_.circle(edit_.inPart({0.5, 0.5}), 0.8 * radius));
        for (const double x : {0.0, 1.0})
            for (const double y : {0.0, 1.0}) {
                // Its distance from both edges is about its size.
                const glm::dvec2 inset = glm::dvec2(0.25 * radius) / side;
                sheet_.add(edit_.circle(edit_.inPart(glm::mix(inset, 1.0 - inset, glm::dvec2(x, y))), 0.2 * radius));
            }
        sheet_.stroke(sheet_.thin(), 1);
        const glm::dvec2 arm = 0.12 * radius / side;
        sheet_.add(edit_.straight(edit_.inPart({0.5 - arm.x, 0.5}), edit_.inPart({0.5 + arm.x, 0.5})));
        sheet_.add(edit_.straight(edit_.inPart({0.5, 0.5 - arm.y}), edit_.inPart({0.5, 0.5 + arm.y})));
        sheet_.stroke(2 * sheet_.thin(), 1);
    }

    // Lights the outermost pixels, which show whether the projector cuts any off.
    void rim() {
        const glm::dvec2 size = sheet_.all().high;
        sheet_.rectangle({{0, 0}, {size.x, 1}}, 1);
        sheet_.rectangle({{0, size.y - 1}, size}, 1);
        sheet_.rectangle({{0, 0}, {1, size.y}}, 1);
        sheet_.rectangle({{size.x - 1, 0}, size}, 1);
    }

    void corners() {
        background();
        sheet_.add(edit_.straight(edit_.inPart({0, 0}), edit_.inPart({1, 1})));
        sheet_.add(edit_.straight(edit_.inPart({1, 0}), edit_.inPart({0, 1})));
        sheet_.stroke(sheet_.thin(), 0.6 * kLines);
        rim();
        const std::array<std::pair<const char*, glm::dvec2>, 4> marks{
            {{"TL", {0, 0}}, {"TR", {1, 0}}, {"BR", {1, 1}}, {"BL", {0, 1}}}};
        const glm::dvec2 middle = edit_.onWall(edit_.inPart({0.5, 0.5}));
        for (const auto& [label, share] : marks) {
            const glm::dvec2 corner = edit_.onWall(edit_.inPart(share));
            if (!edit_.isInside(corner)) {
                edit_.pointAt(corner, label, 1, false);
                continue;
            }
            // The picture's last pixel: a corner on the right or lower edge of the pixels lies in
            // no pixel.
            const glm::dvec2 towards = glm::sign(middle - corner);
            const glm::dvec2 pixel = glm::clamp(glm::floor(corner + 1e-6 * towards), glm::dvec2(0), sheet_.all().high - 1.0);
            const double arm = std::round(std::max(4.0, 60 * unit_));
            sheet_.rectangle({{pixel.x - arm, pixel.y}, {pixel.x + arm + 1, pixel.y + 1}}, 1);
            sheet_.rectangle({{pixel.x, pixel.y - arm}, {pixel.x + 1, pixel.y + arm + 1}}, 1);
            sheet_.addRing(pixel + 0.5, arm / 2);
            sheet_.stroke(sheet_.thin(), 1);
            const double size = std::max(7.0, 48 * unit_);
            sheet_.text(label, pixel + towards * glm::dvec2(1.4 * arm, 1.1 * arm), size, 1, true);
        }
    }

    // Number, name and size below each other in a box, with an upward arrow beside the number.
    void plaque(const Box& box) {
        const double height = box.size().y, width = box.size().x;
        const std::string number = std::to_string(view_.number),
                          below = fmt::format("{} × {}", wall_.projector().x, wall_.projector().y);
        const double numberSize = sheet_.fontSize(number, 0.6 * width, 0.5 * height / kCapital);
        const double middle = box.middle().x;
        const double numberWidth = sheet_.textWidth(number, numberSize);
        sheet_.text(number, {middle, box.low.y + 0.25 * height}, numberSize, light_);
        sheet_.text(view_.name, {middle, box.low.y + 0.68 * height},
                    sheet_.fontSize(view_.name, 0.92 * width, 0.2 * height / kCapital), light_);
        sheet_.text(below, {middle, box.low.y + 0.93 * height}, sheet_.fontSize(below, 0.92 * width, 0.1 * height / kCapital),
                    light_);
        arrowUp({std::max(box.low.x + 0.1 * height, middle - numberWidth / 2 - 0.25 * height), box.low.y + 0.25 * height},
                0.5 * height);
    }
    void arrowUp(glm::dvec2 middle, double height) {
        const std::array<glm::dvec2, 7> shape{
            {{0, -0.5}, {0.3, -0.1}, {0.1, -0.1}, {0.1, 0.5}, {-0.1, 0.5}, {-0.1, -0.1}, {-0.3, -0.1}}};
        cairo_t* const c = sheet_.context();
        cairo_new_path(c);
        for (const glm::dvec2 point : shape) cairo_line_to(c, middle.x + height * point.x, middle.y + height * point.y);
        cairo_close_path(c);
        sheet_.grey(light_);
        cairo_fill(c);
    }
    // A box of these shares of `seen`, placed above the text lines if there are any.
    Box plaqueBox(double across, double down) const {
        const glm::dvec2 half = seen_.size() * glm::dvec2(across, down) / 2.0;
        const glm::dvec2 middle = seen_.low + seen_.size() * glm::dvec2(0.5, view_.lines.empty() ? 0.5 : 0.1 + down / 2);
        return {middle - half, middle + half};
    }

    void identify() {
        background();
        rim();
        plaque(plaqueBox(0.8, view_.lines.empty() ? 0.7 : 0.45));
    }

    void numbers() {
        background();
        gridLines(0.6 * kLines);
        gridLabels();
        const Box box = plaqueBox(0.56, view_.lines.empty() ? 0.5 : 0.42);
        const double margin = 0.06 * box.size().y;
        sheet_.rectangle({box.low - margin, box.high + margin}, 0);
        plaque(box);
        // "left" and "right" beside the box, as large as there is room.
        const double room = (seen_.size().x - box.size().x) / 2 - margin, size = sheet_.fontSize("right", 0.8 * room, 64 * unit_);
        const glm::dvec2 half(room / 2, 0.7 * size);
        for (const auto& [word, x] : {std::pair("left", seen_.low.x + room / 2), std::pair("right", seen_.high.x - room / 2)}) {
            const glm::dvec2 middle(x, box.middle().y);
            sheet_.rectangle({middle - half, middle + half}, 0);
            sheet_.text(word, middle, size, light_);
        }
    }
    // Labels grid crossings with their canvas coordinates, in canvas heights, below and to the
    // right of the crossing.
    void gridLabels() {
        const auto labelOf = [](double x, double y) { return fmt::format("{:.1f}, {:.1f}", x, y); };
        const double cell = std::sqrt(seen_.size().x * seen_.size().y / std::max(1.0, double(columns().size() * rows().size())));
        const double size = std::max(7.0, 20 * unit_), room = 1.7 * sheet_.textWidth(labelOf(0, 0), size);
        const long every = room < cell ? 1 : room < 2 * cell ? 2 : room < 5 * cell ? 5 : 10;
        const glm::dvec2 last = part_.high * glm::dvec2(view_.aspect, 1) - kCell / 2;
        for (const double x : columns())
            for (const double y : rows()) {
                const bool counts = std::lround(x / kCell) % every == 0 && std::lround(y / kCell) % every == 0;
                if (!counts || x > last.x || y > last.y) continue;
                const std::string label = labelOf(x, y);
                const glm::dvec2 to(sheet_.textWidth(label, size) / 2 + 0.4 * size, 0.8 * size);
                sheet_.text(label, edit_.onWall({x / view_.aspect, y}) + to, size, light_);
            }
    }

    void focus() {
        const int tile = std::max(8, int(std::lround(90 * unit_)));
        sheet_.pixels([&](int x, int y) { return ((x / tile + y / tile) % 2 == 0 ? x : y) % 2 == 0 ? 255 : 0; });
        const glm::dvec2 size = sheet_.all().high;
        const double side = std::floor(std::min(size.x, size.y) / 5);
        for (const double x : {0.0, 0.5, 1.0})
            for (const double y : {0.0, 0.5, 1.0}) {
                const glm::dvec2 low = glm::round(glm::mix(glm::dvec2(0), size - side, glm::dvec2(x, y)));
                focusPanel({low, low + side});
            }
        rim();
    }
    void focusPanel(const Box& box) {
        constexpr int kSpokes = 36;
        sheet_.rectangle(box, 0);
        const double side = box.size().x, radius = 0.32 * side;
        const glm::dvec2 centre = box.low + side * glm::dvec2(0.5, 0.36);
        cairo_t* const c = sheet_.context();
        cairo_new_path(c);
        for (int i = 0; i < kSpokes; ++i) {
            const double angle = 2 * std::numbers::pi * i / kSpokes, half = std::numbers::pi / kSpokes / 2;
            cairo_move_to(c, centre.x, centre.y);
            cairo_arc(c, centre.x, centre.y, radius, angle - half, angle + half);
            cairo_close_path(c);
        }
        sheet_.grey(1);
        cairo_fill(c);
        // Text in falling sizes, down to one that no projector resolves.
        double y = box.low.y + 0.74 * side;
        for (const double share : {0.1, 0.075, 0.05}) {
            const double text = std::max(5.0, share * side);
            if (y + text / 2 > box.high.y) break;
            sheet_.text("Rag 0123 ems", {box.middle().x, y}, sheet_.fontSize("Rag 0123 ems", 0.9 * side, text), 1);
            y += 1.15 * text;
        }
    }

    EditSheet& edit_;
    const EditView& view_;
    const CanvasPart& part_;
    const Wall& wall_;
    Sheet& sheet_;
    const Box& seen_;
    const double unit_, light_;
};

}  // namespace

RgbaImage drawEditView(const EditView& view) {
    FANTASCOPE_CHECK(std::min(view.projection.size.x, view.projection.size.y) > 0 && view.aspect > 0,
                     "a picture has pixels and an aspect");
    EditSheet edit(view);
    TestPictureDrawing(edit).draw();
    drawEditMarks(edit);
    return edit.wall.toProjector(edit.sheet);
}

}  // namespace fantascope::plot
