#include "plot/page.h"

#include "core/file.h"
#include "core/text.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

namespace fantascope::plot {
namespace {

struct Release {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using CairoSurface = std::unique_ptr<cairo_surface_t, Release>;
using Context = std::unique_ptr<cairo_t, Release>;

cairo_status_t append(void* bytes, const unsigned char* data, unsigned count) {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), count);
    return CAIRO_STATUS_SUCCESS;
}

}  // namespace

// Records what is drawn, to replay it in any format.
struct Page::Cairo {
    CairoSurface surface;
    Context context;

    // Replays on `target`, whose output goes into `bytes`, finishes it and writes the bytes to the
    // file.
    Result<void> drawOn(cairo_surface_t* target, const std::filesystem::path& file, std::string& bytes) const {
        {
            const Context copy(cairo_create(target));
            cairo_set_source_surface(copy.get(), surface.get(), 0, 0);
            cairo_paint(copy.get());
        }
        if (cairo_surface_get_type(target) == CAIRO_SURFACE_TYPE_IMAGE) cairo_surface_write_to_png_stream(target, append, &bytes);
        cairo_surface_finish(target);
        if (const cairo_status_t status = cairo_surface_status(target); status != CAIRO_STATUS_SUCCESS)
            return Error(fmt::format("{}: cannot be drawn: {}", file.string(), cairo_status_to_string(status)));
        return writeFile(file, bytes);
    }
};

Page::Page(int width, int height) : width_(width), height_(height), cairo_(new Cairo) {
    const cairo_rectangle_t all{0, 0, static_cast<double>(width), static_cast<double>(height)};
    cairo_->surface.reset(cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, &all));
    cairo_->context.reset(cairo_create(cairo_->surface.get()));
    cairo_t* const context = cairo_->context.get();
    cairo_set_source_rgb(context, 1, 1, 1);
    cairo_paint(context);
    cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
    cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
}

Page::~Page() = default;
Page::Page(Page&&) noexcept = default;

void Page::line(std::span<const glm::dvec2> points, const Stroke& stroke) {
    cairo_t* const context = cairo_->context.get();
    const std::array<double, 2> dashes{6, 4};
    cairo_set_dash(context, dashes.data(), stroke.dashed ? 2 : 0, 0);
    cairo_set_source_rgba(context, stroke.colour.r, stroke.colour.g, stroke.colour.b, stroke.opacity);
    cairo_set_line_width(context, stroke.width);
    cairo_new_path(context);  // a text leaves a current point behind
    for (const glm::dvec2 point : points) cairo_line_to(context, point.x, point.y);
    cairo_stroke(context);
}

void Page::line(glm::dvec2 from, glm::dvec2 to, const Stroke& stroke) { line(std::array{from, to}, stroke); }

void Page::frame(glm::dvec2 topLeft, glm::dvec2 bottomRight, const Stroke& stroke) {
    const glm::dvec2 topRight(bottomRight.x, topLeft.y), bottomLeft(topLeft.x, bottomRight.y);
    line(std::array{topLeft, topRight, bottomRight, bottomLeft, topLeft}, stroke);
}

void Page::disc(glm::dvec2 centre, double radius, glm::dvec3 colour) {
    cairo_t* const context = cairo_->context.get();
    cairo_set_source_rgb(context, colour.r, colour.g, colour.b);
    cairo_new_path(context);
    cairo_arc(context, centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
    cairo_fill(context);
}

void Page::box(glm::dvec2 topLeft, glm::dvec2 bottomRight, glm::dvec3 colour) {
    cairo_t* const context = cairo_->context.get();
    cairo_set_source_rgb(context, colour.r, colour.g, colour.b);
    cairo_rectangle(context, topLeft.x, topLeft.y, bottomRight.x - topLeft.x, bottomRight.y - topLeft.y);
    cairo_fill(context);
}

void Page::area(std::span<const glm::dvec2> outline, glm::dvec3 colour, double opacity) {
    cairo_t* const context = cairo_->context.get();
    cairo_set_source_rgba(context, colour.r, colour.g, colour.b, opacity);
    cairo_new_path(context);
    for (const glm::dvec2 point : outline) cairo_line_to(context, point.x, point.y);
    cairo_fill(context);
}

void Page::picture(const RgbaImage& picture, glm::dvec2 topLeft, glm::dvec2 bottomRight) {
    const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.width(), picture.height()));
    cairo_surface_flush(surface.get());
    unsigned char* const bytes = cairo_image_surface_get_data(surface.get());
    const int stride = cairo_image_surface_get_stride(surface.get());
    for (int y = 0; y < picture.height(); ++y) {
        auto* const row = reinterpret_cast<std::uint32_t*>(bytes + static_cast<std::ptrdiff_t>(y) * stride);
        for (int x = 0; x < picture.width(); ++x) {
            const Rgba8 pixel = picture.at(x, y);
            row[x] = std::uint32_t{pixel.r} << 16 | std::uint32_t{pixel.g} << 8 | pixel.b;
        }
    }
    cairo_surface_mark_dirty(surface.get());
    cairo_t* const context = cairo_->context.get();
    cairo_save(context);
    cairo_translate(context, topLeft.x, topLeft.y);
    cairo_scale(context, (bottomRight.x - topLeft.x) / picture.width(), (bottomRight.y - topLeft.y) / picture.height());
    cairo_set_source_surface(context, surface.get(), 0, 0);
    cairo_pattern_set_extend(cairo_get_source(context), CAIRO_EXTEND_PAD);  // no transparency at its edges
    cairo_rectangle(context, 0, 0, picture.width(), picture.height());
    cairo_fill(context);
    cairo_restore(context);
}

