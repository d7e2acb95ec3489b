#include "drivers/site/objects.h"

#include "drivers/site/limits.h"
#include "drivers/site/texture.h"

#include "core/geometry.h"
#include "media/image.h"
#include "media/mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <array>
#include <memory>
#include <optional>

namespace fantascope::site {
namespace {

constexpr int kMostCells = 256;  // of a relief each way: a second to sort them for the rays

// A box around a centre, along the axes.
TriangleMesh box(glm::dvec3 centre, glm::dvec3 size) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.vertices.push_back(centre + size * (glm::dvec3(i & 1, (i >> 1) & 1, i >> 2) - 0.5));
    for (const glm::uvec4& side :
         std::array<glm::uvec4, 6>{{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}}) {
        mesh.triangles.emplace_back(side.x, side.y, side.z);
        mesh.triangles.emplace_back(side.x, side.z, side.w);
    }
    return mesh;
}

// A rectangle as a surface: flat, or with a relief.
struct Sheet {
    TriangleMesh mesh;
    std::shared_ptr<const Texture> texture;  // null: plain
};

// A grid over a rectangle, its points moved along the normal as far as the grey of a picture says.
struct Relief {
    GreyImage picture;
    double depth = 0;  // metres for white
    glm::ivec2 grid{1};

    // Stored grey at a place of the rectangle, bilinear between pixels.
    double greyAt(glm::dvec2 place) const {
        const glm::dvec2 last(picture.width() - 1, picture.height() - 1);
        const glm::dvec2 pixel = glm::clamp(glm::dvec2(place.x, 1 - place.y) * (last + 1.0) - 0.5, glm::dvec2(0), last);
        const glm::ivec2 low = glm::floor(pixel), high = glm::min(low + 1, glm::ivec2(last));
        const glm::dvec2 share = pixel - glm::dvec2(low);
        return glm::mix(glm::mix<double>(picture.at(low.x, low.y), picture.at(high.x, low.y), share.x),
                        glm::mix<double>(picture.at(low.x, high.y), picture.at(high.x, high.y), share.x), share.y);
    }
};

TriangleMesh meshOf(const Rectangle& rectangle, const Relief& relief) {
    TriangleMesh mesh;
    const glm::dvec3 normal = rectangle.normal();
    const auto across = static_cast<std::uint32_t>(relief.grid.x), up = static_cast<std::uint32_t>(relief.grid.y);
    for (std::uint32_t y = 0; y <= up; ++y)
        for (std::uint32_t x = 0; x <= across; ++x) {
            const glm::dvec2 place(static_cast<double>(x) / across, static_cast<double>(y) / up);
            mesh.vertices.emplace_back(rectangle.corner + rectangle.right * place.x + rectangle.up * place.y +
                                       normal * (relief.depth * relief.greyAt(place)));
        }
    for (std::uint32_t y = 0; y < up; ++y)
        for (std::uint32_t x = 0; x < across; ++x) {
            const std::uint32_t first = y * (across + 1) + x, above = first + across + 1;
            mesh.triangles.emplace_back(first, first + 1, above + 1);
            mesh.triangles.emplace_back(first, above + 1, above);
        }
    return mesh;
}

Result<glm::ivec2> readGrid(const ConfigNode& node) {
    glm::ivec2 grid{1};
    const std::vector<ConfigNode> items = TRY(node.items(2, 2));
    for (int i = 0; i < 2; ++i) grid[i] = static_cast<int>(TRY(items[static_cast<std::size_t>(i)].integer(1, kMostCells)));
    return grid;
}

Result<Relief> readRelief(const ConfigNode& node) {
    Relief relief;
    ConfigFields fields(node);
    fields.read("picture", relief.picture,
                [](const ConfigNode& value) -> Result<GreyImage> { return TRY(readGrey(TRY(value.path())).in(value.place())); });
    fields.number("depth", relief.depth, -100, 100, "m");
    fields.read("grid", relief.grid, readGrid);
    TRY(fields.finish());
    return relief;
}

Result<Sheet> readRectangle(const ConfigNode& node) {
    Rectangle rectangle;
    std::optional<RgbaImage> picture;
    std::optional<glm::dvec2> tile;
    std::optional<Relief> relief;
    ConfigFields fields(node);
    fields.vector3("corner", rectangle.corner, -kMaxDistance, kMaxDistance, "m");
    fields.vector3("right", rectangle.right, -kMaxDistance, kMaxDistance, "m");
    fields.vector3("up", rectangle.up, -kMaxDistance, kMaxDistance, "m");
    fields.optional().read("texture", picture, [](const ConfigNode& value) -> Result<RgbaImage> {
        return TRY(readRgba(TRY(value.path())).in(value.place()));
    });
    fields.optional().read("texture_size", tile, [](const ConfigNode& value) { return value.vector2(1e-3, kMaxDistance, "m"); });
    fields.optional().read("relief", relief, readRelief);
    TRY(fields.finish());
    if (glm::length(glm::cross(rectangle.right, rectangle.up)) < 1e-6)
        return node.error("'right' and 'up' must span a rectangle; they are zero or parallel");
    if (tile && !picture) return node.error("'texture_size' needs a 'texture'");
    Sheet sheet{meshOf(rectangle, relief.value_or(Relief{GreyImage(1, 1), 0, glm::ivec2(1)})), nullptr};
    if (picture) sheet.texture = std::make_shared<const Texture>(*picture, rectangle, tile);
    return sheet;
}

Result<TriangleMesh> readBox(const ConfigNode& node) {
    glm::dvec3 centre{}, size{};
    ConfigFields fields(node);
    fields.vector3("centre", centre, -kMaxDistance, kMaxDistance, "m");
    fields.vector3("size", size, 1e-3, kMaxDistance, "m");
    TRY(fields.finish());
    return box(centre, size);
}

Result<TriangleMesh> readPlacedMesh(const ConfigNode& node) {
    std::filesystem::path file;
    glm::dvec3 position{0.0};
    double turn = 0, scale = 1;
    ConfigFields fields(node);
    fields.path("file", file);
    fields.optional().vector3("position", position, -kMaxDistance, kMaxDistance, "m");
    fields.optional().angle("turn", turn, -360, 360);
    fields.optional().number("scale", scale, 1e-4, 1e4);
    TRY(fields.finish());
    TriangleMesh mesh = TRY(readMesh(file).in(node.place()));
    const glm::dmat3 rotation = rotationXyz({0, turn, 0});
    for (glm::vec3& vertex : mesh.vertices) vertex = rotation * glm::dvec3(vertex) * scale + position;
    return mesh;
}

}  // namespace

Result<SceneObject> readObject(const ConfigNode& node) {
    SceneObject object;
    glm::dvec3 reflectance{0.5};
    std::optional<Sheet> rectangle;
    std::optional<TriangleMesh> box, mesh;
    ConfigFields fields(node);
    fields.text("name", object.name);
    fields.optional().read("rectangle", rectangle, readRectangle);
    fields.optional().read("box", box, readBox);
    fields.optional().read("mesh", mesh, readPlacedMesh);
    fields.optional().vector3("reflectance", reflectance, 0, 1);
    TRY(fields.finish());
    if (rectangle.has_value() + box.has_value() + mesh.has_value() != 1)
        return node.error("exactly one of rectangle, box and mesh is needed");
    object.mesh = std::move(rectangle ? rectangle->mesh : box ? *box : *mesh);
    if (rectangle) object.texture = rectangle->texture;
    object.reflectance = reflectance;
    return object;
}

}  // namespace fantascope::site
