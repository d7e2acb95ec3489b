#include "app/calibrate/corner_picture.h"

#include "plot/sheet.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace fantascope::app {
namespace {

using plot::Box;

constexpr double kHeader = 44, kFooter = 108, kMargin = 16;  // pixels of the picture, as all that follows
constexpr double kTitleSize = 20, kMessageSize = 19, kHelpSize = 15, kLabelSize = 15;
constexpr double kRing = 8, kChosenRing = 12;
constexpr double kMagnifier = 176, kCaption = 24, kMagnifierAway = 40, kMinZoom = 8, kZoomOfScale = 4;
constexpr double kHatchStep = 12, kHatchWidth = 1.6;
constexpr int kEdgePieces = 24;  // of an edge that the lens bends
// Grey values.
constexpr float kBackground = 0.02f, kWall = 0.5f, kDimHatch = 0.13f, kBrightHatch = 0.62f, kMagnifiedHatch = 0.35f;
constexpr double kMarks = 0.85, kPartLines = 0.6, kText = 0.62, kBrightText = 0.9;

constexpr std::array<std::string_view, 2> kHelp = {
    "Click or drag: move the nearest corner     N: set four new corners     Backspace: take the last move back",
    "Tab: next corner     Arrows: move it by 1 pixel, with Shift 10, with Ctrl 0.1     Enter: take this place     Esc: give up"};

// How much a hatch's line covers a pixel, 0..1. `direction`: 1 or -1.
float hatch(int x, int y, int direction) {
    const double along = (x + direction * y) / kHatchStep;
    const double away = std::abs(along - std::round(along)) * kHatchStep / std::sqrt(2);  // of the line's middle
    return static_cast<float>(std::clamp(kHatchWidth / 2 + 0.5 - away, 0.0, 1.0));
}

bool isLitByAny(const OpenPlace& place, glm::dvec2 pixel) {
    for (std::size_t part = 0; part < place.reach.size(); ++part)
        if (place.reach.isLit(part, pixel)) return true;
    return false;
}

// Calls `use` for each pixel whose middle lies inside the outline.
template <class Use>
void forEachInside(const std::vector<glm::dvec2>& outline, const Box& within, const Use& use) {
    for (int y = static_cast<int>(within.low.y); y < within.high.y; ++y) {
        std::vector<double> crossings;
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
            if ((a.y <= y + 0.5) != (b.y <= y + 0.5)) crossings.push_back(a.x + (b.x - a.x) * (y + 0.5 - a.y) / (b.y - a.y));
        }
        std::ranges::sort(crossings);
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
            for (int x = static_cast<int>(std::ceil(std::max(crossings[i], within.low.x) - 0.5));
                 x + 0.5 < std::min(crossings[i + 1], within.high.x); ++x)
                use(x, y);
    }
}

// A picture of one hue, which disturbs eyes in the dark less than white does.
void tint(RgbaImage& image) {
    for (Rgba8& pixel : image.pixels())
        pixel = {pixel.r, static_cast<std::uint8_t>(pixel.g * 4 / 5), static_cast<std::uint8_t>(pixel.b * 9 / 20), 255};
}

RgbaImage imageOf(plot::Sheet& sheet) { return sheet.image(sheet.size(), {0, 0}, {1, 0}, {0, 1}); }

void fill(plot::Sheet& sheet, const GreyImage& ground) {
    sheet.pixels([&](int x, int y) { return static_cast<int>(std::lround(255 * std::clamp(ground.at(x, y), 0.0f, 1.0f))); });
}

// A text that begins or ends at a place, or has its middle there.
void write(plot::Sheet& sheet, const std::string& text, glm::dvec2 at, double size, double value, double anchor = 0) {
    sheet.text(text, at + glm::dvec2((0.5 - anchor) * sheet.textWidth(text, size), 0), size, value, true);
}

// One picture of a choice.
class Drawing {
public:
    Drawing(const CornerPicture& picture, const OpenPlace& place, const CornerView& view)
        : picture_(picture), place_(place), view_(view), sheet_(CornerPicture::kSize) {
        wallBox_ = {picture.pictureFromCamera(glm::dvec2(0)), picture.pictureFromCamera(glm::dvec2(place.camera.size))};
        if (view.corners.size() != 4) return;
        std::array<glm::dvec2, 4> corners;
        std::ranges::copy(view.corners, corners.begin());
        if (auto canvas = vision::PlacedCanvas::of(place.camera, corners)) canvas_ = std::move(canvas).value();
    }

