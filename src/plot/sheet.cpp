#include "plot/sheet.h"

#include "core/check.h"

#include <cairo.h>

#include <array>
#include <cstddef>
#include <numbers>

namespace fantascope::plot {

void Sheet::Release::operator()(_cairo_surface* surface) const { cairo_surface_destroy(surface); }
void Sheet::Release::operator()(_cairo* context) const { cairo_destroy(context); }

Sheet::Sheet(glm::ivec2 size)
    : size_(size),
      surface_(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, size.x, size.y)),
      context_(cairo_create(surface_.get())),
      unit_(std::min(size.x, size.y) / 1080.0) {
    cairo_t* const c = context_.get();
    cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
    cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
    // No sub-pixel rendering and no hinting: a text looks the same at any place.
    cairo_font_options_t* const options = cairo_font_options_create();
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(c, options);
    cairo_font_options_destroy(options);
}

void Sheet::grey(double value, double alpha) { cairo_set_source_rgba(context_.get(), value, value, value, alpha); }

void Sheet::rectangle(const Box& box, double value, double alpha) {
    grey(value, alpha);
    cairo_rectangle(context_.get(), box.low.x, box.low.y, box.size().x, box.size().y);
    cairo_fill(context_.get());
}

void Sheet::add(std::span<const glm::dvec2> points) {
    cairo_new_sub_path(context_.get());
    for (const glm::dvec2 point : points) cairo_line_to(context_.get(), point.x, point.y);
    if (points.front() == points.back()) cairo_close_path(context_.get());
}

void Sheet::add(glm::dvec2 from, glm::dvec2 to) { add(std::array{from, to}); }

void Sheet::addRing(glm::dvec2 centre, double radius) {
    cairo_new_sub_path(context_.get());
    cairo_arc(context_.get(), centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
}

void Sheet::stroke(double width, double value) {
    grey(value);
    cairo_set_line_width(context_.get(), width);
    cairo_stroke(context_.get());
}

void Sheet::rimmedStroke(double width, double value) {
    grey(0, 0.8);
    cairo_set_line_width(context_.get(), width + 2 * thin());
    cairo_stroke_preserve(context_.get());
    stroke(width, value);
}

double Sheet::textWidth(const std::string& text, double size) {
    cairo_text_extents_t extents;
    cairo_set_font_size(context_.get(), size);
    cairo_text_extents(context_.get(), text.c_str(), &extents);
    return extents.x_advance;
}

double Sheet::fontSize(const std::string& text, double width, double max) {
    return std::min(max, width / std::max(textWidth(text, 1), 1e-3));
}

void Sheet::text(const std::string& text, glm::dvec2 middle, double size, double value, bool rimmed) {
    cairo_t* const c = context_.get();
    const double left = middle.x - textWidth(text, size) / 2;
    cairo_new_path(c);
    cairo_move_to(c, left, middle.y + kCapital / 2 * size);
    if (rimmed) {
        cairo_text_path(c, text.c_str());
        grey(0, 0.8);
        cairo_set_line_width(c, 2 * thin());
        cairo_stroke(c);
        cairo_move_to(c, left, middle.y + kCapital / 2 * size);
    }
    grey(value);
    cairo_show_text(c, text.c_str());
    cairo_new_path(c);  // a text leaves a current point behind
}

void Sheet::pixels(const std::function<int(int, int)>& value) {
    cairo_surface_flush(surface_.get());
    for (int y = 0; y < size_.y; ++y) {
        std::uint32_t* const line = row(y);
        for (int x = 0; x < size_.x; ++x) line[x] = 0xff000000u | 0x010101u * static_cast<std::uint32_t>(value(x, y));
    }
    cairo_surface_mark_dirty(surface_.get());
}

RgbaImage Sheet::image(glm::ivec2 size, glm::ivec2 origin, glm::ivec2 across, glm::ivec2 down) {
    FANTASCOPE_CHECK(cairo_status(context_.get()) == CAIRO_STATUS_SUCCESS, "the texts of a test picture are UTF-8");
    cairo_surface_flush(surface_.get());
    RgbaImage image(size.x, size.y);
    for (int y = 0; y < size.y; ++y) {
        glm::ivec2 at = origin + y * down;
        for (Rgba8& pixel : image.row(y)) {
            const std::uint32_t value = row(at.y)[at.x];
            pixel = {std::uint8_t(value >> 16), std::uint8_t(value >> 8), std::uint8_t(value), std::uint8_t(value >> 24)};
            at += across;
        }
    }
    return image;
}

std::uint32_t* Sheet::row(int y) {
    unsigned char* const data = cairo_image_surface_get_data(surface_.get());
    return reinterpret_cast<std::uint32_t*>(data + std::ptrdiff_t{y} * cairo_image_surface_get_stride(surface_.get()));
}

}  // namespace fantascope::plot
