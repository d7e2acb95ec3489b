#include "plot/test_picture.h"

#include "core/check.h"
#include "plot/sheet.h"

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

// Everything but the colour cards is grey: it is seen whichever primaries a projector has.
constexpr double kBright = 1, kDim = 0.45, kLines = 0.8;
constexpr double kCell = 0.1;          // of the grid, canvas heights
constexpr double kTolerance = 0.05;    // pixels between a curve and its chords
constexpr double kPlateHeight = 0.38;  // of the picture at most: above or below a handle there is always room

// The projector's pixels as they lie on the wall: mirrored and turned back, so that whatever is
// drawn there is read upright. One of eight ways, each of which brings whole pixels to whole
// pixels.
struct Wall {
    glm::ivec2 projector;               // pixels
    glm::dmat2 projectorFromWall{1.0};  // about the middles; entries 0, 1 and -1

    explicit Wall(const Projection& projection) : projector(projection.size) {
        // From the picture itself and not from the warp's settings: crossed-over corners mirror and
        // turn it, too.
        const CanvasPart& part = projection.warp.shape().part;
        const glm::dvec2 middle = (part.low + part.high) / 2.0, reach = (part.high - part.low) / 4.0;
        const auto moved = [&](glm::dvec2 by) {
            return projection.warp.keystone()(middle + by) - projection.warp.keystone()(middle - by);
        };
        const glm::dvec2 right = glm::normalize(moved({reach.x, 0})), down = glm::normalize(moved({0, reach.y}));
        double best = -std::numeric_limits<double>::infinity();
        for (const glm::dvec2 x : {glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(-1, 0), glm::dvec2(0, -1)})
            for (const glm::dvec2 y : {glm::dvec2(-x.y, x.x), glm::dvec2(x.y, -x.x)})
                if (const double fit = glm::dot(x, right) + glm::dot(y, down); fit > best + 1e-9) {
                    best = fit;
                    projectorFromWall = glm::dmat2(x, y);
                }
    }

    glm::ivec2 size() const { return projectorFromWall[0].x != 0 ? projector : glm::ivec2(projector.y, projector.x); }
    glm::dvec2 fromProjector(glm::dvec2 pixel) const {
        return glm::transpose(projectorFromWall) * (pixel - glm::dvec2(projector) / 2.0) + glm::dvec2(size()) / 2.0;
    }
    RgbaImage toProjector(Sheet& sheet) const {
        const auto pixel = [&](glm::dvec2 at) { return glm::ivec2(glm::floor(fromProjector(at + 0.5))); };
        const glm::ivec2 origin = pixel({0, 0});
        return sheet.image(projector, origin, pixel({1, 0}) - origin, pixel({0, 1}) - origin);
    }
};

class EditDrawing {
public:
    explicit EditDrawing(const EditView& view)
        : view_(view),
          warp_(view.projection.warp),
          part_(warp_.shape().part),
          wall_(view.projection),
          sheet_(wall_.size()),
          unit_(sheet_.unit()),
          light_(view.chosen ? kBright : kDim) {
        const std::array<glm::dvec2, 5> ring{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}};
        for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
            const auto side = straight(inPart(ring[i]), inPart(ring[i + 1]));
            outline_.insert(outline_.end(), side.begin(), side.end());
        }
        Box box{outline_.front(), outline_.front()};
        for (const glm::dvec2 point : outline_) box = {glm::min(box.low, point), glm::max(box.high, point)};
        const Box seen{glm::clamp(box.low, sheet_.all().low, sheet_.all().high),
                       glm::clamp(box.high, sheet_.all().low, sheet_.all().high)};
        // A sliver of a picture holds no text.
        const glm::dvec2 share = seen.size() / sheet_.all().size();
        seen_ = std::min(share.x, share.y) > 0.2 ? seen : sheet_.all();
    }

    RgbaImage drawn() {
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
        frame();
        lines();
        if (view_.masks) masks();
        handles();
        pointer();
        return wall_.toProjector(sheet_);
    }

