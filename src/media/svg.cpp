#include "media/svg.h"

#include "core/file.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <librsvg/rsvg.h>

#include <algorithm>
#include <memory>
#include <string>

namespace fantascope {
namespace {

struct Free {
    void operator()(GError* error) const { g_error_free(error); }
    void operator()(RsvgHandle* handle) const { g_object_unref(handle); }
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};
template <class Thing>
using Owned = std::unique_ptr<Thing, Free>;

Error notReadable(const std::string& file, GError* error) {
    const Owned<GError> owned(error);
    const std::string why = owned ? owned->message : "unknown error";
    return Error(fmt::format("{}: not an SVG that can be read: {}", file, why.substr(0, why.find('\n'))));
}

// cairo's colours are premultiplied by alpha.
std::uint8_t withoutAlpha(unsigned value, unsigned alpha) {
    return alpha == 0 ? 0 : static_cast<std::uint8_t>(std::min(255u, (value * 255 + alpha / 2) / alpha));
}

RgbaImage toImage(cairo_surface_t* surface) {
    RgbaImage image(cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface));
    cairo_surface_flush(surface);
    const unsigned char* data = cairo_image_surface_get_data(surface);
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
    for (int y = 0; y < image.height(); ++y) {
        const auto* row = reinterpret_cast<const std::uint32_t*>(data + stride * static_cast<std::size_t>(y));
        for (int x = 0; x < image.width(); ++x) {
            const std::uint32_t argb = row[x], alpha = argb >> 24;
            image.at(x, y) = {withoutAlpha(argb >> 16 & 255, alpha), withoutAlpha(argb >> 8 & 255, alpha),
                              withoutAlpha(argb & 255, alpha), static_cast<std::uint8_t>(alpha)};
        }
    }
    return image;
}

// A part of the page; the page's longer side is `page` pixels before magnification.
struct Part {
    glm::dvec2 begin, end;
    double magnified;
};

Result<RgbaImage> draw(RsvgHandle* handle, int page, const Part& part, const std::string& file) {
    const glm::ivec2 size(glm::max(glm::round((part.end - part.begin) * part.magnified), 1.0));
    const Owned<cairo_surface_t> surface(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, size.x, size.y));
    const Owned<cairo_t> context(cairo_create(surface.get()));
    cairo_scale(context.get(), part.magnified, part.magnified);
    cairo_translate(context.get(), -part.begin.x, -part.begin.y);
    const RsvgRectangle all{0, 0, double(page), double(page)};
    GError* error = nullptr;
    if (!rsvg_handle_render_document(handle, context.get(), &all, &error)) return notReadable(file, error);
    return toImage(surface.get());
}

}  // namespace

Result<RgbaImage> readSvg(const std::filesystem::path& path, int side) {
    const std::string bytes = TRY(readFile(path));
    GError* error = nullptr;
    const Owned<RsvgHandle> handle(
        rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(bytes.data()), bytes.size(), &error));
    if (!handle) return notReadable(path.string(), error);
    const RgbaImage page = TRY(draw(handle.get(), side, {{0, 0}, {side, side}, 1}, path.string()));
    glm::ivec2 begin(side), end(0);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            if (page.at(x, y).a > 0) {
                begin = glm::min(begin, glm::ivec2(x, y));
                end = glm::max(end, glm::ivec2(x + 1, y + 1));
            }
    if (begin.x >= end.x)
        return Error(fmt::format("{}: draws nothing that has an area; fill the shape, or give it a stroke", path.string()));
    return draw(handle.get(), side, {begin, end, double(side) / std::max(end.x - begin.x, end.y - begin.y)}, path.string());
}

}  // namespace fantascope
