#include "pattern/shape/built_in_shapes.h"

#include "core/config/config.h"
#include "media/glyph.h"
#include "media/outline.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <utility>

namespace fantascope::pattern {
namespace {

constexpr std::string_view kLetter = "letter-";

// A triangle fan over a convex, anticlockwise outline.
TriangleMesh fan(std::vector<glm::vec3> outline) {
    TriangleMesh mesh{std::move(outline), {}};
    for (std::uint32_t i = 2; i < mesh.vertices.size(); ++i) mesh.triangles.emplace_back(0, i - 1, i);
    return mesh;
}

// A polygon with its corners on the unit circle that stands on a side.
TriangleMesh regularPolygon(int corners) {
    std::vector<glm::vec3> outline;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.5) / corners - std::numbers::pi / 2;
        outline.emplace_back(std::cos(angle), std::sin(angle), 0);
    }
    return fan(std::move(outline));
}

// Two arcs that meet in a tip above and below; half as wide as long.
TriangleMesh leaf() {
    constexpr int kSides = 8;  // straight pieces per arc
    // The arc through the tips (0, +-1) and the flank (1/2, 0) has its centre at (-3/4, 0).
    const double radius = 1.25, tip = std::asin(1 / radius);
    std::vector<glm::vec3> outline;
    for (const double side : {1.0, -1.0})
        for (int i = 0; i < kSides; ++i) {
            const double angle = tip * (2.0 * i / kSides - 1);
            outline.emplace_back(side * (radius * std::cos(angle) - 0.75), side * radius * std::sin(angle), 0);
        }
    return fan(std::move(outline));
}

// `ring`: the right half of the outline, from the top down; its mirror image is added.
TriangleMesh symmetric(std::vector<glm::dvec2> ring) {
    for (std::size_t i = ring.size(); i-- > 0;)
        if (ring[i].x > 0) ring.emplace_back(-ring[i].x, ring[i].y);
    return filled({{ring}});
}

// Five lobes with three teeth each, on a stalk.
TriangleMesh mapleLeaf() {
    return symmetric({{0, 200},
                      {34, 134},
                      {43, 132},
                      {76, 150},
                      {56, 47},
                      {66, 41},
                      {107, 86},
                      {117, 62},
                      {126, 57},
                      {182, 69},
                      {162, 12},
                      {165, 4},
                      {187, -6},
                      {93, -82},
                      {91, -90},
                      {102, -122},
                      {17, -107},
                      {8, -115},
                      {11, -205}});
}

// A blade seven times as long as wide, widest below the middle, on a short stalk; it bends to the
// right.
TriangleMesh bambooLeaf() {
    constexpr int kPieces = 12;  // of each side
    constexpr double kWidth = 0.235, kBend = 0.18, kStalk = 0.16, kHalfStalk = 0.016;
    std::vector<glm::dvec2> right, left;
    const auto add = [&](double y, double halfWidth) {
        const double middle = kBend * y * y;
        right.emplace_back(middle + halfWidth, y);
        left.emplace_back(middle - halfWidth, y);
    };
    add(-kStalk, kHalfStalk);
    add(0, kHalfStalk);
    for (int piece = 1; piece < kPieces; ++piece) {
        const double y = double(piece) / kPieces;
        add(y, kWidth * std::pow(y, 0.7) * (1 - y));
    }
    right.emplace_back(kBend, 1);
    right.insert(right.end(), left.rbegin(), left.rend());
    return filled({{right}});
}

// Six arms with two pairs of branches at 60 degrees, all tapered.
TriangleMesh snowflake() {
    constexpr double kHalfArm = 0.06, kHalfBranch = 0.055;
    const double sixth = std::numbers::pi / 3;
    const glm::dvec2 along(std::sin(sixth), std::cos(sixth)), across(along.y, -along.x);  // of a branch of the arm that points up
    std::vector<glm::dvec2> right = {{kHalfArm, kHalfArm / std::tan(sixth / 2)}};
    for (const auto& [root, length] : {std::pair(0.44, 0.36), {0.71, 0.24}}) {
        // Where the branch's lower and upper sides leave the arm's side x = kHalfArm.
        for (const double side : {1.0, -1.0}) {
            const glm::dvec2 start = glm::dvec2(0, root) + side * kHalfBranch * across;
            if (side < 0) right.push_back(glm::dvec2(0, root) + length * along);
            right.push_back(start + (kHalfArm - start.x) / along.x * along);
        }
    }
    std::vector<glm::dvec2> arm = right;
    arm.emplace_back(0, 1);
    for (std::size_t i = right.size(); i-- > 1;) arm.emplace_back(-right[i].x, right[i].y);  // the foot belongs to the next arm
    std::vector<glm::dvec2> ring;
    for (int i = 0; i < 6; ++i)
        for (const glm::dvec2 p : arm) {
            const double c = std::cos(i * sixth), s = std::sin(i * sixth);
            ring.emplace_back(c * p.x - s * p.y, s * p.x + c * p.y);
        }
    return filled({{ring}});
}

const std::vector<std::pair<std::string, TriangleMesh (*)()>>& builtIns() {
    static const std::vector<std::pair<std::string, TriangleMesh (*)()>> shapes = {
        {"triangle", [] { return regularPolygon(3); }},
        {"square", [] { return regularPolygon(4); }},
        {"circle", [] { return regularPolygon(24); }},
        {"leaf", leaf},
        {"maple-leaf", mapleLeaf},
        {"bamboo-leaf", bambooLeaf},
        {"snowflake", snowflake},
    };
    return shapes;
}

// The character of a name such as "letter-A"; nothing for any other name.
std::optional<char32_t> letterOf(std::string_view name) {
    if (!name.starts_with(kLetter)) return std::nullopt;
    try {
        const std::u32string characters = std::filesystem::path(name.substr(kLetter.size())).u32string();
        if (characters.size() == 1) return characters[0];
    } catch (const std::filesystem::filesystem_error&) {  // not UTF-8: no character
    }
    return std::nullopt;
}

}  // namespace

const std::vector<std::string>& builtInShapeNames() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const auto& shape : builtIns()) list.push_back(shape.first);
        return list;
    }();
    return names;
}

std::string builtInShapeList() { return fmt::format("{}, letter-A (any character)", fmt::join(builtInShapeNames(), ", ")); }

bool isBuiltInShape(std::string_view name) {
    const auto& names = builtInShapeNames();
    return letterOf(name) || std::find(names.begin(), names.end(), name) != names.end();
}

Result<TriangleMesh> builtInMesh(const std::string& name) {
    if (const auto character = letterOf(name)) return filled(TRY(glyphOutline(*character).in(name)));
    for (const auto& [known, mesh] : builtIns())
        if (known == name) return mesh();
    const std::string nearest = nearestName(name, builtInShapeNames());
    return Error(fmt::format("'{}' is no built-in shape; there are {}{}", name, builtInShapeList(),
                             nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
}

}  // namespace fantascope::pattern