private:
    // Points of the canvas, widths and heights of it.
    glm::dvec2 inPart(glm::dvec2 share) const { return part_.low + share * (part_.high - part_.low); }
    glm::dvec2 onWall(glm::dvec2 canvas) const { return wall_.fromProjector(warp_.projectorFromCanvas(canvas)); }

    // A curve of the canvas, 0..1 along it, by chords.
    std::vector<glm::dvec2> curve(const std::function<glm::dvec2(double)>& canvas, int pieces) const {
        const auto at = [&](double along) { return onWall(canvas(along)); };
        std::vector<glm::dvec2> points{at(0)};
        const auto reach = [&](const auto& self, double from, double to, glm::dvec2 end, int depth) -> void {
            const glm::dvec2 begin = points.back(), middle = at((from + to) / 2);
            if (depth == 0 || glm::distance(middle, (begin + end) / 2.0) < kTolerance) {
                points.push_back(middle);
                points.push_back(end);
                return;
            }
            self(self, from, (from + to) / 2, middle, depth - 1);
            self(self, (from + to) / 2, to, end, depth - 1);
        };
        for (int i = 0; i < pieces; ++i) reach(reach, double(i) / pieces, double(i + 1) / pieces, at(double(i + 1) / pieces), 8);
        return points;
    }
    // In so many pieces none has two of the kinks that a line may have from cell to cell of the
    // mesh.
    std::vector<glm::dvec2> straight(glm::dvec2 from, glm::dvec2 to) const {
        const glm::ivec2 cells = glm::max(warp_.shape().mesh.points - 1, 1);
        return curve([&](double along) { return from + along * (to - from); }, 2 * std::max(cells.x, cells.y));
    }
    // `radius` in canvas heights.
    std::vector<glm::dvec2> circle(glm::dvec2 centre, double radius) const {
        return curve(
            [&](double along) {
                const double angle = 2 * std::numbers::pi * along;
                return centre + radius * glm::dvec2(std::cos(angle) / view_.aspect, std::sin(angle));
            },
            32);
    }

    // Where the lines of the grid stand between two edges of the part, canvas heights.
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
            // Every fifth line is heavier, to count by.
            const auto isOf = [&](double at) { return (std::lround(at / kCell) % 5 == 0) == heavy; };
            for (const double x : columns())
                if (isOf(x)) sheet_.add(straight({x / view_.aspect, part_.low.y}, {x / view_.aspect, part_.high.y}));
            for (const double y : rows())
                if (isOf(y)) sheet_.add(straight({part_.low.x, y}, {part_.high.x, y}));
            sheet_.stroke(sheet_.thin(), heavy ? value : 0.6 * value);
        }
    }

    void grid() {
        background();
        gridLines(kLines);
        const glm::dvec2 side = (part_.high - part_.low) * glm::dvec2(view_.aspect, 1);
        const double radius = std::min(side.x, side.y) / 2;
        sheet_.add(circle(inPart({0.5, 0.5}), 0.8 * radius));
        for (const double x : {0.0, 1.0})
            for (const double y : {0.0, 1.0}) {
                // As far from both edges as they are large.
                const glm::dvec2 inset = glm::dvec2(0.25 * radius) / side;
                sheet_.add(circle(inPart(glm::mix(inset, 1.0 - inset, glm::dvec2(x, y))), 0.2 * radius));
            }
        sheet_.stroke(sheet_.thin(), 1);
        const glm::dvec2 arm = 0.12 * radius / side;
        sheet_.add(straight(inPart({0.5 - arm.x, 0.5}), inPart({0.5 + arm.x, 0.5})));
        sheet_.add(straight(inPart({0.5, 0.5 - arm.y}), inPart({0.5, 0.5 + arm.y})));
        sheet_.stroke(2 * sheet_.thin(), 1);
    }

    // The outermost pixels, so that it is seen whether a projector shows them.
    void rim() {
        const glm::dvec2 size = sheet_.all().high;
        sheet_.rectangle({{0, 0}, {size.x, 1}}, 1);
        sheet_.rectangle({{0, size.y - 1}, size}, 1);
        sheet_.rectangle({{0, 0}, {1, size.y}}, 1);
        sheet_.rectangle({{size.x - 1, 0}, size}, 1);
    }

    void corners() {
        background();
        sheet_.add(straight(inPart({0, 0}), inPart({1, 1})));
        sheet_.add(straight(inPart({1, 0}), inPart({0, 1})));
        sheet_.stroke(sheet_.thin(), 0.6 * kLines);
        rim();
        const std::array<std::pair<const char*, glm::dvec2>, 4> marks{
            {{"TL", {0, 0}}, {"TR", {1, 0}}, {"BR", {1, 1}}, {"BL", {0, 1}}}};
        const glm::dvec2 middle = onWall(inPart({0.5, 0.5}));
        for (const auto& [label, share] : marks) {
            const glm::dvec2 corner = onWall(inPart(share));
            if (!isInside(corner)) {
                pointAt(corner, label, 1, false);
                continue;
            }
            // The last pixel that belongs to the picture: a corner at the right edge of the pixels
            // lies in none.
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

    // Number, name and size below each other in a box, with an arrow up beside the number.
    void plaque(const Box& box) {
        const double height = box.size().y, width = box.size().x;
        const std::string number = std::to_string(view_.number),
                          below = fmt::format("{} × {}", wall_.projector.x, wall_.projector.y);
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
    // So much of what is seen, above the lines, if there are any.
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
        // To the left and to the right of it, in what room there is.
        const double room = (seen_.size().x - box.size().x) / 2 - margin, size = sheet_.fontSize("right", 0.8 * room, 64 * unit_);
        const glm::dvec2 half(room / 2, 0.7 * size);
        for (const auto& [word, x] : {std::pair("left", seen_.low.x + room / 2), std::pair("right", seen_.high.x - room / 2)}) {
            const glm::dvec2 middle(x, box.middle().y);
            sheet_.rectangle({middle - half, middle + half}, 0);
            sheet_.text(word, middle, size, light_);
        }
    }
    // Where a crossing of the grid lies on the canvas, in heights of it, below and to the right of
    // the crossing.
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
                sheet_.text(label, onWall({x / view_.aspect, y}) + to, size, light_);
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
        // Smaller and smaller, down to what no projector shows.
        double y = box.low.y + 0.74 * side;
        for (const double share : {0.1, 0.075, 0.05}) {
            const double text = std::max(5.0, share * side);
            if (y + text / 2 > box.high.y) break;
            sheet_.text("Rag 0123 ems", {box.middle().x, y}, sheet_.fontSize("Rag 0123 ems", 0.9 * side, text), 1);
            y += 1.15 * text;
        }
    }

    void frame() {
        if (view_.picture == TestPicture::Focus) return;
        sheet_.add(outline_);
        // Twice as wide as other lines: where the picture ends with the pixels half of it is lost.
        sheet_.rimmedStroke(2 * sheet_.thin(), light_);
    }

    bool isInside(glm::dvec2 point) const {
        const glm::dvec2 size = sheet_.all().high;
        return point.x >= 0 && point.y >= 0 && point.x <= size.x && point.y <= size.y;
    }
    double chosenReach() const { return std::max(3.0, 34 * unit_); }

    // In words, on a plate as near to the middle as the chosen handle lets it.
    void lines() {
        if (view_.lines.empty()) return;
        const auto sizeOf = [&](std::size_t line) { return std::max(10.0, (line == 0 ? 40 : 30) * unit_); };
        glm::dvec2 text(0);
        for (std::size_t i = 0; i < view_.lines.size(); ++i) {
            text.x = std::max(text.x, sheet_.textWidth(view_.lines[i], sizeOf(i)));
            text.y += 1.35 * sizeOf(i);
        }
        const glm::dvec2 padding(0.6 * sizeOf(0), 0.35 * sizeOf(0)), all = sheet_.all().high;
        glm::dvec2 plate = text + 2.0 * padding;
        const double scale = std::min({1.0, 0.9 * all.x / plate.x, kPlateHeight * all.y / plate.y});
        plate *= scale;
        const glm::dvec2 low = placeOf(plate, seen_.low + seen_.size() * glm::dvec2(0.5, linesMiddle()));
        sheet_.rectangle({low, low + plate}, 0, 0.8);
        double y = low.y + scale * padding.y;
        for (std::size_t i = 0; i < view_.lines.size(); ++i) {
            const double size = scale * sizeOf(i);
            sheet_.text(view_.lines[i], {low.x + plate.x / 2, y + 0.675 * size}, size, light_ * (i == 0 ? 1.0 : 0.85));
            y += 1.35 * size;
        }
    }
    // Down what is seen: where the test picture has its middle the lines make way for it.
    double linesMiddle() const {
        switch (view_.picture) {
            case TestPicture::Numbers:
            case TestPicture::Identify:
                return 0.78;
            case TestPicture::Grid:
            case TestPicture::Corners:
            case TestPicture::Focus:
                return 0.7;
            default:
                return 0.5;
        }
    }
    // The top left of a plate whose middle is to be near a point.
    glm::dvec2 placeOf(glm::dvec2 plate, glm::dvec2 middle) const {
        const glm::dvec2 room = sheet_.all().high - plate;
        const auto inside = [&](glm::dvec2 low) { return glm::clamp(low, glm::dvec2(0), room); };
        const glm::dvec2 wanted = inside(middle - plate / 2.0);
        const auto chosen =
            std::find_if(view_.handles.begin(), view_.handles.end(), [](const auto& handle) { return handle.chosen; });
        if (chosen == view_.handles.end()) return wanted;
        const glm::dvec2 at = wall_.fromProjector(chosen->at);
        const double keep = 1.2 * chosenReach();
        const auto covers = [&](glm::dvec2 low) {
            return glm::all(glm::greaterThan(at + keep, low)) && glm::all(glm::lessThan(at - keep, low + plate));
        };
        if (!covers(wanted)) return wanted;
        const glm::dvec2 none(std::numeric_limits<double>::infinity());
        glm::dvec2 best = none;
        for (const glm::dvec2 low : {glm::dvec2(wanted.x, at.y + keep), glm::dvec2(wanted.x, at.y - keep - plate.y),
                                     glm::dvec2(at.x + keep, wanted.y), glm::dvec2(at.x - keep - plate.x, wanted.y)})
            if (inside(low) == low && (best == none || glm::distance(low, wanted) < glm::distance(best, wanted))) best = low;
        return best == none ? wanted : best;
    }

    void masks() {
        for (const Mask& mask : view_.projection.masks) {
            if (mask.polygon.empty()) continue;
            std::vector<glm::dvec2> ring;
            for (const glm::dvec2 point : mask.polygon) ring.push_back(wall_.fromProjector(point));
            ring.push_back(ring.front());
            sheet_.add(ring);
        }
        sheet_.rimmedStroke(sheet_.thin(), 0.85 * light_);
    }

    // How large handles may be so that many of them leave something to be seen.
    double handleRadius() const {
        const double most = std::max(4.5, 11 * unit_);
        if (view_.handles.size() < 2) return most;
        glm::dvec2 low = view_.handles[0].at, high = low;
        for (const EditView::Handle& handle : view_.handles) low = glm::min(low, handle.at), high = glm::max(high, handle.at);
        const glm::dvec2 size = high - low;
        const double count = double(view_.handles.size());
        const double spacing = std::max(std::sqrt(size.x * size.y / count), std::max(size.x, size.y) / count);
        return std::clamp(0.2 * spacing, 2.0, most);
    }
    void handles() {
        const double radius = handleRadius();
        const bool labels = radius >= 8 * unit_;
        // The chosen one on top.
        for (const bool chosen : {false, true})
            for (const EditView::Handle& handle : view_.handles) {
                if (handle.chosen != chosen) continue;
                const glm::dvec2 at = wall_.fromProjector(handle.at);
                const std::string label = chosen || labels ? handle.label : "";
                if (!isInside(at)) {
                    pointAt(at, label, light_, chosen);
                    continue;
                }
                if (chosen)
                    chosenHandle(at);
                else
                    plainHandle(at, radius);
                labelBeside(at, chosen ? chosenReach() * 0.6 : radius, label, chosen);
            }
    }
    void plainHandle(glm::dvec2 at, double radius) {
        sheet_.addRing(at, radius);
        sheet_.add(at - glm::dvec2(radius, 0), at + glm::dvec2(radius, 0));
        sheet_.add(at - glm::dvec2(0, radius), at + glm::dvec2(0, radius));
        sheet_.rimmedStroke(sheet_.thin(), 0.85 * light_);
    }
    // A ring in a square with long arms: told from the others by its shape.
    void chosenHandle(glm::dvec2 at) {
        const double reach = chosenReach(), ring = 0.3 * reach, square = 0.55 * reach;
        sheet_.addRing(at, ring);
        for (const glm::dvec2 arm : {glm::dvec2(1, 0), glm::dvec2(0, 1)}) {
            sheet_.add(at - reach * arm, at - square * arm);
            sheet_.add(at + square * arm, at + reach * arm);
        }
        sheet_.add(std::array{at + glm::dvec2(-square, -square), at + glm::dvec2(square, -square),
                              at + glm::dvec2(square, square), at + glm::dvec2(-square, square),
                              at + glm::dvec2(-square, -square)});
        sheet_.rimmedStroke(2 * sheet_.thin(), light_);
        // Thin in the middle: what it is laid on is to be seen.
        sheet_.add(at - glm::dvec2(ring, 0), at + glm::dvec2(ring, 0));
        sheet_.add(at - glm::dvec2(0, ring), at + glm::dvec2(0, ring));
        sheet_.rimmedStroke(sheet_.thin(), light_);
    }
    // What lies outside the pixels: an arrow at their edge.
    void pointAt(glm::dvec2 at, const std::string& label, double value, bool chosen) {
        const double size = (chosen ? 1.0 : 0.6) * chosenReach();
        const glm::dvec2 all = sheet_.all().high, margin = glm::min(glm::dvec2(2 * sheet_.thin()), all / 2.0);
        const glm::dvec2 tip = glm::clamp(at, margin, all - margin);
        const glm::dvec2 along = glm::normalize(at - tip), across(-along.y, along.x);
        const std::array<glm::dvec2, 3> shape{
            {tip - size * along + 0.45 * size * across, tip, tip - size * along - 0.45 * size * across}};
        sheet_.add(shape);
        if (chosen) sheet_.add(tip - 1.8 * size * along, tip);
        sheet_.rimmedStroke((chosen ? 2 : 1) * sheet_.thin(), value);
        labelBeside(tip - (chosen ? 1.8 : 1.0) * size * along, 0, label, chosen);
    }
    // Below and to the right, or wherever there is room.
    void labelBeside(glm::dvec2 at, double clear, const std::string& label, bool chosen) {
        if (label.empty()) return;
        const glm::dvec2 all = sheet_.all().high;
        const double size = sheet_.fontSize(label, 0.4 * all.x, std::max(8.0, (chosen ? 28 : 20) * unit_));
        const glm::dvec2 half(sheet_.textWidth(label, size) / 2, size / 2), away = half + clear + 0.3 * size;
        const glm::dvec2 side = glm::mix(glm::dvec2(1), glm::dvec2(-1), glm::greaterThan(at + away + half, all));
        sheet_.text(label, glm::clamp(at + side * away, half, glm::max(half, all - half)), size, light_, true);
    }

    void pointer() {
        if (!view_.pointer) return;
        const glm::dvec2 at = wall_.fromProjector(*view_.pointer);
        const double far = std::max(5.0, 22 * unit_), near = far / 4;
        for (const glm::dvec2 arm : {glm::dvec2(1, 1), glm::dvec2(1, -1), glm::dvec2(-1, 1), glm::dvec2(-1, -1)})
            sheet_.add(at + near * arm, at + far * arm);
        sheet_.rimmedStroke(sheet_.thin(), light_);
    }

    const EditView& view_;
    const Warp& warp_;
    const CanvasPart part_;
    const Wall wall_;
    Sheet sheet_;
    const double unit_, light_;
    std::vector<glm::dvec2> outline_;  // of the picture, on the wall
    Box seen_{};                       // what of it the projector has, on the wall
};

}  // namespace

RgbaImage drawEditView(const EditView& view) {
    FANTASCOPE_CHECK(std::min(view.projection.size.x, view.projection.size.y) > 0 && view.aspect > 0,
                     "a picture has pixels and an aspect");
    return EditDrawing(view).drawn();
}

}  // namespace fantascope::plot
