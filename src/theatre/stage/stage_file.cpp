#include "theatre/stage/stage_file.h"

#include "core/config/config.h"
#include "media/mesh.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace fantascope::theatre {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kVersion = 1;
constexpr double kFarthest = 100, kLeastSize = 0.01, kMostSize = 30, kMostOffset = 3;  // metres
constexpr double kNearestLight = 0.5, kRounding = 1e-3;                                // metres
constexpr double kLeastRadius = 1;                                                     // of a curved screen, metres
constexpr std::size_t kMostThings = 50, kMostTriangles = 100'000, kMostFurther = 7;

constexpr auto kBelowFloor = "the light is {} m below the floor, which is at y = 0; give it a y of 0 or more";

Result<glm::dvec3> readLight(const ConfigNode& node) {
    const glm::dvec3 light = TRY(node.vector3(-kFarthest, kFarthest, "m"));
    if (light.z <= 0)
        return node.error(
            fmt::format("the light is {} m behind the screen, which is at z = 0; people stand between the two: give it a z > 0",
                        shortest(-light.z)));
    if (light.z < kNearestLight)
        return node.error(
            fmt::format("the light is {} m in front of the screen, and nobody fits between; move it to {} m or farther",
                        shortest(light.z), shortest(kNearestLight)));
    if (light.y < 0) return node.error(fmt::format(kBelowFloor, shortest(-light.y)));
    return light;
}

// A pair [from, to], ascending.
Result<glm::dvec2> readRange(const ConfigNode& node, double least) {
    const glm::dvec2 range = TRY(node.vector2(least, kFarthest, "m"));
    if (range.x >= range.y)
        return node.error(
            fmt::format("from {} to {} is empty; the smaller number comes first", shortest(range.x), shortest(range.y)));
    return range;
}

// A projector's lens and what it lights. `readLens` checks the lens.
template <class ReadLens>
Result<std::pair<glm::dvec3, Stage::Area>> readProjector(const ConfigNode& node, ReadLens readLens) {
    glm::dvec3 lens(0);
    glm::dvec2 across(0), up(0);
    ConfigFields fields(node);
    fields.read("lens", lens, readLens);
    fields.read("picture", across, [&](const ConfigNode& at) -> Result<glm::dvec2> {
        glm::dvec2 x(0);
        ConfigFields own(at);
        own.read("x", x, [](const ConfigNode& range) { return readRange(range, -kFarthest); });
        own.read("y", up, [](const ConfigNode& range) { return readRange(range, -kFarthest); });
        TRY(own.finish());
        return x;
    });
    TRY(fields.finish());
    return std::pair(lens, Stage::Area{{across.x, up.x}, {across.y, up.y}});
}

// A beam's lamp or projector; exactly one of them.
template <class ReadLight>
void readLights(ConfigFields& fields, Stage::Beam& beam, int& lights, ReadLight readLight) {
    fields.optional().read("light", beam.light, [&lights, readLight](const ConfigNode& node) {
        ++lights;
        return readLight(node);
    });
    fields.optional().read("projector", beam.lit, [&, readLight](const ConfigNode& node) -> Result<std::optional<Stage::Area>> {
        if (lights++ > 0) return node.error("there is a 'light' too, and a stage has one; take either away");
        const auto [lens, picture] = TRY(readProjector(node, readLight));
        beam.light = lens;
        return std::optional(picture);
    });
}
constexpr auto kNoLight = "no light; say 'light: [x, y, z]' for a lamp, or 'projector:' with its 'lens' and 'picture'";

Result<double> readRadius(const ConfigNode& node) {
    const double radius = TRY(node.number(-kFarthest, kFarthest, "m"));
    if (std::abs(radius) < kLeastRadius)
        return node.error(fmt::format(
            "a screen curved by {} m is a pillar; {} m or more are allowed: positive where it is hollow towards the light, "
            "negative where it bulges; leave 'radius' out for a flat one",
            shortest(radius), shortest(kLeastRadius)));
    return radius;
}

