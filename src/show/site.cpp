#include "show/site.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace fantascope::show {

namespace {

constexpr int kNewestVersion = 1;

// Limits of the file's numbers. The wide ones only catch a slipped digit or unit.
constexpr int kMostPixels = 16384;         // along one side of a picture: what graphics cards take
constexpr double kFarthestCorner = 32768;  // pixels: a corner may lie outside its picture
constexpr double kFarthest = 1000;         // metres
constexpr int kLastUniverse = 63999;       // ANSI E1.31
constexpr int kLastSlot = 512;             // ANSI E1.11
constexpr int kLastCoil = 1967;            // one Modbus request writes 1968 coils at most (Modbus 1.1b3, section 6.11)
constexpr int kLastButton = 255;           // more than any hand-held device has

// A reader of values that may stand only once among all that share `taken`.
template <class Value, class Read>
auto once(std::set<Value>& taken, std::string_view owner, Read read) {
    return [&taken, owner, read](const ConfigNode& node) -> Result<Value> {
        const Value value = static_cast<Value>(TRY(read(node)));
        if (!taken.insert(value).second)
            return node.error(fmt::format("{} is taken by another {}; each needs its own", value, owner));
        return value;
    };
}

// Names end up in the names of recorded files.
Result<std::string> readName(const ConfigNode& node) {
    const std::string name = TRY(node.text());
    if (name.front() == '.' || name.find('/') != std::string::npos)
        return node.error(fmt::format("'{}' is no name: it may not hold a '/' or begin with a '.'", name));
    return name;
}

auto onceNamed(std::set<std::string>& taken, std::string_view owner) { return once(taken, owner, readName); }

auto onceNumbered(std::set<int>& taken, std::string_view owner, int low, int high) {
    return once(taken, owner, [low, high](const ConfigNode& node) { return node.integer(low, high); });
}

// The driver's own keys are left to the driver.
Result<DeviceConfig> readDevice(const ConfigNode& node) {
    for (const auto& [key, value] : TRY(node.entries()))
        if (key == "driver") return DeviceConfig{TRY(value.text()), node};
    return node.error("'driver' is missing: the name of the device's driver");
}

Result<glm::ivec2> readSize(const ConfigNode& node) {
    const auto sides = TRY(node.items(2, 2));
    return glm::ivec2(TRY(sides[0].integer(1, kMostPixels)), TRY(sides[1].integer(1, kMostPixels)));
}

Result<std::array<glm::dvec2, 4>> readCorners(const ConfigNode& node) {
    std::array<glm::dvec2, 4> corners;
    const auto items = TRY(node.items(corners.size(), corners.size()));
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = TRY(items[i].vector2(-kFarthestCorner, kFarthestCorner, "px"));
    if (const auto why = whyNotConvex(corners)) return node.error(*why);
    return corners;
}

// The keys that say where a projector or a camera stands and looks. Ask for pose() after the fields are finished.
struct Aim {
    glm::dvec3 position{0.0}, target{0.0}, up{0, 1, 0};

    void declare(ConfigFields& fields) {
        fields.vector3("position", position, -kFarthest, kFarthest, "m");
        fields.vector3("look_at", target, -kFarthest, kFarthest, "m");
        fields.optional().vector3("up", up, -1, 1);
    }
    Result<Pose> pose(const ConfigNode& node) const {
        const auto pose = Pose::lookingAt(position, target, up);
        if (!pose) return node.error(pose.error().message());
        return *pose;
    }
};

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

Result<Output> readOutput(const ConfigNode& node, std::set<std::string>& names) {
    Output output;
    std::optional<std::array<glm::dvec2, 4>> corners;
    ConfigFields fields(node);
    fields.read("name", output.name, onceNamed(names, "output"));
    fields.read("display", output.display, readDevice);
    fields.read("size", output.size, readSize);
    fields.number("refresh_rate", output.refreshRate, 1, 240, "Hz");
    fields.optional().read("corners", corners, readCorners);
    fields.optional().read("projector", output.projector, readProjector);
    fields.optional().read("surface", output.surface, readSurface);
    TRY(fields.finish());
    output.corners = corners.value_or(rectangleCorners(output.size.x, output.size.y));
    if (output.projector && output.surface &&
        glm::dot(output.surface->normal, output.projector->pose.position - output.surface->point) <= 0)
        return node.error("the projector stands behind its surface; turn the surface's normal towards the projector");
    return output;
}

Result<Universe> readUniverse(const ConfigNode& node, std::set<int>& numbers) {
    Universe universe;
    ConfigFields fields(node);
    fields.read("number", universe.number, onceNumbered(numbers, "universe", 1, kLastUniverse));
    fields.read("port", universe.port, readDevice);
    TRY(fields.finish());
    return universe;
}

// `owners`: which fixture has the slot (universe, address) so far.
Result<Fixture> readFixture(const ConfigNode& node, std::set<std::string>& names, const std::set<int>& universes,
                            std::map<std::pair<int, int>, std::string>& owners) {
    Fixture fixture;
    std::set<std::string> channels;
    ConfigFields fields(node);
    fields.read("name", fixture.name, onceNamed(names, "fixture"));
    fields.read("universe", fixture.universe, [&](const ConfigNode& value) -> Result<int> {
        const int number = static_cast<int>(TRY(value.integer(1, kLastUniverse)));
        if (!universes.contains(number))
            return value.error(fmt::format("universe {} is not declared; add it under 'universes'", number));
        return number;
    });
    fields.integer("address", fixture.address, 1, kLastSlot);
    fields.list("channels", fixture.channels, onceNamed(channels, "channel of this fixture"), 1, kLastSlot);
    TRY(fields.finish());

    const int last = fixture.address + static_cast<int>(fixture.channels.size()) - 1;
    if (last > kLastSlot)
        return node.error(
            fmt::format("'{}' would reach slot {}, a universe ends at {}; move its address", fixture.name, last, kLastSlot));
    for (int slot = fixture.address; slot <= last; ++slot) {
        const auto [owner, isFree] = owners.try_emplace({fixture.universe, slot}, fixture.name);
        if (!isFree)
            return node.error(fmt::format("'{}' and '{}' overlap at slot {} of universe {}; move one of them", owner->second,
                                          fixture.name, slot, fixture.universe));
    }
    return fixture;
}

Result<Relay> readRelay(const ConfigNode& node, std::set<std::string>& names, std::set<int>& coils) {
    Relay relay;
    ConfigFields fields(node);
    fields.read("name", relay.name, onceNamed(names, "relay"));
    fields.read("coil", relay.coil, onceNumbered(coils, "relay", 0, kLastCoil));
    fields.choice("safe", relay.safe, {"off", "on"});
    TRY(fields.finish());
    return relay;
}

Result<std::vector<std::pair<int, Button>>> readButtons(const ConfigNode& node) {
    constexpr std::pair<std::string_view, Button> kKeys[] = {
        {"go", Button::Go}, {"back", Button::Back}, {"blackout", Button::Blackout}};
    std::vector<std::pair<int, Button>> buttons;
    std::set<int> numbers;
    ConfigFields fields(node);
    for (const auto& [key, button] : kKeys) {
        if (button != Button::Go) fields.optional();
        std::optional<int> number;
        fields.read(key, number, onceNumbered(numbers, "button", 1, kLastButton));
        if (number) buttons.emplace_back(*number, button);
    }
    TRY(fields.finish());
    return buttons;
}

}  // namespace

