#include "app/export/guide_template.h"

#include "core/check.h"
#include "core/parallel.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

namespace fantascope::app {
namespace {

constexpr double kOffSurface = 0.05;  // metres: what is farther from the surface's plane is another object
constexpr int kSide = 2;              // samples per pixel in each direction
constexpr int kBand = 32;             // rows that are processed together
constexpr int kReach = 2;             // half an outline's width, samples
constexpr float kCrease = 0.75f;      // cosine of the angle between normals below which a fold is outlined
constexpr float kStep = 0.03f;        // jump in depth that is outlined, as a share of the distance
constexpr float kFlat = 0.97f;        // no lines of an axis if its cosine with the normal is greater: they would be noise

constexpr glm::vec3 kOutline{0.05f, 0.05f, 0.08f}, kGrid{0.12f, 0.2f, 0.32f}, kInTheWay{0.95f, 0.5f, 0.05f},
    kNoLight{0.85f, 0.1f, 0.1f}, kNothing{0.1f, 0.13f, 0.2f};
constexpr std::array<glm::vec3, 3> kAxes{{{0.85f, 0.15f, 0.15f}, {0.1f, 0.6f, 0.15f}, {0.15f, 0.3f, 0.9f}}};  // x, y, z

// What the light from one point of the canvas hits.
struct Sample {
    Meets meets = Meets::NoLight;
    std::int32_t object = -1;
    bool inTheWay = false;  // in front of the surface, shading it
    float distance = 0;
    glm::vec3 point{0}, normal{0}, reflectance{0};
};

class CanvasSight {
public:
    CanvasSight(const CanvasView& view, glm::ivec2 size)
        : view_(view), scene_(view.objects), size_(size), part_(view.warp.shape().part) {}

    Sample at(glm::dvec2 pixel) const {
        Sample sample;
        const glm::dvec2 canvas = pixel / glm::dvec2(size_), sent = view_.warp.projectorFromCanvas(canvas);
        const bool shown =
            canvas.x >= part_.low.x && canvas.y >= part_.low.y && canvas.x <= part_.high.x && canvas.y <= part_.high.y;
        if (!shown || !view_.projector.inPicture(sent)) return sample;
        const vision::Ray ray = view_.projector.rayThrough(sent);
        const auto hit = scene_.nearest(ray.origin, ray.direction);
        sample.meets = Meets::Nothing;
        if (!hit) return sample;
        sample.object = static_cast<std::int32_t>(hit->object);
        sample.distance = hit->distance;
        sample.point = hit->point;
        sample.normal = hit->normal;
        sample.reflectance = hit->reflectance;
        const double before = view_.surface ? glm::dot(glm::dvec3(hit->point) - view_.surface->point, view_.surface->normal) : 0;
        sample.meets = std::abs(before) > kOffSurface ? Meets::Object : Meets::Surface;
        sample.inTheWay = before > kOffSurface;
        return sample;
    }

    // Where a point of the world lies in the picture; nothing if it is behind the projector.
    std::optional<glm::dvec2> pixelOf(glm::dvec3 point) const {
        const auto sent = view_.projector.pixelFromWorld(point);
        if (!sent) return std::nullopt;
        const auto canvas = view_.warp.canvasFromProjector(*sent);
        if (!canvas) return std::nullopt;
        return *canvas * glm::dvec2(size_);
    }

