#pragma once

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace fantascope::plot {

struct Stroke {
    glm::dvec3 colour{0.0};  // sRGB, 0..1
    double width = 1;        // points
    double opacity = 1;
    bool dashed = false;
};

// Which point of a text stands at the place that it is given.
enum class Anchor { Left, Middle, Right };

// A white page to draw on, in points from its top left, x right, y down; written as PNG (a pixel a
// point) or SVG. What is drawn later lies on top. Thread: thread-bound.
class Page {
public:
    Page(int width, int height);
    ~Page();
    Page(Page&&) noexcept;

    int width() const { return width_; }
    int height() const { return height_; }

    void line(std::span<const glm::dvec2> points, const Stroke& stroke);
    void line(glm::dvec2 from, glm::dvec2 to, const Stroke& stroke);
    void frame(glm::dvec2 topLeft, glm::dvec2 bottomRight, const Stroke& stroke);
    void disc(glm::dvec2 centre, double radius, glm::dvec3 colour);
    void box(glm::dvec2 topLeft, glm::dvec2 bottomRight, glm::dvec3 colour);
    void picture(const RgbaImage& picture, glm::dvec2 topLeft, glm::dvec2 bottomRight);
    void cover(glm::dvec2 topLeft, glm::dvec2 bottomRight, double opacity);  // with white
    // All that is on another page.
    void page(const Page& other, glm::dvec2 topLeft);
    // The text's middle line stands at at.y; `upwards` turns it by 90 degrees about `at`.
    void text(std::string_view text, glm::dvec2 at, double size, Anchor anchor, bool upwards = false);
    double textWidth(std::string_view text, double size) const;  // points

    // What is drawn until end() shows inside the rectangle alone.
    void clip(glm::dvec2 topLeft, glm::dvec2 bottomRight);
    void endClip();

    // By the name's end, .png or .svg; written aside and renamed. Error: another name, or the file
    // cannot be written.
    Result<void> write(const std::filesystem::path& file) const;
    // Whether write() knows what the name asks for.
    static bool knows(const std::filesystem::path& file);
    // In true size, a point being 1/72 inch: .pdf or .svg.
    Result<void> writeAsPaper(const std::filesystem::path& file) const;

private:
    struct Cairo;
    int width_, height_;
    std::unique_ptr<Cairo> cairo_;
};

}  // namespace fantascope::plot