    RgbaImage draw(const GreyImage& wall) {
        GreyImage ground(sheet_.size().x, sheet_.size().y, kBackground);
        const glm::ivec2 corner(wallBox_.low);
        for (int y = 0; y < wall.height(); ++y) std::ranges::copy(wall.row(y), ground.row(corner.y + y).begin() + corner.x);
        hatchUnlit(ground);
        fill(sheet_, ground);
        drawCanvas();
        drawTexts();
        RgbaImage image = imageOf(sheet_);
        if (!view_.corners.empty()) pasteMagnifier(image);
        tint(image);
        return image;
    }

private:
    // The outline of a rectangle of the unit canvas, camera pixels.
    std::vector<glm::dvec2> outlineOf(const CanvasPart& part) const {
        std::vector<glm::dvec2> outline;
        const auto corners = rectangleCorners(1, 1);
        for (int i = 0; i < 4 * kEdgePieces; ++i) {
            const auto edge = static_cast<std::size_t>(i / kEdgePieces);
            const glm::dvec2 share = glm::mix(corners[edge], corners[(edge + 1) % 4], double(i % kEdgePieces) / kEdgePieces);
            outline.push_back(canvas_->pixelFromCanvas(glm::mix(part.low, part.high, share)).value_or(glm::dvec2(0)));
        }
        return outline;
    }
    // As it is chosen so far.
    std::vector<glm::dvec2> outline() const { return canvas_ ? outlineOf({}) : view_.corners; }

    // Of each part, what its own output does not light.
    void hatchUnlit(GreyImage& ground) const {
        for (std::size_t part = 0; canvas_ && part < place_.reach.size(); ++part) {
            std::vector<glm::dvec2> shape = outlineOf(place_.reach.part(part));
            for (glm::dvec2& point : shape) point = picture_.pictureFromCamera(point);
            forEachInside(shape, wallBox_, [&](int x, int y) {
                if (place_.reach.isLit(part, picture_.cameraFromPicture(glm::dvec2(x, y) + 0.5))) return;
                ground.at(x, y) = glm::mix(ground.at(x, y), kBrightHatch, hatch(x, y, -1));
            });
        }
    }

    // Strokes a line through camera pixels on a sheet with coordinates of its own.
    template <class ToSheet>
    void stroke(plot::Sheet& sheet, std::vector<glm::dvec2> line, bool closed, double width, double value,
                const ToSheet& toSheet) const {
        for (glm::dvec2& point : line) point = toSheet(point);
        if (closed) line.push_back(line.front());
        sheet.add(line);
        sheet.rimmedStroke(width, value);
    }

    void drawCanvas() {
        const auto toSheet = [&](glm::dvec2 pixel) { return picture_.pictureFromCamera(pixel); };
        for (std::size_t part = 0; canvas_ && place_.reach.size() > 1 && part < place_.reach.size(); ++part)
            stroke(sheet_, outlineOf(place_.reach.part(part)), true, 1, kPartLines, toSheet);
        if (view_.corners.size() > 1) stroke(sheet_, outline(), view_.corners.size() == 4, 2, kMarks, toSheet);
        for (std::size_t i = 0; i < view_.corners.size(); ++i) {
            const bool chosen = i == view_.chosen;
            const glm::dvec2 at = toSheet(view_.corners[i]);
            sheet_.addRing(at, chosen ? kChosenRing : kRing);
            if (chosen)
                for (const glm::dvec2 arm : {glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(-1, 0), glm::dvec2(0, -1)})
                    sheet_.add(at + 0.5 * kChosenRing * arm, at + 1.7 * kChosenRing * arm);
            sheet_.rimmedStroke(chosen ? 2.5 : 1.5, chosen ? 1 : kMarks);
            if (!chosen) drawLabel(i);
        }
    }
    void drawLabel(std::size_t corner) {
        const std::string name(CornerPicture::kCorners[corner]);
        sheet_.text(name, labelBox(corner).middle(), kLabelSize, kBrightText, true);
    }
    // Beside a corner, on the outer side of the canvas.
    Box labelBox(std::size_t corner) {
        const std::string name(CornerPicture::kCorners[corner]);
        const glm::dvec2 at = picture_.pictureFromCamera(view_.corners[corner]);
        const glm::dvec2 half(sheet_.textWidth(name, kLabelSize) / 2 + 4, kLabelSize / 2 + 4);
        const glm::dvec2 side = glm::mix(glm::dvec2(-1), glm::dvec2(1), glm::greaterThan(at, middle()));
        const glm::dvec2 place = glm::clamp(at + side * (half + kRing), wallBox_.low + half, wallBox_.high - half);
        return {place - half, place + half};
    }
    glm::dvec2 middle() const {
        glm::dvec2 sum(0);
        for (const glm::dvec2 corner : view_.corners) sum += picture_.pictureFromCamera(corner);
        return sum / double(view_.corners.size());
    }

