#pragma once
// The drawing surface of the pictures for setting up a projector.

#include "media/image.h"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

struct _cairo;  // cairo's own names of its context and surface types
struct _cairo_surface;

namespace fantascope::plot {

inline constexpr double kCapital = 0.73;  // height of a capital letter, as a share of the font size

struct Box {
    glm::dvec2 low, high;
    glm::dvec2 size() const { return high - low; }
    glm::dvec2 middle() const { return (low + high) / 2.0; }
};

// A transparent sheet on which everything is drawn in grey. Pixels, y down.
class Sheet {
public:
    explicit Sheet(glm::ivec2 size);

    glm::ivec2 size() const { return size_; }
    Box all() const { return {glm::dvec2(0), glm::dvec2(size_)}; }
    double unit() const { return unit_; }  // pixels: one if the picture has 1080 rows
    double thin() const { return std::max(1.0, 1.5 * unit_); }
    _cairo* context() { return context_.get(); }

    void grey(double value, double alpha = 1);

    void rectangle(const Box& box, double value, double alpha = 1);

    void add(std::span<const glm::dvec2> points);
    void add(glm::dvec2 from, glm::dvec2 to);
    void addRing(glm::dvec2 centre, double radius);

    void stroke(double width, double value);
    // A light line with a dark rim, visible on any picture.
    void rimmedStroke(double width, double value);

    double textWidth(const std::string& text, double size);
    // The largest font size up to `max` at which `text` is no wider than `width`.
    double fontSize(const std::string& text, double width, double max);
    // The middle of its capital letters lies at `middle`.
    void text(const std::string& text, glm::dvec2 middle, double size, double value, bool rimmed = false);

    // Sets every pixel to the stored grey value(x, y), 0..255, row by row from the top left.
    void pixels(const std::function<int(int, int)>& value);

    // A rotated or mirrored copy. `origin`: the pixel that becomes its top left one; `across`,
    // `down`: the steps to that pixel's right and lower neighbours.
    RgbaImage image(glm::ivec2 size, glm::ivec2 origin, glm::ivec2 across, glm::ivec2 down);

private:
    struct Release {
        void operator()(_cairo_surface* surface) const;
        void operator()(_cairo* context) const;
    };
    std::uint32_t* row(int y);

    glm::ivec2 size_;
    std::unique_ptr<_cairo_surface, Release> surface_;
    std::unique_ptr<_cairo, Release> context_;
    double unit_;
};

}  // namespace fantascope::plot
