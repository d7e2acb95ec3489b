#include "plot/fabrication_figures.h"

#include "core/geometry.h"
#include "plot/rendering.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace fantascope::plot {
namespace {

using glm::dvec2, glm::dvec3;
using theatre::Fabrication;

constexpr glm::vec3 kTable{0.80f, 0.83f, 0.87f}, kPlastic{0.55f, 0.53f, 0.50f};  // linear light

constexpr double kPoint = 72 / 25.4;                  // points per millimetre of paper
constexpr int kPaperWidth = 842, kPaperHeight = 595;  // A4, landscape
constexpr double kBorder = 34, kText = 9, kLine = 14;
constexpr double kColumn = 560;  // width of side view and plan, points; the screen and the numbers stand beside them
constexpr double kBar = 100;     // mm, on the paper
constexpr Stroke kEdge{{0.1, 0.1, 0.1}, 1}, kThin{{0.45, 0.45, 0.45}, 0.6}, kRay{{0.85, 0.55, 0.1}, 0.8, 1, true};
constexpr glm::dvec3 kLampColour{0.95, 0.65, 0.1};
constexpr Rgba8 kShade{150, 160, 175, 255}, kPaper{255, 255, 255, 255};
constexpr std::array<double, 12> kScales{1, 1.5, 2, 2.5, 3, 4, 5, 10, 20, 25, 50, 100};

struct Range {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    void add(double value) { least = std::min(least, value), most = std::max(most, value); }
    double size() const { return most - least; }
    double middle() const { return 0.5 * (least + most); }
};

// A filled view of the triangles along an axis. `u`, `v`: the print's axes that point right and
// down or, with `isUp`, up.
RgbaImage filledView(const TriangleMesh& mesh, int u, int v, bool isUp, const Range& across, const Range& along, double perMm) {
    const int width = std::max(1, static_cast<int>(std::ceil(across.size() * perMm))),
              height = std::max(1, static_cast<int>(std::ceil(along.size() * perMm)));
    RgbaImage image(width, height, kPaper);
    for (const glm::uvec3& triangle : mesh.triangles) {
        std::array<dvec2, 3> p;
        for (int i = 0; i < 3; ++i) {
            const glm::vec3& at = mesh.vertices[triangle[i]];
            p[static_cast<std::size_t>(i)] = perMm * dvec2(at[u] - across.least, isUp ? along.most - at[v] : at[v] - along.least);
        }
        const dvec2 low = glm::min(glm::min(p[0], p[1]), p[2]), high = glm::max(glm::max(p[0], p[1]), p[2]);
        const auto side = [](const dvec2& a, const dvec2& b, const dvec2& c) {
            return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        };
        const double all = side(p[0], p[1], p[2]);
        for (int y = std::max(0, static_cast<int>(low.y - 0.5)); y <= std::min(height - 1, static_cast<int>(high.y)); ++y)
            for (int x = std::max(0, static_cast<int>(low.x - 0.5)); x <= std::min(width - 1, static_cast<int>(high.x)); ++x) {
                const dvec2 at(x + 0.5, y + 0.5);
                if (side(p[0], p[1], at) * all >= 0 && side(p[1], p[2], at) * all >= 0 && side(p[2], p[0], at) * all >= 0)
                    image.at(x, y) = kShade;
            }
    }
    return image;
}

// The sheet. Coordinates are in the print's frame, millimetres. On paper, the lamp is on the left
// and the screen on the right.
class Sheet {
public:
    Sheet(const Fabrication& print, const theatre::PoseTarget& target) : print_(print), page_(kPaperWidth, kPaperHeight) {
        for (const glm::vec3& v : print.mesh.vertices) box_[0].add(v.x), box_[1].add(v.y), box_[2].add(v.z);
        thereX_ = box_[0], thereY_ = box_[1], thereZ_ = box_[2];
        thereX_.add(print.light.x), thereY_.add(print.light.y), thereY_.add(print.screen), thereZ_.add(print.light.z);
        for (int y = 0; y < target.mask.height(); ++y)
            for (int x = 0; x < target.mask.width(); ++x)
                if (target.mask.at(x, y))
                    for (const int step : {0, 1}) {
                        const dvec2 metres = target.frame.metresAt({x + step, y + step});
                        const dvec3 place = print.fromStage({metres.x, metres.y, 0});
                        wide_.add(place.x), high_.add(place.z);
                    }
        for (const dvec2& corner : {dvec2(0), dvec2(target.frame.width(), target.frame.height())}) {
            const dvec2 metres = target.frame.metresAt(corner);
            const dvec3 place = print.fromStage({metres.x, metres.y, 0});
            frame_[0].add(place.x), frame_[1].add(place.z);
        }
        thereX_.add(wide_.least), thereX_.add(wide_.most), thereZ_.add(high_.most);
        // Chooses the largest scale at which both views and the screen fit.
        constexpr double kRoom = 300;  // points of height for side view and plan
        const double beside = kPaperWidth - kColumn - 2 * kBorder;
        for (const double scale : kScales) {
            scale_ = scale;
            const double mm = kPoint / scale;
            if (thereY_.size() * mm <= kColumn - 60 && (thereZ_.size() + thereX_.size()) * mm <= kRoom &&
                wide_.size() * mm <= beside)
                break;
        }
        mm_ = kPoint / scale_;
        left_ = kBorder + 30;
        sideFloor_ = kBorder + 60 + thereZ_.most * mm_;
        planTop_ = sideFloor_ - thereZ_.least * mm_ + 70;
    }

