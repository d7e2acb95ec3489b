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

// Which point of a text lies at the given place.
enum class Anchor { Left, Middle, Right };

// A white page to draw on, in points from its top left, x right, y down. It can be written as PNG
// (one pixel per point) or SVG. Later drawing lies on top. Thread: thread-bound.
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
    // Fills a polygon.
    void area(std::span<const glm::dvec2> outline, glm::dvec3 colour, double opacity);
    void picture(const RgbaImage& picture, glm::dvec2 topLeft, glm::dvec2 bottomRight);
    void cover(glm::dvec2 topLeft, glm::dvec2 bottomRight, double opacity);  // with white
    // Draws everything that is on another page.
    void page(const Page& other, glm::dvec2 topLeft);
    // The text's middle line is at at.y. `upwards`: rotated by 90 degrees about `at`, reading
    // upwards.
    void text(std::string_view text, glm::dvec2 at, double size, Anchor anchor, bool upwards = false);
    double textWidth(std::string_view text, double size) const;  // points
    // The text, or as much of its beginning as is no wider than `width`, with "..." at its end.
    std::string shortened(std::string_view text, double size, double width) const;

    // Clips everything drawn until endClip() to the rectangle.
    void clip(glm::dvec2 topLeft, glm::dvec2 bottomRight);
    void endClip();

    // Writes the format of the file's ending, .png or .svg, to a temporary file and renames it.
    // Error: another ending, or the file cannot be written.
    Result<void> write(const std::filesystem::path& file) const;
    // Whether write() knows the file's ending.
    static bool knows(const std::filesystem::path& file);
    // The same in true size, with points of 1/72 inch: .pdf or .svg.
    Result<void> writeAsPaper(const std::filesystem::path& file) const;

private:
    struct Cairo;
    int width_, height_;
    std::unique_ptr<Cairo> cairo_;
};

}  // namespace fantascope::plot