    void drawTexts() {
        const glm::dvec2 size(sheet_.size());
        const auto fitting = [&](const std::string& text, double most) {
            return sheet_.fontSize(text, size.x - 2 * kMargin, most);
        };
        write(sheet_, view_.title, {kMargin, kHeader / 2}, fitting(view_.title, kTitleSize), kText);
        const double top = size.y - kFooter;
        if (view_.isRefusal) sheet_.rectangle({{0, top + 6}, {size.x, top + 40}}, 0.3);
        write(sheet_, view_.message, {kMargin, top + 23}, fitting(view_.message, kMessageSize),
              view_.isRefusal ? 1 : kBrightText);
        for (std::size_t i = 0; i < kHelp.size(); ++i)
            write(sheet_, std::string(kHelp[i]), {kMargin, top + 58 + 26 * double(i)}, kHelpSize, kText);
    }

    // Where the magnifier covers the least: outside the canvas if there is room.
    Box magnifierBox() {
        const glm::dvec2 at = picture_.pictureFromCamera(view_.corners[view_.chosen]), size(kMagnifier, kMagnifier + kCaption);
        const glm::dvec2 outer = glm::mix(glm::dvec2(-1), glm::dvec2(1), glm::greaterThan(at, middle()));
        Box best{};
        double least = 1e9;
        for (const glm::dvec2 side : {glm::dvec2(1, 1), glm::dvec2(1, -1), glm::dvec2(-1, 1), glm::dvec2(-1, -1)}) {
            const glm::dvec2 wanted = at + side * outer * (kMagnifierAway + size / 2.0);
            const glm::dvec2 centre = glm::clamp(wanted, wallArea().low + size / 2.0, wallArea().high - size / 2.0);
            const Box box{glm::round(centre - size / 2.0), glm::round(centre - size / 2.0) + size};
            double cost = glm::distance(centre, wanted) + (side == glm::dvec2(-1) ? 150 : 0);
            for (std::size_t i = 0; i < view_.corners.size(); ++i) {
                const glm::dvec2 corner = picture_.pictureFromCamera(view_.corners[i]);
                if (meet(box, {corner - 2 * kRing, corner + 2 * kRing})) cost += i == view_.chosen ? 10'000 : 1000;
                if (i != view_.chosen && meet(box, labelBox(i))) cost += 300;
            }
            if (cost < least) least = cost, best = box;
        }
        return best;
    }
    static bool meet(const Box& a, const Box& b) {
        return glm::all(glm::lessThan(glm::max(a.low, b.low), glm::min(a.high, b.high)));
    }
    static Box wallArea() { return {{0, kHeader}, glm::dvec2(CornerPicture::kSize) - glm::dvec2(0, kFooter)}; }