    Page draw() {
        page_.text("Where to put the print, its lamp and its screen", {kBorder, kBorder}, 14, Anchor::Left);
        page_.text(fmt::format("Views 1:{:g}; distances in millimetres are exact.", scale_), {kBorder, kBorder + 18}, kText,
                   Anchor::Left);
        drawSide();
        drawPlan();
        drawScreen();
        drawFigures();
        drawBar();
        return std::move(page_);
    }

private:
    double along(double y) const { return left_ + (y - thereY_.least) * mm_; }
    dvec2 side(double y, double z) const { return {along(y), sideFloor_ - z * mm_}; }
    dvec2 plan(const dvec2& p) const { return {along(p.y), planTop_ + (p.x - thereX_.least) * mm_}; }

    void picture(const RgbaImage& picture, const dvec2& topLeft, const Range& across, const Range& down) {
        page_.picture(picture, topLeft, topLeft + mm_ * dvec2(across.size(), down.size()));
    }
    // A dimension line between two places of one row, with its length.
    void distance(double from, double to, double row) {
        const double a = along(from), b = along(to);
        page_.line({a, row}, {b, row}, kThin);
        for (const double at : {a, b}) page_.line({at, row - 4}, {at, row + 4}, kThin);
        page_.text(fmt::format("{:.1f}", std::abs(to - from)), {0.5 * (a + b), row - 7}, kText, Anchor::Middle);
    }

    void drawSide() {
        picture(filledView(print_.mesh, 1, 2, true, box_[1], box_[2], 3), side(box_[1].least, box_[2].most), box_[1], box_[2]);
        page_.line(side(thereY_.least, 0), side(thereY_.most, 0), kThin);
        page_.line(side(print_.screen, 0), side(print_.screen, thereZ_.most), kEdge);
        for (const double z : {high_.least, high_.most})
            page_.line(side(print_.light.y, print_.light.z), side(print_.screen, z), kRay);
        page_.disc(side(print_.light.y, print_.light.z), 4, kLampColour);
        page_.text("From the side", {left_, sideFloor_ - thereZ_.most * mm_ - 12}, kText + 1, Anchor::Left);
        page_.text("lamp", side(print_.light.y, print_.light.z) + dvec2(0, -10), kText, Anchor::Middle);
        page_.text("screen", side(print_.screen, thereZ_.most) + dvec2(0, -8), kText, Anchor::Middle);
        const double row = sideFloor_ - thereZ_.least * mm_ + 22;
        Range plate;
        for (const dvec2& p : print_.plate) plate.add(p.y);
        distance(print_.light.y, plate.least, row), distance(plate.least, plate.most, row);
        distance(plate.most, print_.screen, row);
        distance(print_.light.y, print_.screen, row + 18);
    }

    void drawPlan() {
        picture(turned(filledView(print_.mesh, 0, 1, false, box_[0], box_[1], 3)), plan({box_[0].least, box_[1].least}), box_[1],
                box_[0]);
        std::vector<dvec2> outline;
        for (const dvec2& p : print_.plate) outline.push_back(plan(p));
        outline.push_back(outline.front());
        page_.line(outline, kEdge);
        for (const auto& mark : print_.marks) {
            std::vector<dvec2> line;
            for (const dvec2& p : mark) line.push_back(plan(p));
            page_.line(line, kEdge);
        }
        for (const auto& contact : print_.contacts) {
            std::vector<dvec2> line;
            for (const dvec2& p : contact.outline) line.push_back(plan(p));
            if (line.empty()) continue;
            line.push_back(line.front());
            page_.line(line, {{0.75, 0.1, 0.1}, 0.8});
        }
        const dvec2 lamp(print_.light.x, print_.light.y);
        page_.line(plan({thereX_.least, print_.screen}), plan({thereX_.most, print_.screen}), kEdge);
        for (const double x : {wide_.least, wide_.most}) page_.line(plan(lamp), plan({x, print_.screen}), kRay);
        page_.line(plan(lamp), plan({lamp.x, print_.screen}), kThin);
        page_.disc(plan(lamp), 4, kLampColour);
        page_.text("From above; red: what touches the plate", {left_, planTop_ - 10}, kText + 1, Anchor::Left);
    }