    glm::ivec2 size() const { return size_; }
    const CanvasView& view() const { return view_; }

private:
    const CanvasView& view_;
    const site::Scene scene_;
    const glm::ivec2 size_;
    const CanvasPart part_;
};

// The index of the grid line of `axis` that runs between two samples of one object, if there is
// one.
std::optional<int> lineBetween(const Sample& a, const Sample& b, int axis, double grid) {
    if (a.object != b.object || a.object < 0) return std::nullopt;
    if (std::max(std::abs(a.normal[axis]), std::abs(b.normal[axis])) > kFlat) return std::nullopt;
    const auto cell = [&](const Sample& sample) { return static_cast<int>(std::floor(sample.point[axis] / grid)); };
    if (cell(a) == cell(b)) return std::nullopt;
    return std::max(cell(a), cell(b));
}

bool outlined(const Sample& a, const Sample& b) {
    if (a.meets == Meets::NoLight || b.meets == Meets::NoLight || a.object != b.object) return a.object != b.object;
    if (a.object < 0) return false;
    return glm::dot(a.normal, b.normal) < kCrease || std::abs(a.distance - b.distance) > kStep * std::min(a.distance, b.distance);
}

// Shades in stored values, since this is a picture to look at and not light.
glm::vec3 shaded(const Sample& sample, glm::vec3 towardsProjector) {
    const float cosine = std::abs(glm::dot(sample.normal, towardsProjector));
    glm::vec3 colour;
    for (int i = 0; i < 3; ++i) colour[i] = srgbFromLinear(sample.reflectance[i]);
    return colour * (0.45f + 0.55f * cosine);
}

// Whether a pixel is on a line of the hatching.
bool hatched(glm::dvec2 pixel, bool rising, double scale) {
    const double period = 16 * scale, along = (rising ? pixel.x + pixel.y : pixel.x - pixel.y) / period;
    return along - std::floor(along) < 0.18;
}

class Painter {
public:
    Painter(const CanvasSight& sight, double grid) : sight_(sight), grid_(grid), scale_(std::max(1.0, sight.size().y / 1080.0)) {}

    // Paints the rows from `first` on.
    void paint(int first, GuideTemplate& out) const {
        const int rows = std::min(kBand, out.picture.height() - first), across = out.picture.width() * kSide + 2 * kReach,
                  down = rows * kSide + 2 * kReach;
        Image<Sample> samples(across, down);
        const auto placeOf = [&](int x, int y) {
            return glm::dvec2((x - kReach + 0.5) / kSide, first + (y - kReach + 0.5) / kSide);
        };
        for (int y = 0; y < down; ++y)
            for (int x = 0; x < across; ++x) samples.at(x, y) = sight_.at(placeOf(x, y));
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < out.picture.width(); ++x) {
                glm::vec3 sum(0);
                for (int i = 0; i < kSide * kSide; ++i) {
                    const int sx = x * kSide + i % kSide + kReach, sy = y * kSide + i / kSide + kReach;
                    sum += colourOf(samples, sx, sy, placeOf(sx, sy));
                }
                const glm::vec3 mean = 255.0f * glm::clamp(sum / static_cast<float>(kSide * kSide), 0.0f, 1.0f) + 0.5f;
                out.picture.at(x, first + y) = {static_cast<std::uint8_t>(mean.r), static_cast<std::uint8_t>(mean.g),
                                                static_cast<std::uint8_t>(mean.b), 255};
                const Sample middle = sight_.at({x + 0.5, first + y + 0.5});
                out.meets.at(x, first + y) = middle.meets;
                out.object.at(x, first + y) = middle.object;
            }
    }

private:
    glm::vec3 colourOf(const Image<Sample>& samples, int x, int y, glm::dvec2 pixel) const {
        const Sample& sample = samples.at(x, y);
        const std::array<const Sample*, 4> far = {&samples.at(x - kReach, y), &samples.at(x + kReach, y),
                                                  &samples.at(x, y - kReach), &samples.at(x, y + kReach)};
        if (std::ranges::any_of(far, [&](const Sample* other) { return outlined(sample, *other); })) return kOutline;
        if (sample.meets == Meets::NoLight) {
            const bool line = hatched(pixel, true, scale_) || hatched(pixel, false, scale_);
            return line ? kNoLight : kNothing;
        }
        if (sample.meets == Meets::Nothing) return hatched(pixel, false, scale_) ? 2.5f * kNothing : kNothing;

        const glm::vec3 towards = glm::normalize(glm::vec3(sight_.view().projector.pose.position) - sample.point);
        glm::vec3 colour = shaded(sample, towards);
        if (sample.inTheWay && hatched(pixel, true, scale_)) colour = glm::mix(colour, kInTheWay, 0.6f);
        for (const Sample* near : {&samples.at(x - 1, y), &samples.at(x + 1, y), &samples.at(x, y - 1), &samples.at(x, y + 1)})
            for (int axis = 0; axis < 3; ++axis)
                if (const auto line = lineBetween(sample, *near, axis, grid_)) {
                    // The line at coordinate 0 has the colour of its axis.
                    if (*line == 0) return glm::mix(colour, kAxes[static_cast<std::size_t>(axis)], 0.9f);
                    return glm::mix(colour, kGrid, 0.55f);
                }
        return colour;
    }

