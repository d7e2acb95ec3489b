#include "plot/edit_marks.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fantascope::plot {
namespace {

constexpr double kPlateHeight = 0.38;  // maximum, of the sheet: so there is always room above or below a handle

class Marks {
public:
    explicit Marks(EditSheet& edit)
        : edit_(edit),
          view_(edit.view),
          wall_(edit.wall),
          sheet_(edit.sheet),
          seen_(edit.seen),
          unit_(edit.unit),
          light_(edit.light) {}

    void draw() {
        frame();
        lines();
        if (view_.masks) masks();
        handles();
        pointer();
    }

private:
    void frame() {
        if (view_.picture == TestPicture::Focus) return;
        sheet_.add(edit_.outline);
        // Twice as wide as other lines, since half of it is lost where the picture ends with the
        // pixels.
        sheet_.rimmedStroke(2 * sheet_.thin(), light_);
    }

    // The text lines, on a plate that is near the middle but does not hide the chosen handle.
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
    // The vertical place of the lines, as a share of `seen`. They make way for a test picture's
    // centre.
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
    // The top left corner of a plate whose middle should be near a point.
    glm::dvec2 placeOf(glm::dvec2 plate, glm::dvec2 middle) const {
        const glm::dvec2 room = sheet_.all().high - plate;
        const auto inside = [&](glm::dvec2 low) { return glm::clamp(low, glm::dvec2(0), room); };
        const glm::dvec2 wanted = inside(middle - plate / 2.0);
        const auto chosen =
            std::find_if(view_.handles.begin(), view_.handles.end(), [](const auto& handle) { return handle.chosen; });
        if (chosen == view_.handles.end()) return wanted;
        const glm::dvec2 at = wall_.fromProjector(chosen->at);
        const double keep = 1.2 * edit_.chosenReach();
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

    // The radius of handles. Many handles are small, so that they do not hide the picture.
    double handleRadius() const {
        const double max = std::max(4.5, 11 * unit_);
        if (view_.handles.size() < 2) return max;
        glm::dvec2 low = view_.handles[0].at, high = low;
        for (const EditView::Handle& handle : view_.handles) low = glm::min(low, handle.at), high = glm::max(high, handle.at);
        const glm::dvec2 size = high - low;
        const double count = double(view_.handles.size());
        const double spacing = std::max(std::sqrt(size.x * size.y / count), std::max(size.x, size.y) / count);
        return std::clamp(0.2 * spacing, 2.0, max);
    }
    void handles() {
        const double radius = handleRadius();
        const bool labels = radius >= 8 * unit_;
        // The chosen handle is drawn last, on top.
        for (const bool chosen : {false, true})
            for (const EditView::Handle& handle : view_.handles) {
                if (handle.chosen != chosen) continue;
                const glm::dvec2 at = wall_.fromProjector(handle.at);
                const std::string label = chosen || labels ? handle.label : "";
                if (!edit_.isInside(at)) {
                    edit_.pointAt(at, label, light_, chosen);
                    continue;
                }
                if (chosen)
                    chosenHandle(at);
                else
                    plainHandle(at, radius);
                edit_.labelBeside(at, chosen ? edit_.chosenReach() * 0.6 : radius, label, chosen);
            }
    }
    void plainHandle(glm::dvec2 at, double radius) {
        sheet_.addRing(at, radius);
        sheet_.add(at - glm::dvec2(radius, 0), at + glm::dvec2(radius, 0));
        sheet_.add(at - glm::dvec2(0, radius), at + glm::dvec2(0, radius));
        sheet_.rimmedStroke(sheet_.thin(), 0.85 * light_);
    }
    // A ring in a square with long arms, distinguished from the others by its shape.
    void chosenHandle(glm::dvec2 at) {
        const double reach = edit_.chosenReach(), ring = 0.3 * reach, square = 0.55 * reach;
        sheet_.addRing(at, ring);
        for (const glm::dvec2 arm : {glm::dvec2(1, 0), glm::dvec2(0, 1)}) {
            sheet_.add(at - reach * arm, at - square * arm);
            sheet_.add(at + square * arm, at + reach * arm);
        }
        sheet_.add(std::array{at + glm::dvec2(-square, -square), at + glm::dvec2(square, -square),
                              at + glm::dvec2(square, square), at + glm::dvec2(-square, square),
                              at + glm::dvec2(-square, -square)});
        sheet_.rimmedStroke(2 * sheet_.thin(), light_);
        // Thin in the middle, to show what is below it.
        sheet_.add(at - glm::dvec2(ring, 0), at + glm::dvec2(ring, 0));
        sheet_.add(at - glm::dvec2(0, ring), at + glm::dvec2(0, ring));
        sheet_.rimmedStroke(sheet_.thin(), light_);
    }
    void pointer() {
        if (!view_.pointer) return;
        const glm::dvec2 at = wall_.fromProjector(*view_.pointer);
        const double far = std::max(5.0, 22 * unit_), near = far / 4;
        for (const glm::dvec2 arm : {glm::dvec2(1, 1), glm::dvec2(1, -1), glm::dvec2(-1, 1), glm::dvec2(-1, -1)})
            sheet_.add(at + near * arm, at + far * arm);
        sheet_.rimmedStroke(sheet_.thin(), light_);
    }

    EditSheet& edit_;
    const EditView& view_;
    const Wall& wall_;
    Sheet& sheet_;
    const Box& seen_;
    const double unit_, light_;
};

}  // namespace

void drawEditMarks(EditSheet& edit) { Marks(edit).draw(); }

}  // namespace fantascope::plot