    // The screen as seen from the lamp.
    void drawScreen() {
        const double x = kBorder + kColumn + 10, top = kBorder + 60;
        const Range up{std::min(0.0, high_.least), std::max(high_.most, print_.light.z)};
        RgbaImage image(print_.shadow.width(), print_.shadow.height(), kPaper);
        for (int row = 0; row < image.height(); ++row)
            for (int column = 0; column < image.width(); ++column)
                if (print_.shadow.at(column, row)) image.at(column, row) = kShade;
        const auto at = [&](double across, double z) {
            return dvec2(x + (across - wide_.least) * mm_, top + (up.most - z) * mm_);
        };
        page_.picture(image, at(frame_[0].least, frame_[1].most), at(frame_[0].most, frame_[1].least));
        page_.text("The screen, from the lamp", {x, top - 12}, kText + 1, Anchor::Left);
        page_.frame(at(wide_.least, high_.most), at(wide_.most, high_.least), {{0.75, 0.1, 0.1}, 0.8, 1, true});
        page_.line(at(wide_.least, 0), at(wide_.most, 0), kEdge);
        page_.line(at(print_.light.x, 0), at(print_.light.x, up.most), kThin);
        figuresTop_ = at(0, up.least).y + 26;
    }

    void drawFigures() {
        const double x = kBorder + kColumn + 10;
        double y = std::max(figuresTop_, 300.0);
        const auto say = [&](const std::string& text) { page_.text(text, {x, y}, kText, Anchor::Left), y += kLine; };
        say(fmt::format("print: {:.0f} high, on a plate {:.1f} thick", box_[2].most, print_.thickness));
        say(fmt::format("size {:.1f} x {:.1f}, 1:{:.2f} of the stage", box_[0].size(), box_[1].size(), 1000 / print_.scale));
        y += 0.5 * kLine;
        say(fmt::format("lamp: {:.1f} in front of the screen,", print_.screen - print_.light.y));
        say(fmt::format("{:.1f} above the plate's upper side", print_.light.z));
        say(fmt::format("{:.1f} from the arrow's tip,",
                        glm::distance(print_.marks[1][1], dvec2(print_.light.x, print_.light.y))));
        say("in the arrow's direction");
        y += 0.5 * kLine;
        say("screen: along the line across the plate,");
        say(print_.marks.size() > 2 ? fmt::format("{:.1f} from it", print_.screen - print_.marks[2][0].y)
                                    : fmt::format("{:.1f} from the plate's middle", print_.screen));
        say("its foot level with the plate's upper side");
        y += 0.5 * kLine;
        say(fmt::format("silhouette: {:.1f} wide, {:.1f} high,", wide_.size(), high_.size()));
        const auto beside = [&](double at) { return fmt::format("{:.1f} {}", std::abs(at), at < 0 ? "left" : "right"); };
        say(fmt::format("from {} to {} of the lamp's axis,", beside(wide_.least - print_.light.x),
                        beside(wide_.most - print_.light.x)));
        say(fmt::format("its foot {:.1f} above the plate's upper side", high_.least));
    }

    void drawBar() {
        const double y = kPaperHeight - kBorder, x = kBorder;
        page_.line({x, y}, {x + kBar * kPoint, y}, kEdge);
        for (int i = 0; i <= 10; ++i)
            page_.line({x + 10 * i * kPoint, y - (i % 10 == 0 ? 6 : 3)}, {x + 10 * i * kPoint, y}, kEdge);
        page_.text("100 mm on paper if printed at 100 %", {x + kBar * kPoint + 8, y - 3}, kText, Anchor::Left);
    }

    // The image with rows and columns exchanged.
    static RgbaImage turned(const RgbaImage& image) {
        RgbaImage result(image.height(), image.width(), kPaper);
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x) result.at(y, x) = image.at(x, y);
        return result;
    }

    const Fabrication& print_;
    Page page_;
    std::array<Range, 3> box_;        // of the print
    Range thereX_, thereY_, thereZ_;  // of everything drawn
    Range wide_, high_;               // of the silhouette on the screen
    std::array<Range, 2> frame_;      // of the shadow's picture
    double scale_ = 1, mm_ = kPoint;  // points per millimetre of the scene
    double left_ = 0, sideFloor_ = 0, planTop_ = 0, figuresTop_ = 0;
};

}  // namespace

RgbaImage fabricationView(const Fabrication& print, int width, int height) {
    TriangleMesh mesh = print.mesh;
    std::vector<dvec3> points;
    for (glm::vec3& v : mesh.vertices) {
        v = {v.x, v.z, -v.y};  // y up
        points.emplace_back(v);
    }
    const Camera camera = Camera::fitting(points, {-0.45, -0.55, -1}, radians(30), double(width) / height, 0.05);
    const glm::vec3 key = glm::normalize(glm::vec3(-0.5f, 0.8f, 0.5f)), eye(camera.position);
    const Surface surface{std::move(mesh), [=](const glm::vec3& place, const glm::vec3& normal) {
                              const float direct = std::max(0.0f, glm::dot(normal, key)),
                                          facing = std::max(0.0f, glm::dot(normal, glm::normalize(eye - place)));
                              return glm::vec4(kPlastic * (0.25f + 0.15f * normal.y + 0.75f * direct) * (0.6f + 0.4f * facing),
                                               1);
                          }};
    return rendered(std::array{surface}, camera, kTable, width, height);
}

Page fabricationSheet(const Fabrication& print, const theatre::PoseTarget& target) {
    Sheet sheet(print, target);
    return sheet.draw();
}

}  // namespace fantascope::plot