    const CanvasSight& sight_;
    const double grid_, scale_;  // metres; scale of marks, by the picture's size
};

// Draws lines and letters over the picture, light with a dark rim, to be readable on any
// background.
class Lettering {
public:
    explicit Lettering(RgbaImage& picture)
        : canvas_(picture.height(), picture.width(), CV_8UC4, picture.pixels().data()),
          unit_(std::max(1.0, picture.height() / 1080.0)) {}

    double unit() const { return unit_; }
    cv::Size sizeOf(const std::string& text) const {
        return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.7 * unit_, thickness(), nullptr);
    }
    // Writes with the bottom left corner at `at`, moved into the picture if necessary.
    void write(const std::string& text, glm::dvec2 at) {
        const cv::Size size = sizeOf(text);
        const int margin = static_cast<int>(6 * unit_);
        const auto into = [&](double value, int length, int least, int whole) {
            return std::clamp(static_cast<int>(value), least, std::max(least, whole - margin - length));
        };
        const cv::Point corner(into(at.x, size.width, margin, canvas_.cols), into(at.y, 0, margin + size.height, canvas_.rows));
        put(text, corner, {0, 0, 0, 255}, thickness() + static_cast<int>(3 * unit_));
        put(text, corner, {255, 255, 255, 255}, thickness());
    }
    void arrow(glm::dvec2 from, glm::dvec2 to, glm::vec3 colour) {
        const cv::Point a(static_cast<int>(from.x), static_cast<int>(from.y)), b(static_cast<int>(to.x), static_cast<int>(to.y));
        const cv::Scalar ink(255 * colour.r, 255 * colour.g, 255 * colour.b, 255);
        cv::arrowedLine(canvas_, a, b, {255, 255, 255, 255}, thickness() + static_cast<int>(4 * unit_), cv::LINE_AA, 0, 0.15);
        cv::arrowedLine(canvas_, a, b, ink, thickness() + static_cast<int>(unit_), cv::LINE_AA, 0, 0.15);
    }
    void frame() {
        cv::rectangle(canvas_, {0, 0}, {canvas_.cols - 1, canvas_.rows - 1}, {255, 255, 255, 255}, static_cast<int>(2 * unit_));
    }

private:
    int thickness() const { return static_cast<int>(std::lround(2 * unit_)); }
    void put(const std::string& text, cv::Point corner, const cv::Scalar& colour, int thick) {
        cv::putText(canvas_, text, corner, cv::FONT_HERSHEY_SIMPLEX, 0.7 * unit_, colour, thick, cv::LINE_AA);
    }
    cv::Mat canvas_;
    double unit_;
};

// Labels each grid line on the surface with its coordinate at the picture's lower and left borders.
void labelGrid(const CanvasSight& sight, double grid, Lettering& lettering) {
    const glm::ivec2 size = sight.size();
    const double inset = 14 * lettering.unit();
    const auto walk = [&](glm::dvec2 from, glm::dvec2 step, int count, double room) {
        double free = 0;
        Sample before = sight.at(from);
        for (int i = 1; i < count; ++i) {
            const Sample here = sight.at(from + step * static_cast<double>(i));
            for (int axis = 0; axis < 3; ++axis) {
                const auto line = lineBetween(before, here, axis, grid);
                if (!line || here.meets != Meets::Surface || i < free) continue;
                lettering.write(fmt::format("{} {:g}", "xyz"[axis], *line * grid),
                                from + step * static_cast<double>(i) + glm::dvec2(3, -3));
                free = i + room;
            }
            before = here;
        }
    };
    walk({0.5, size.y - inset}, {1, 0}, size.x, 90 * lettering.unit());
    walk({inset / 2, size.y - 40 * lettering.unit()}, {0, -1}, size.y - static_cast<int>(40 * lettering.unit()),
         28 * lettering.unit());
}