Homography Output::projectorFromCanvas(double canvasAspect) const {
    return Homography::fromCorners(rectangleCorners(canvasAspect, 1), corners).value();
}

std::size_t Site::firstLevel(std::size_t fixture) const {
    std::size_t channels = 0;
    for (std::size_t before = 0; before < fixture; ++before) channels += fixtures[before].channels.size();
    return channels;
}

std::size_t Site::channelCount() const { return firstLevel(fixtures.size()); }

std::size_t Site::coilCount() const {
    std::size_t count = 0;
    for (const Relay& relay : relays) count = std::max(count, static_cast<std::size_t>(relay.coil) + 1);
    return count;
}

Result<Site> readSite(const std::filesystem::path& file) {
    const ConfigNode root = TRY(ConfigNode::load(file));
    Site site;
    site.file = file;
    ConfigFields fields(root);
    fields.header("site", kNewestVersion);

    std::set<std::string> outputNames;
    fields.list(
        "outputs", site.outputs, [&](const ConfigNode& node) { return readOutput(node, outputNames); }, 1);

    std::set<int> universeNumbers;
    fields.optional().list("universes", site.universes,
                           [&](const ConfigNode& node) { return readUniverse(node, universeNumbers); });
    std::set<std::string> fixtureNames;
    std::map<std::pair<int, int>, std::string> slotOwners;
    fields.optional().list("fixtures", site.fixtures,
                           [&](const ConfigNode& node) { return readFixture(node, fixtureNames, universeNumbers, slotOwners); });

    fields.optional().read("relay_bank", site.relayBank, [&](const ConfigNode& node) -> Result<DeviceConfig> {
        DeviceConfig device;
        std::set<std::string> names;
        std::set<int> coils;
        ConfigFields bank(node);
        bank.read("device", device, readDevice);
        bank.list(
            "relays", site.relays, [&](const ConfigNode& relay) { return readRelay(relay, names, coils); }, 1);
        TRY(bank.finish());
        return device;
    });

    fields.optional().read("cue_controller", site.cueController, [&](const ConfigNode& node) -> Result<DeviceConfig> {
        DeviceConfig device;
        ConfigFields controller(node);
        controller.read("device", device, readDevice);
        controller.read("buttons", site.buttons, readButtons);
        TRY(controller.finish());
        return device;
    });

    fields.optional().read("camera", site.camera, [&](const ConfigNode& node) -> Result<DeviceConfig> {
        DeviceConfig device;
        NominalCamera camera;
        Aim aim;
        ConfigFields keys(node);
        keys.read("device", device, readDevice);
        keys.read("size", camera.size, readSize);
        keys.angle("field_of_view", camera.fieldOfView, 1, 179);
        aim.declare(keys);
        keys.optional().number("k1", camera.k1, -1, 1);
        keys.optional().number("k2", camera.k2, -1, 1);
        TRY(keys.finish());
        camera.pose = TRY(aim.pose(node));
        site.nominalCamera = camera;
        return device;
    });

    fields.optional().read("simulation", site.simulation, [](const ConfigNode& node) -> Result<ConfigNode> { return node; });
    TRY(fields.finish());
    return site;
}

}  // namespace fantascope::show