void Page::cover(glm::dvec2 topLeft, glm::dvec2 bottomRight, double opacity) {
    cairo_t* const context = cairo_->context.get();
    cairo_set_source_rgba(context, 1, 1, 1, opacity);
    cairo_rectangle(context, topLeft.x, topLeft.y, bottomRight.x - topLeft.x, bottomRight.y - topLeft.y);
    cairo_fill(context);
}

void Page::page(const Page& other, glm::dvec2 topLeft) {
    cairo_t* const context = cairo_->context.get();
    cairo_set_source_surface(context, other.cairo_->surface.get(), topLeft.x, topLeft.y);
    cairo_rectangle(context, topLeft.x, topLeft.y, other.width_, other.height_);
    cairo_fill(context);
}

double Page::textWidth(std::string_view text, double size) const {
    cairo_text_extents_t extents;
    cairo_set_font_size(cairo_->context.get(), size);
    cairo_text_extents(cairo_->context.get(), std::string(text).c_str(), &extents);
    return extents.x_advance;
}

std::string Page::shortened(std::string_view text, double size, double width) const {
    if (textWidth(text, size) <= width) return std::string(text);
    std::string kept;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = std::max<std::size_t>(1, utf8Length(text, at));
        const std::string more = kept + std::string(text.substr(at, length));
        if (textWidth(more + "...", size) > width) break;
        kept = more, at += length;
    }
    return kept + "...";
}

void Page::text(std::string_view text, glm::dvec2 at, double size, Anchor anchor, bool upwards) {
    cairo_t* const context = cairo_->context.get();
    const double share = anchor == Anchor::Left ? 0 : anchor == Anchor::Middle ? 0.5 : 1;
    const double left = -share * textWidth(text, size);
    cairo_save(context);
    cairo_translate(context, at.x, at.y);
    if (upwards) cairo_rotate(context, -std::numbers::pi / 2);
    cairo_set_source_rgb(context, 0.1, 0.1, 0.1);
    cairo_set_font_size(context, size);
    cairo_move_to(context, left, 0.36 * size);  // half of a capital letter's height
    cairo_show_text(context, std::string(text).c_str());
    cairo_restore(context);
}

void Page::clip(glm::dvec2 topLeft, glm::dvec2 bottomRight) {
    cairo_save(cairo_->context.get());
    cairo_rectangle(cairo_->context.get(), topLeft.x, topLeft.y, bottomRight.x - topLeft.x, bottomRight.y - topLeft.y);
    cairo_clip(cairo_->context.get());
}

void Page::endClip() { cairo_restore(cairo_->context.get()); }

bool Page::knows(const std::filesystem::path& file) { return file.extension() == ".png" || file.extension() == ".svg"; }

Result<void> Page::write(const std::filesystem::path& file) const {
    if (!knows(file)) return Error(fmt::format("{}: a plot's name must end in .png or .svg", file.string()));
    std::string bytes;
    if (file.extension() == ".svg") {
        const CairoSurface surface(cairo_svg_surface_create_for_stream(append, &bytes, width_, height_));
        cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
        return cairo_->drawOn(surface.get(), file, bytes);
    }
    const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_, height_));
    return cairo_->drawOn(surface.get(), file, bytes);
}

Result<void> Page::writeAsPaper(const std::filesystem::path& file) const {
    std::string bytes;
    if (file.extension() == ".svg") {
        const CairoSurface surface(cairo_svg_surface_create_for_stream(append, &bytes, width_, height_));
        cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PT);
        return cairo_->drawOn(surface.get(), file, bytes);
    }
    if (file.extension() != ".pdf") return Error(fmt::format("{}: a sheet's name must end in .pdf or .svg", file.string()));
    const CairoSurface surface(cairo_pdf_surface_create_for_stream(append, &bytes, width_, height_));
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");  // the same drawing, the same bytes
    return cairo_->drawOn(surface.get(), file, bytes);
}

}  // namespace fantascope::plot
