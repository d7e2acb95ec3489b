#include "show/site/output_reader.h"

#include "media/image.h"

#include <glm/geometric.hpp>

#include <array>
#include <memory>
#include <optional>

namespace fantascope::show {
namespace {

constexpr double kFarthestCorner = 32768;  // pixels: a corner may lie outside its picture
constexpr double kSmallestCanvas = 0.01;   // metres

Result<glm::dvec2> readPixel(const ConfigNode& node) { return node.vector2(-kFarthestCorner, kFarthestCorner, "px"); }

Result<std::array<glm::dvec2, 4>> readCorners(const ConfigNode& node) {
    std::array<glm::dvec2, 4> corners;
    const auto items = TRY(node.items(corners.size(), corners.size()));
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = TRY(readPixel(items[i]));
    if (const auto why = whyNotConvex(corners)) return node.error(*why);
    return corners;
}

Result<CanvasPart> readPart(const ConfigNode& node) {
    const auto sides = TRY(node.items(4, 4));
    CanvasPart part;
    part.low = glm::dvec2(TRY(sides[0].number(0, 1)), TRY(sides[1].number(0, 1)));
    part.high = glm::dvec2(TRY(sides[2].number(0, 1)), TRY(sides[3].number(0, 1)));
    if (part.low.x >= part.high.x || part.low.y >= part.high.y)
        return node.error("left comes before right and top before bottom: [left, top, right, bottom]");
    return part;
}

Result<WarpMesh> readMesh(const ConfigNode& node) {
    WarpMesh mesh;
    ConfigFields fields(node);
    fields.read("points", mesh.points, [](const ConfigNode& value) -> Result<glm::ivec2> {
        const auto sides = TRY(value.items(2, 2));
        return glm::ivec2(TRY(sides[0].integer(2, WarpMesh::kMaxPoints)), TRY(sides[1].integer(2, WarpMesh::kMaxPoints)));
    });
    fields.optional().choice("between", mesh.between, {"smooth", "straight"});
    fields.list("offsets", mesh.offsets, readPixel);
    TRY(fields.finish());
    return mesh;
}

Result<Mask> readMask(const ConfigNode& node) {
    Mask mask;
    ConfigFields fields(node);
    fields.optional().list("polygon", mask.polygon, readPixel, 3, Mask::kMaxPoints);
    fields.optional().choice("hides", mask.hidesOutside, {"inside", "outside"});
    fields.optional().number("feather", mask.feather, 0, Mask::kMaxFeather, "px");
    fields.optional().read("image", mask.image, [&](const ConfigNode& image) -> Result<std::shared_ptr<const GreyImage>> {
        mask.imageFile = TRY(image.text());
        return std::make_shared<const GreyImage>(TRY(readGrey(TRY(image.path())).in(image.place())));
    });
    TRY(fields.finish());
    if (mask.polygon.empty() == (mask.image == nullptr)) return node.error("a mask is either a 'polygon' or an 'image'");
    return mask;
}

Result<std::optional<double>> readGamma(const ConfigNode& node) {
    if (const auto word = node.text(); word && *word == "srgb") return std::optional<double>();
    const auto gamma = node.number(1, 4);
    if (!gamma) return Error(gamma.error().message() + "; or 'srgb'");
    return std::optional(*gamma);
}

Result<ProjectorLight> readLight(const ConfigNode& node) {
    ProjectorLight light;
    ConfigFields fields(node);
    fields.optional().read("gamma", light.gamma, readGamma);
    fields.optional().number("black_level", light.blackLevel, 0, kBrightestBlack);
    fields.optional().vector3("white", light.white, 0, 1);
    fields.optional().number("brightness", light.brightness, 0, 1);
    fields.optional().read("lut", light.cube, [](const ConfigNode& value) -> Result<std::shared_ptr<const ColourCube>> {
        return std::make_shared<const ColourCube>(TRY(ColourCube::read(TRY(value.path())).in(value.place())));
    });
    fields.optional().boolean("dither", light.dither);
    TRY(fields.finish());
    return light;
}

Result<NominalProjector> readProjector(const ConfigNode& node) {
    NominalProjector projector;
    Aim aim;
    ConfigFields fields(node);
    aim.declare(fields);
    fields.number("throw_ratio", projector.throwRatio, 0.1, 10);
    fields.optional().vector2("lens_shift", projector.lensShift, -2, 2, "picture widths and heights");
    TRY(fields.finish());
    projector.pose = TRY(aim.pose(node));
    return projector;
}

Result<Surface> readSurface(const ConfigNode& node) {
    Surface surface;
    ConfigFields fields(node);
    fields.vector3("point", surface.point, -kFarthest, kFarthest, "m");
    fields.vector3("normal", surface.normal, -1, 1);
    TRY(fields.finish());
    if (surface.normal == glm::dvec3(0.0))
        return node.error("the normal has no length; give the direction that the surface faces");
    surface.normal = glm::normalize(surface.normal);
    return surface;
}

}  // namespace

Result<Output> readOutput(const ConfigNode& node, std::set<std::string>& names, DriversWord& drivers) {
    Output output;
    Projection& projection = output.projection;
    WarpShape warp;
    std::optional<std::array<glm::dvec2, 4>> corners;
    ConfigFields fields(node);
    fields.read("name", output.name, onceNamed(names, "output"));
    fields.read("size", projection.size, readSize);
    fields.number("refresh_rate", output.refreshRate, 1, 240, "Hz");
    fields.read("display", output.display, [&](const ConfigNode& device) -> Result<DeviceConfig> {
        output.display = TRY(readDevice(device));
        drivers.ask(device, [&](DeviceReader& reader) { return reader.display(output); });
        return output.display;
    });
    fields.optional().read("canvas", output.canvas, readName);
    fields.optional().read("canvas_size", output.canvasSize,
                           [](const ConfigNode& size) { return size.vector2(kSmallestCanvas, kFarthest, "m"); });
    fields.optional().read("part", warp.part, readPart);
    fields.optional().choice("flip", warp.orientation.flip, {"none", "horizontal", "vertical"});
    fields.optional().read("turn", warp.orientation.quarterTurns, [](const ConfigNode& value) -> Result<int> {
        return static_cast<int>(TRY(value.choice({"0", "90", "180", "270"})));
    });
    fields.optional().read("corners", corners, readCorners);
    fields.optional().read("mesh", warp.mesh, readMesh);
    fields.optional().list("masks", projection.masks, readMask, 1, Mask::kMax);
    fields.optional().read("light", projection.light, readLight);
    fields.optional().read("projector", output.projector, readProjector);
    fields.optional().read("surface", output.surface, readSurface);
    TRY(fields.finish());
    warp.corners = corners.value_or(rectangleCorners(output.size().x, output.size().y));
    const auto made = Warp::of(warp);
    if (!made) return node.error(made.error().message());
    projection.warp = *made;
    if (!projection.warp.reaches(output.size()))
        return node.error(fmt::format("nothing of the picture would be seen: its corners lie outside of the {} x {} pixels",
                                      output.size().x, output.size().y));
    if (output.projector && output.surface &&
        glm::dot(output.surface->normal, output.projector->pose.position - output.surface->point) <= 0)
        return node.error("the projector stands behind its surface; turn the surface's normal towards the projector");
    return output;
}

}  // namespace fantascope::show
