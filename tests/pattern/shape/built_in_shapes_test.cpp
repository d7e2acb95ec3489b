#include "pattern/shape/built_in_shapes.h"

#include "pattern/shape/elemental_shape.h"

#include "core/check.h"

#include <freetype/freetype.h>
#include <ft2build.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::pattern {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

double area(const TriangleMesh& mesh) {
    double sum = 0;
    for (const glm::uvec3 t : mesh.triangles)
        sum += glm::cross(mesh.vertices[t.y] - mesh.vertices[t.x], mesh.vertices[t.z] - mesh.vertices[t.x]).z / 2;
    return sum;
}

bool covers(const TriangleMesh& mesh, glm::vec2 point) {
    return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const glm::uvec3 t) {
        for (int i = 0; i < 3; ++i) {
            const glm::vec2 a = mesh.vertices[t[i]], side = glm::vec2(mesh.vertices[t[(i + 1) % 3]]) - a, to = point - a;
            if (side.x * to.y - side.y * to.x < 0) return false;
        }
        return true;
    });
}

// The intersection over union of two meshes of radius 1, sampled on a raster; `turned` maps points
// for the second.
template <class Turned>
double likeness(const TriangleMesh& a, const TriangleMesh& b, Turned turned) {
    int both = 0, any = 0;
    for (float y = -1; y < 1; y += 0.02f)
        for (float x = -1; x < 1; x += 0.02f) {
            const bool inA = covers(a, {x, y}), inB = covers(b, turned(glm::vec2(x, y)));
            both += inA && inB, any += inA || inB;
        }
    return double(both) / any;
}

TriangleMesh mesh(const std::string& name) { return loadShape(name).value().mesh; }

// Pattern files use these names.
TEST(BuiltInShapes, keep_their_names) {
    EXPECT_THAT(builtInShapeNames(),
                ElementsAre("triangle", "square", "circle", "leaf", "maple-leaf", "bamboo-leaf", "snowflake"));
    for (const char* name : {"letter-A", "letter-g", "letter-7", "letter-&", "letter-é", "letter-Ж"}) {
        EXPECT_TRUE(isBuiltInShape(name)) << name;
        EXPECT_TRUE(loadShape(name)) << name;
    }
    for (const char* name : {"letter", "letter-", "letter-AB", "letter-form.svg", "letter-\xff", "Leaf"})
        EXPECT_FALSE(isBuiltInShape(name)) << name;
}

// Each triangle is drawn a thousand times, once per copy.
TEST(BuiltInShapes, have_few_triangles_which_face_the_viewer) {
    std::vector<std::string> names = builtInShapeNames();
    for (char c = '!'; c <= '~'; ++c) names.push_back(std::string("letter-") + c);
    for (const std::string& name : names) {
        const TriangleMesh shape = mesh(name);
        EXPECT_LE(shape.triangles.size(), 90u) << name;
        for (const glm::uvec3 t : shape.triangles) {
            const auto& v = shape.vertices;
            EXPECT_GT(glm::cross(v[t.y] - v[t.x], v[t.z] - v[t.x]).z, 0) << name;
        }
    }
}

TEST(BuiltInShapes, a_maple_leaf_is_symmetric_has_lobes_and_stands_on_its_stalk) {
    const TriangleMesh leaf = mesh("maple-leaf");
    EXPECT_GT(likeness(leaf, leaf, [](glm::vec2 p) { return glm::vec2(-p.x, p.y); }), 0.97);
    EXPECT_TRUE(covers(leaf, {0, 0.8f}));
    EXPECT_TRUE(covers(leaf, {0, -0.8f}));
    EXPECT_FALSE(covers(leaf, {0.1f, -0.8f})) << "a stalk is thin";
    EXPECT_FALSE(covers(leaf, {0.4f, 0.6f})) << "between two lobes";
    EXPECT_LT(area(leaf), 1.5) << "of a circle's 3.14";
}