    void pasteMagnifier(RgbaImage& image) {
        const Box box = magnifierBox();
        const glm::dvec2 corner = view_.corners[view_.chosen];
        const double zoom = std::max(kMinZoom, std::round(kZoomOfScale * picture_.scale()));
        const auto toSheet = [&](glm::dvec2 pixel) { return kMagnifier / 2 + (pixel - corner) * zoom; };
        plot::Sheet sheet(glm::ivec2(box.size()));
        fill(sheet, magnified(corner, zoom, sheet.size()));
        if (view_.corners.size() > 1) stroke(sheet, outline(), view_.corners.size() == 4, 1.5, kMarks, toSheet);
        const glm::dvec2 middle(kMagnifier / 2);
        for (const glm::dvec2 arm : {glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(-1, 0), glm::dvec2(0, -1)})
            sheet.add(middle + 5.0 * arm, middle + 22.0 * arm);
        sheet.rimmedStroke(2, 1);
        sheet.rectangle({{0, kMagnifier}, {kMagnifier, kMagnifier + kCaption}}, 0.12);
        const std::string caption = fmt::format("{}  {:.1f}, {:.1f}", CornerPicture::kCorners[view_.chosen], corner.x, corner.y);
        write(sheet, caption, {kMagnifier / 2, kMagnifier + kCaption / 2}, sheet.fontSize(caption, kMagnifier - 10, kLabelSize),
              kBrightText, 0.5);
        const glm::dvec2 end(sheet.size());
        sheet.add(std::array{glm::dvec2(1, 1), glm::dvec2(end.x - 1, 1), end - 1.0, glm::dvec2(1, end.y - 1), glm::dvec2(1, 1)});
        sheet.stroke(2, kText);
        const RgbaImage glass = imageOf(sheet);
        const glm::ivec2 low(box.low);
        for (int y = 0; y < glass.height(); ++y) std::ranges::copy(glass.row(y), image.row(low.y + y).begin() + low.x);
    }
    // The camera's pixels around a corner, with more contrast if they have little. What no output
    // lights is hatched.
    GreyImage magnified(glm::dvec2 corner, double zoom, glm::ivec2 size) const {
        GreyImage glass(size.x, size.y);
        const auto pixelAt = [&](int x, int y) { return corner + (glm::dvec2(x, y) + 0.5 - kMagnifier / 2) / zoom; };
        float low = 1, high = 0;
        const auto forEachSeen = [&](const auto& use) {
            for (int y = 0; y < size.x; ++y)
                for (int x = 0; x < size.x; ++x)
                    if (const glm::dvec2 pixel = pixelAt(x, y); place_.camera.inPicture(pixel))
                        use(x, y, pixel,
                            place_.picture.at(std::min(int(pixel.x), place_.camera.size.x - 1),
                                              std::min(int(pixel.y), place_.camera.size.y - 1)));
        };
        forEachSeen([&](int, int, glm::dvec2, float value) { low = std::min(low, value), high = std::max(high, value); });
        constexpr float kLeastRange = 0.25f;
        const float range = std::max(high - low, kLeastRange), from = std::clamp((low + high - range) / 2, 0.0f, 1 - range);
        forEachSeen([&](int x, int y, glm::dvec2 pixel, float value) {
            glass.at(x, y) = 0.05f + (value - from) / range * 1.1f * kWall;
            if (!isLitByAny(place_, pixel)) glass.at(x, y) = std::max(glass.at(x, y), kMagnifiedHatch * hatch(x, y, 1));
        });
        return glass;
    }

    const CornerPicture& picture_;
    const OpenPlace& place_;
    const CornerView& view_;
    plot::Sheet sheet_;
    Box wallBox_{};  // of the camera's picture
    std::optional<vision::PlacedCanvas> canvas_;
};

}  // namespace

CornerPicture::CornerPicture(const OpenPlace& place) : place_(place) {
    const glm::dvec2 room = glm::dvec2(kSize) - glm::dvec2(0, kHeader + kFooter), camera(place.camera.size);
    scale_ = std::min(room.x / camera.x, room.y / camera.y);
    const glm::ivec2 size = glm::max(glm::ivec2(camera * scale_), glm::ivec2(1));
    corner_ = glm::round((room - glm::dvec2(size)) / 2.0) + glm::dvec2(0, kHeader);
    wall_ = resized(place.picture, size.x, size.y);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            float& value = wall_.at(x, y);
            value *= kWall;
            if (!isLitByAny(place, (glm::dvec2(x, y) + 0.5) / scale_)) value = std::max(value, kDimHatch * hatch(x, y, 1));
        }
}

RgbaImage CornerPicture::drawn(const CornerView& view) const { return Drawing(*this, place_, view).draw(wall_); }

}  // namespace fantascope::app