Result<Screen> readScreen(const ConfigNode& node, bool isFirst) {
    Screen screen;
    ConfigFields fields(node);
    if (!isFirst) {
        fields.read("at", screen.at, [](const ConfigNode& at) -> Result<glm::dvec2> {
            const glm::dvec3 place = TRY(at.vector3(-kFarthest, kFarthest, "m"));
            if (place.y != 0) return at.error("a screen stands on the floor; give it a y of 0");
            return glm::dvec2(place.x, place.z);
        });
        fields.optional().angle("turned", screen.turn, -360, 360);
    }
    fields.optional().read("radius", screen.radius, readRadius);
    TRY(fields.finish());
    return screen;
}

std::string nameOf(std::size_t screen, const Stage& stage) {
    return screen > 0                    ? fmt::format("screen {}", screen + 1)
           : stage.screens[0].isCurved() ? "the screen"
                                         : "the screen, which is at z = 0";
}

// How deep the noted points reach behind a screen, metres, and behind which screen, if any.
struct Behind {
    double depth = kRounding;
    std::optional<std::size_t> screen;
    void note(const Stage& stage, const glm::dvec3& point) {
        glm::dvec3 outward;
        for (std::size_t i = 0; i < stage.screens.size(); ++i)
            if (const double far = -stage.screens[i].distance(point, outward); far > depth) depth = far, screen = i;
    }
};

// Error: the light cannot reach its screen, or one screen blocks the beam of another. `beam`: the
// stage's last one.
Result<void> checkBeam(const ConfigNode& node, const Stage& stage, const Stage::Beam& beam) {
    glm::dvec3 outward;
    const Screen& own = stage.screens[beam.screen];
    if (const double away = own.screenFromStage(beam.light).z; away <= 0)
        return node.error(fmt::format(
            "its light is {} m behind its screen; people stand between the two: move it, or turn the screen by 180 degrees",
            shortest(-away)));
    if (const double away = own.distance(beam.light, outward); away < kNearestLight)
        return node.error(
            fmt::format("its light is {:.3g} m in front of its screen, and nobody fits between; move it to {} m or farther", away,
                        shortest(kNearestLight)));
    for (std::size_t i = 0; i < stage.beams.size(); ++i)
        for (std::size_t k = 0; k < stage.screens.size(); ++k)
            if (stage.screens[k].distance(stage.beams[i].light, outward) < 0)
                return node.error(
                    fmt::format("the light of beam {} is behind {}; that would keep it from its own screen: move one of them",
                                i + 1, nameOf(k, stage)));
    return {};
}

// Reads a further beam and adds it to `stage`.
Result<void> readFurther(const ConfigNode& node, Stage& stage) {
    Stage::Beam beam;
    int lights = 0;
    ConfigFields fields(node);
    readLights(fields, beam, lights, [](const ConfigNode& at) -> Result<glm::dvec3> {
        const glm::dvec3 light = TRY(at.vector3(-kFarthest, kFarthest, "m"));
        if (light.y < 0) return at.error(fmt::format(kBelowFloor, shortest(-light.y)));
        return light;
    });
    fields.optional().read("screen", beam.screen, [&](const ConfigNode& at) -> Result<std::size_t> {
        const Screen screen = TRY(readScreen(at, false));
        const auto known = std::find(stage.screens.begin(), stage.screens.end(), screen);
        const auto index = static_cast<std::size_t>(known - stage.screens.begin());
        if (known == stage.screens.end()) stage.screens.push_back(screen);
        return index;
    });
    TRY(fields.finish());
    if (lights == 0) return node.error(kNoLight);
    for (std::size_t i = 0; i < stage.beams.size(); ++i)
        if (stage.beams[i].screen == beam.screen && stage.beams[i].light == beam.light)
            return node.error(fmt::format(
                "it is beam {} over again, and its shadow would be the same; move its light, or give it a screen of its own",
                i + 1));
    stage.beams.push_back(beam);
    return checkBeam(node, stage, beam);
}

