#include "media/glyph.h"

#include "core/file.h"

#include <fmt/format.h>
#include <freetype/freetype.h>
#include <freetype/ftoutln.h>
#include <ft2build.h>
#include <glm/geometric.hpp>

#include <memory>
#include <type_traits>

namespace fantascope {
namespace {

// Bold, because a letter is a few dozen pixels large and must be readable while it sways.
constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";
constexpr int kPieces = 8;            // line segments per curve
constexpr double kTolerance = 0.004;  // of an em
constexpr std::size_t kMaxPoints = 80;

struct Free {
    void operator()(FT_Library library) const { FT_Done_FreeType(library); }
    void operator()(FT_Face face) const { FT_Done_Face(face); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Free>;

// The outline while FreeType walks along it.
struct Walk {
    Outline outline;
    double unit;  // of the font, in ems

    glm::dvec2 at(const FT_Vector* point) const { return glm::dvec2(point->x, point->y) * unit; }
    std::vector<glm::dvec2>& ring() { return outline.rings.back(); }
};

int moveTo(const FT_Vector* to, void* user) {
    auto& walk = *static_cast<Walk*>(user);
    walk.outline.rings.push_back({walk.at(to)});
    return 0;
}
int lineTo(const FT_Vector* to, void* user) {
    auto& walk = *static_cast<Walk*>(user);
    walk.ring().push_back(walk.at(to));
    return 0;
}
// DejaVu is a TrueType font, so its curves are quadratic.
int conicTo(const FT_Vector* control, const FT_Vector* to, void* user) {
    auto& walk = *static_cast<Walk*>(user);
    const glm::dvec2 a = walk.ring().back(), b = walk.at(control), c = walk.at(to);
    for (int i = 1; i <= kPieces; ++i) {
        const double t = double(i) / kPieces;
        walk.ring().push_back((1 - t) * (1 - t) * a + 2 * t * (1 - t) * b + t * t * c);
    }
    return 0;
}
int cubicTo(const FT_Vector*, const FT_Vector*, const FT_Vector*, void*) { return FT_Err_Invalid_Outline; }

}  // namespace

Result<Outline> glyphOutline(char32_t character) {
    FT_Library library = nullptr;
    if (FT_Init_FreeType(&library) != 0) return Error("FreeType cannot be started");
    const Owned<FT_Library> ownedLibrary(library);
    const auto font = readFile(kFont);
    FT_Face face = nullptr;
    if (!font || FT_New_Memory_Face(library, reinterpret_cast<const FT_Byte*>(font->data()), static_cast<FT_Long>(font->size()),
                                    0, &face) != 0)
        return Error(fmt::format("{}: the font for letters cannot be read; install fonts-dejavu-core", kFont));
    const Owned<FT_Face> ownedFace(face);
    if (FT_Get_Char_Index(face, character) == 0 || FT_Load_Char(face, character, FT_LOAD_NO_SCALE) != 0)
        return Error("the font for letters, DejaVu Sans Bold, has no such character");
    Walk walk{{}, 1.0 / face->units_per_EM};
    const FT_Outline_Funcs functions{moveTo, lineTo, conicTo, cubicTo, 0, 0};
    if (FT_Outline_Decompose(&face->glyph->outline, &functions, &walk) != 0 || walk.outline.rings.empty())
        return Error("the font for letters, DejaVu Sans Bold, draws nothing for this character");
    for (auto& ring : walk.outline.rings)
        if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    return simplified(walk.outline, kTolerance, kMaxPoints);
}

}  // namespace fantascope