// Draws the world's axes as arrows as long as a grid cell.
void drawAxes(const CanvasSight& sight, double grid, Lettering& lettering) {
    const glm::dvec2 middle = glm::dvec2(sight.size()) / 2.0;
    const Sample sample = sight.at(middle);
    if (sample.object < 0) return;
    constexpr std::array<std::string_view, 3> kNames{"x", "y up", "z"};
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 tip = sample.point;
        tip[axis] += grid;
        const auto pixel = sight.pixelOf(tip);
        if (!pixel || glm::distance(*pixel, middle) < 12 * lettering.unit()) continue;
        const auto index = static_cast<std::size_t>(axis);
        lettering.arrow(middle, *pixel, kAxes[index]);
        lettering.write(std::string(kNames[index]), *pixel + glm::dvec2(8, 0) * lettering.unit());
    }
}

// Labels every visible object except the surface with its name, in the middle of its visible part.
void labelObjects(const GuideTemplate& drawn, const std::vector<site::SceneObject>& objects, Lettering& lettering) {
    struct Seen {
        glm::dvec2 sum{0.0};
        std::int64_t pixels = 0;
    };
    std::vector<Seen> seen(objects.size());
    for (int y = 0; y < drawn.meets.height(); ++y)
        for (int x = 0; x < drawn.meets.width(); ++x)
            if (drawn.meets.at(x, y) == Meets::Object) {
                Seen& object = seen[static_cast<std::size_t>(drawn.object.at(x, y))];
                object.sum += glm::dvec2(x, y);
                ++object.pixels;
            }
    constexpr double kMin = 2e-4;  // share of the picture below which an object is smaller than its name
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (static_cast<double>(seen[i].pixels) < kMin * static_cast<double>(drawn.meets.pixels().size())) continue;
        const glm::dvec2 half(lettering.sizeOf(objects[i].name).width / 2.0, 0);
        lettering.write(objects[i].name, seen[i].sum / static_cast<double>(seen[i].pixels) - half);
    }
}

}  // namespace

GuideTemplate drawGuideTemplate(const CanvasView& view, glm::ivec2 size, double grid, int threads) {
    FANTASCOPE_CHECK(size.x > 0 && size.y > 0 && grid > 0, "the picture has pixels and a grid");
    GuideTemplate drawn{RgbaImage(size.x, size.y), Image<Meets>(size.x, size.y), Image<std::int32_t>(size.x, size.y)};
    const CanvasSight sight(view, size);
    const Painter painter(sight, grid);
    parallelFor((size.y + kBand - 1) / kBand, threads, [&](int band) { painter.paint(band * kBand, drawn); });

    Lettering lettering(drawn.picture);
    labelGrid(sight, grid, lettering);
    labelObjects(drawn, view.objects, lettering);
    drawAxes(sight, grid, lettering);
    const auto metres = view.sizeOnSurface();
    const std::string title = metres ? fmt::format("{}  {:.2f} x {:.2f} m  grid {:g} m", view.name, metres->x, metres->y, grid)
                                     : fmt::format("{}  grid {:g} m", view.name, grid);
    lettering.write(title, glm::dvec2(10, 30) * lettering.unit());
    lettering.write("top", {size.x / 2.0 - lettering.sizeOf("top").width / 2.0, 30 * lettering.unit()});
    lettering.frame();
    return drawn;
}

}  // namespace fantascope::app