Result<Stage::Area> readStanding(const ConfigNode& node, double lightZ) {
    glm::dvec2 x(-Stage::Area::kFar, Stage::Area::kFar), z(0, Stage::Area::kFar);
    ConfigFields fields(node);
    fields.optional().read("x", x, [](const ConfigNode& at) { return readRange(at, -kFarthest); });
    fields.optional().read("z", z, [&](const ConfigNode& at) -> Result<glm::dvec2> {
        const glm::dvec2 range = TRY(readRange(at, 0));
        if (range.y >= lightZ)
            return at.error(
                fmt::format("people may stand as far as z = {} m, and the light is at {} m: who is behind it throws no shadow; "
                            "end before it",
                            shortest(range.y), shortest(lightZ)));
        return range;
    });
    TRY(fields.finish());
    return Stage::Area{{x.x, z.x}, {x.y, z.y}};
}

// The name of a platform or a prop. Names are unique.
Result<std::string> readName(const ConfigNode& node, std::vector<std::string>& names) {
    const std::string name = TRY(node.text());
    if (std::find(names.begin(), names.end(), name) != names.end())
        return node.error(fmt::format("two things are called '{}'; give each a name of its own", name));
    if (name.find('/') != std::string::npos)
        return node.error(
            fmt::format("'{}': a mesh's file may have this name (prop-NAME.obj), and '/' separates folders; leave it out", name));
    names.push_back(name);
    return name;
}

Result<Stage::Platform> readPlatform(const ConfigNode& node, const Stage& stage, std::vector<std::string>& names) {
    Stage::Platform platform;
    ConfigFields fields(node);
    fields.read("name", platform.name, [&](const ConfigNode& at) { return readName(at, names); });
    fields.vector3("centre", platform.centre, -kFarthest, kFarthest, "m");
    fields.vector3("size", platform.size, kLeastSize, kMostSize, "m");
    fields.optional().angle("turned", platform.turn, -360, 360);
    TRY(fields.finish());
    if (const double bottom = platform.centre.y - 0.5 * platform.size.y; bottom < -kRounding)
        return node.error(fmt::format(
            "platform '{}' reaches {:.3f} m below the floor; the y of a centre is half the height if it stands on it: {}",
            platform.name, -bottom, shortest(0.5 * platform.size.y)));
    Behind behind;
    constexpr int kSteps = 8;  // a bulging screen may intrude between the corners
    for (int i = 0; i <= kSteps; ++i)
        for (int j = 0; j <= kSteps; ++j)
            behind.note(stage, platform.point({double(i) / kSteps - 0.5, 0, double(j) / kSteps - 0.5}));
    if (behind.screen)
        return node.error(fmt::format("platform '{}' reaches {:.3f} m through {}; move its centre by as much", platform.name,
                                      behind.depth, nameOf(*behind.screen, stage)));
    for (std::size_t i = 0; i < stage.beams.size(); ++i)
        if (glm::dvec3 outward; platform.distance(stage.beams[i].light, outward) < 0)
            return node.error(fmt::format("the light{} is inside platform '{}'; move one of them",
                                          i > 0 ? fmt::format(" of beam {}", i + 1) : std::string(), platform.name));
    return platform;
}

Result<Prop::Holder> readHolder(const ConfigNode& node) {
    Prop::Holder holder;
    std::size_t number = 0;
    ConfigFields fields(node);
    fields.integer("actor", number, 1, 50);
    fields.read("part", holder.part,
                [](const ConfigNode& at) -> Result<BodyPart> { return static_cast<BodyPart>(TRY(at.choice(partNames()))); });
    TRY(fields.finish());
    holder.actor = number - 1;
    return holder;
}

Result<std::shared_ptr<const Prop::Shape>> readShape(const ConfigNode& node, double scale) {
    auto read = readMesh(TRY(node.path()));
    if (!read) return node.error(read.error().message());
    TriangleMesh mesh = std::move(read).value();
    if (mesh.triangles.size() > kMostTriangles)
        return node.error(fmt::format("it has {} triangles, and {} are the most; simplify it, a shadow needs few",
                                      mesh.triangles.size(), kMostTriangles));
    glm::vec3 least(std::numeric_limits<float>::infinity()), most = -least;
    for (glm::vec3& vertex : mesh.vertices) {
        vertex *= static_cast<float>(scale);
        least = glm::min(least, vertex), most = glm::max(most, vertex);
    }
    const glm::dvec3 size = glm::dvec3(most) - glm::dvec3(least);
    const double longest = std::max({size.x, size.y, size.z});
    if (longest < kLeastSize || longest > kMostSize)
        return node.error(
            fmt::format("it is {:.3g} m long, {} .. {} m are allowed; scale is the metres that a unit of the mesh's file "
                        "has: 0.01 for centimetres, 0.001 for millimetres",
                        longest, shortest(kLeastSize), shortest(kMostSize)));
    return std::shared_ptr<const Prop::Shape>(std::make_shared<const Prop::Shape>(std::move(mesh)));
}