TEST(BuiltInShapes, a_bamboo_leaf_is_a_long_blade) {
    const TriangleMesh leaf = mesh("bamboo-leaf");
    glm::vec3 least(9), most(-9);
    for (const glm::vec3 vertex : leaf.vertices) least = glm::min(least, vertex), most = glm::max(most, vertex);
    EXPECT_GT((most.y - least.y) / (most.x - least.x), 4);
    EXPECT_GT(area(leaf), 0.2) << "but no stroke";
}

TEST(BuiltInShapes, a_snowflake_has_six_arms) {
    const TriangleMesh flake = mesh("snowflake");
    const auto turned = [](double degrees) {
        return [c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180)](glm::vec2 p) {
            return glm::vec2(c * p.x - s * p.y, s * p.x + c * p.y);
        };
    };
    EXPECT_GT(likeness(flake, flake, turned(60)), 0.97);
    EXPECT_LT(likeness(flake, flake, turned(30)), 0.6);
    EXPECT_GT(likeness(flake, flake, [](glm::vec2 p) { return glm::vec2(-p.x, p.y); }), 0.97);
    EXPECT_LT(area(flake), 1);
}

// The reference is FreeType's own rasteriser. Example failure: the dot of the i is lost, the hole
// of the o is filled, or the overlap of two parts of a glyph is left empty.
TEST(BuiltInShapes, letters_cover_what_the_font_covers) {
    FT_Library library = nullptr;
    FT_Face face = nullptr;
    ASSERT_EQ(FT_Init_FreeType(&library), 0);
    ASSERT_EQ(FT_New_Face(library, "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf", 0, &face), 0);
    constexpr int kEm = 200;  // pixels
    ASSERT_EQ(FT_Set_Pixel_Sizes(face, kEm, kEm), 0);
    for (const std::string_view text : {"!", "%", "0", "8", "@", "A", "B", "Q", "g", "i", "o", "x", "~"}) {
        ASSERT_EQ(FT_Load_Char(face, static_cast<unsigned char>(text[0]), FT_LOAD_RENDER | FT_LOAD_NO_HINTING), 0);
        const FT_Bitmap& bitmap = face->glyph->bitmap;
        const TriangleMesh letter = builtInMesh("letter-" + std::string(text)).value();  // an em is 1
        int differ = 0, covered = 0;
        for (int row = 0; row < static_cast<int>(bitmap.rows); ++row)
            for (int column = 0; column < static_cast<int>(bitmap.width); ++column) {
                const int value = bitmap.buffer[row * bitmap.pitch + column];
                const bool inside = covers(
                    letter, glm::vec2(face->glyph->bitmap_left + column + 0.5, face->glyph->bitmap_top - row - 0.5) / float(kEm));
                covered += value >= 128;
                differ += (value >= 128) != inside;
            }
        EXPECT_GT(covered, 100) << text;
        EXPECT_LT(differ, 0.06 * covered) << text;
        EXPECT_NEAR(area(letter) * kEm * kEm, covered, 0.02 * covered) << text;
    }
    FT_Done_Face(face);
    FT_Done_FreeType(library);
}

TEST(BuiltInShapes, what_is_none_is_refused_with_the_list) {
    const auto refusal = [](const std::string& name) { return builtInShape(name).error().message(); };
    EXPECT_THAT(refusal("triangel"), AllOf(HasSubstr("'triangel' is no built-in shape; there are triangle, square"),
                                           HasSubstr("did you mean 'triangle'?")));
    EXPECT_THAT(refusal("letter-AB"), HasSubstr("letter-A (any character)"));
    EXPECT_THAT(refusal("letter-\u6f22"),
                HasSubstr("letter-\u6f22: the font for letters, DejaVu Sans Bold, has no such character"));
    EXPECT_THAT(refusal("letter- "), HasSubstr("draws nothing for this character"));
}

}  // namespace
}  // namespace fantascope::pattern