Result<Prop> readProp(const ConfigNode& node, const Stage& stage, std::vector<std::string>& names) {
    Prop prop;
    double scale = 1;
    glm::dvec3 turned(0);
    ConfigFields fields(node);
    fields.read("name", prop.name, [&](const ConfigNode& at) { return readName(at, names); });
    fields.optional().number("scale", scale, 1e-6, 1e6);
    fields.read("mesh", prop.shape, [&](const ConfigNode& at) -> Result<std::shared_ptr<const Prop::Shape>> {
        prop.file = TRY(at.path());
        return readShape(at, scale);
    });
    fields.optional().read("held_by", prop.holder, [](const ConfigNode& at) -> Result<std::optional<Prop::Holder>> {
        return std::optional(TRY(readHolder(at)));
    });
    const double far = prop.holder ? kMostOffset : kFarthest;
    fields.optional().vector3("at", prop.place, -far, far, "m");
    fields.optional().vector3("turned", turned, -360, 360, "degrees");
    TRY(fields.finish());
    prop.turn = glm::quat_cast(rotationXyz({radians(turned.x), radians(turned.y), radians(turned.z)}));
    if (prop.holder) return prop;
    glm::dvec3 least(Stage::Area::kFar), most = -least;
    Behind behind;
    for (const glm::vec3& vertex : prop.shape->mesh.vertices) {
        const glm::dvec3 point = prop.place + prop.turn * glm::dvec3(vertex);
        least = glm::min(least, point), most = glm::max(most, point);
        behind.note(stage, point);
    }
    if (least.y < -kRounding)
        return node.error(
            fmt::format("prop '{}' reaches {:.3f} m below the floor; raise its 'at' by as much", prop.name, -least.y));
    if (behind.screen)
        return node.error(fmt::format("prop '{}' reaches {:.3f} m through {}; move its 'at' by as much", prop.name, behind.depth,
                                      nameOf(*behind.screen, stage)));
    if (most.z >= stage.beams[0].light.z)
        return node.error(fmt::format(
            "prop '{}' reaches to z = {:.3f} m, and the light is at {} m: what is not before it throws no shadow; move "
            "it towards the screen",
            prop.name, most.z, shortest(stage.beams[0].light.z)));
    return prop;
}

}  // namespace

Result<Stage> readStage(const fs::path& file) {
    const ConfigNode root = TRY(ConfigNode::load(file));
    Stage stage;
    int lights = 0;
    std::vector<std::string> names;
    ConfigFields fields(root);
    fields.header("stage", kVersion);
    readLights(fields, stage.beams[0], lights, readLight);
    fields.optional().read("screen", stage.screens[0], [](const ConfigNode& node) { return readScreen(node, true); });
    fields.optional().read("further_beams", stage.beams, [&](const ConfigNode& node) -> Result<std::vector<Stage::Beam>> {
        for (const ConfigNode& item : TRY(node.items(1, kMostFurther))) TRY(readFurther(item, stage));
        return stage.beams;
    });
    fields.optional().read("standing", stage.standing, [&](const ConfigNode& node) -> Result<std::optional<Stage::Area>> {
        return std::optional(TRY(readStanding(node, stage.beams[0].light.z)));
    });
    fields.optional().list(
        "platforms", stage.platforms, [&](const ConfigNode& node) { return readPlatform(node, stage, names); }, 0, kMostThings);
    fields.optional().list(
        "props", stage.props, [&](const ConfigNode& node) { return readProp(node, stage, names); }, 0, kMostThings);
    TRY(fields.finish());
    if (lights == 0) return root.error(kNoLight);
    if (stage.screens[0].isCurved()) TRY(checkBeam(root, stage, stage.beams[0]));
    return stage;
}

}  // namespace fantascope::theatre
