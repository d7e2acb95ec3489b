#include "show/site.h"

#include "core/check.h"
#include "core/file.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

namespace fantascope::show {

namespace {

constexpr int kNewestVersion = 1;

// Limits of the file's numbers. The wide ones only catch a slipped digit or unit.
constexpr int kMostPixels = 16384;         // along one side of a picture: what graphics cards take
constexpr double kFarthestCorner = 32768;  // pixels: a corner may lie outside its picture
constexpr double kFarthest = 1000;         // metres
constexpr double kSmallestCanvas = 0.01;   // metres
constexpr int kLastUniverse = 63999;       // ANSI E1.31
constexpr int kLastSlot = 512;             // ANSI E1.11
constexpr double kLongestEndFade = 60;     // seconds
constexpr int kLastCoil = 1967;            // one Modbus request writes 1968 coils at most (Modbus 1.1b3, section 6.11)
constexpr int kLastInput = 1999;           // one Modbus request reads 2000 inputs at most (section 6.2)
constexpr int kLastButton = 255;           // more than any hand-held device has

constexpr std::pair<std::string_view, Button> kButtonKeys[] = {
    {"go", Button::Go},         {"back", Button::Back},  {"blackout", Button::Blackout},
    {"edit", Button::Edit},     {"left", Button::Left},  {"right", Button::Right},
    {"up", Button::Up},         {"down", Button::Down},  {"next", Button::Next},
    {"output", Button::Output}, {"tool", Button::Tool},  {"picture", Button::Picture},
    {"undo", Button::Undo},     {"write", Button::Write}};

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

// What the drivers say of the devices. It is told beside what else is wrong, so that one mistake in
// a device does not hide others.
class DriversWord {
public:
    explicit DriversWord(DeviceReader* reader) : reader_(reader) {}

    // Asks the drivers, if there are any, of the device at `at`: ask(reader).
    template <class Ask>
    void ask(const ConfigNode& at, Ask ask) {
        if (reader_ != nullptr) said_.emplace_back(at, ask(*reader_));
    }
    void tell(ConfigFields& fields) const {
        for (const auto& [at, word] : said_) fields.check(at, word);
    }

private:
    DeviceReader* reader_;
    std::vector<std::pair<ConfigNode, Result<void>>> said_;
};

Result<glm::ivec2> readSize(const ConfigNode& node) {
    const auto sides = TRY(node.items(2, 2));
    return glm::ivec2(TRY(sides[0].integer(1, kMostPixels)), TRY(sides[1].integer(1, kMostPixels)));
}

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

// The keys that say where a projector or a camera stands and looks. Ask for pose() after the fields
// are finished.
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

Result<Desk> readDesk(const ConfigNode& node, int universe, DriversWord& drivers) {
    Desk desk;
    ConfigFields fields(node);
    fields.read("device", desk.device, [&](const ConfigNode& value) -> Result<DeviceConfig> {
        DeviceConfig device = TRY(readDevice(value));
        drivers.ask(value, [&](DeviceReader& reader) { return reader.desk(device, universe); });
        return device;
    });
    fields.optional().choice("merge", desk.merge.rule, {"htp", "ltp"});
    fields.optional().integer("own_priority", desk.merge.ownPriority, 0, 200);  // ANSI E1.31
    fields.optional().time("settling", desk.merge.settling, 0, 60);
    TRY(fields.finish());
    return desk;
}

// The universes that fixtures may be on.
struct Universes {
    std::set<int> numbers;
    bool areAllKnown = true;  // false: a number could not be read
};

Result<Universe> readUniverse(const ConfigNode& node, Universes& universes, DriversWord& drivers) {
    Universe universe;
    ConfigFields fields(node);
    fields.read("number", universe.number, onceNumbered(universes.numbers, "universe", 1, kLastUniverse));
    universes.areAllKnown = universes.areAllKnown && fields.right();
    fields.read("port", universe.port, [&](const ConfigNode& value) -> Result<DeviceConfig> {
        DeviceConfig device = TRY(readDevice(value));
        drivers.ask(value, [&](DeviceReader& reader) { return reader.port(device, universe.number); });
        return device;
    });
    fields.optional().read("desk", universe.desk, [&](const ConfigNode& desk) -> Result<std::optional<Desk>> {
        return std::optional(TRY(readDesk(desk, universe.number, drivers)));
    });
    TRY(fields.finish());
    return universe;
}

// One level for all channels, or a map with the levels of some; the others are dark.
Result<std::vector<float>> readEndLevels(const ConfigNode& node, const Fixture& fixture) {
    const std::vector<std::string>& channels = fixture.channels;
    if (!node.isMap()) return std::vector<float>(channels.size(), static_cast<float>(TRY(node.number(0, 1))));
    std::vector<float> levels(channels.size());
    for (const auto& [channel, level] : TRY(node.entries())) {
        const auto found = std::ranges::find(channels, channel);
        if (found == channels.end())
            return level.error(
                fmt::format("'{}' has no channel '{}'; it has {}", fixture.name, channel, fmt::join(channels, ", ")));
        levels[static_cast<std::size_t>(found - channels.begin())] = static_cast<float>(TRY(level.number(0, 1)));
    }
    return levels;
}

// `owners`: which fixture has the slot (universe, address) so far.
Result<Fixture> readFixture(const ConfigNode& node, std::set<std::string>& names, const Universes& universes,
                            std::map<std::pair<int, int>, std::string>& owners) {
    Fixture fixture;
    std::set<std::string> channels;
    ConfigFields fields(node);
    fields.read("name", fixture.name, onceNamed(names, "fixture"));
    fields.read("universe", fixture.universe, [&](const ConfigNode& value) -> Result<int> {
        const int number = static_cast<int>(TRY(value.integer(1, kLastUniverse)));
        if (!universes.numbers.contains(number) && universes.areAllKnown)
            return value.error(fmt::format("universe {} is not declared; add it under 'universes'", number));
        return number;
    });
    fields.integer("address", fixture.address, 1, kLastSlot);
    fields.list("channels", fixture.channels, onceNamed(channels, "channel of this fixture"), 1, kLastSlot);
    fields.optional().read("end", fixture.end, [&](const ConfigNode& value) { return readEndLevels(value, fixture); });
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

// The banks of one kind, and which places in each are taken.
class Banks {
public:
    // The keys of the file's lists of them, and of what is in them.
    Banks(std::string_view key, std::string_view membersKey) : key_(key), membersKey_(membersKey) {}

    Result<Bank> read(const ConfigNode& node, std::set<std::string>& deviceNames) {
        Bank bank;
        ConfigFields fields(node);
        fields.read("name", bank.name, onceNamed(deviceNames, "device"));
        fields.read("device", bank.device, readDevice);
        banks_.push_back(bank);  // what is wrong with it is no fault of its relays or contacts
        nodes_.push_back(node);
        names_.push_back(bank.name);
        areAllKnown_ = areAllKnown_ && !bank.name.empty();
        TRY(fields.finish());
        return bank;
    }
    // Declares the keys that say where a relay or contact is. Who has one bank need not call it by
    // its name.
    void declarePlace(ConfigFields& fields, std::size_t& bank, std::string_view placeKey, int& place, std::string_view owner,
                      int last) {
        std::optional<std::size_t> known;
        if (names_.size() == 1) known = 0;
        if (names_.size() <= 1) fields.optional();
        fields.read("bank", known, [this](const ConfigNode& node) -> Result<std::optional<std::size_t>> {
            auto chosen = node.choice(names_);
            if (!chosen && !areAllKnown_) return std::optional<std::size_t>();
            return std::optional(TRY(std::move(chosen)));
        });
        fields.read(placeKey, place, [&](const ConfigNode& node) -> Result<int> {
            if (names_.empty() && !std::exchange(toldOfNone_, true))
                return node.error(fmt::format("there is no bank; add it under '{}'", key_));
            if (!known) return 0;  // whether the place is free nobody can say
            bank = *known;
            return onceNumbered(taken_[bank], owner, 0, last)(node);
        });
        areAllPlaced_ = areAllPlaced_ && fields.right();
    }
    // Once all relays or contacts are read.
    void check(ConfigFields& fields) const {
        for (std::size_t bank = 0; bank < nodes_.size() && areAllKnown_ && areAllPlaced_; ++bank)
            if (!taken_.contains(bank))
                fields.check(nodes_[bank],
                             nodes_[bank].error(fmt::format("nothing is in the bank '{}'; say what under '{}', or take it away",
                                                            names_[bank], membersKey_)));
    }

    // ask(bank, how many places it has) of every bank whose device is named.
    template <class Ask>
    void each(Ask ask) const {
        for (std::size_t bank = 0; bank < banks_.size(); ++bank)
            if (const auto taken = taken_.find(bank); taken != taken_.end() && !banks_[bank].device.driver.empty())
                ask(banks_[bank], static_cast<std::size_t>(*taken->second.rbegin()) + 1);
    }

private:
    const std::string_view key_, membersKey_;
    std::vector<Bank> banks_;
    std::vector<ConfigNode> nodes_;
    std::vector<std::string> names_;  // empty where one could not be read
    bool areAllKnown_ = true;         // the names
    bool areAllPlaced_ = true;        // nothing is wrong with what is in the banks
    bool toldOfNone_ = false;
    std::map<std::size_t, std::set<int>> taken_;  // places in each
};

Result<Relay> readRelay(const ConfigNode& node, std::set<std::string>& names, Banks& banks) {
    Relay relay;
    ConfigFields fields(node);
    fields.read("name", relay.name, onceNamed(names, "relay"));
    banks.declarePlace(fields, relay.bank, "coil", relay.coil, "relay of its bank", kLastCoil);
    fields.choice("safe", relay.safe, {"off", "on"});
    TRY(fields.finish());
    return relay;
}

Result<Contact> readContact(const ConfigNode& node, std::set<std::string>& names, Banks& banks) {
    const auto readAction = [](const ConfigNode& value) -> Result<std::optional<ContactAction>> {
        return std::optional(static_cast<ContactAction>(TRY(value.choice({"go", "back", "blackout", "dark", "light"}))));
    };
    Contact contact;
    ConfigFields fields(node);
    fields.read("name", contact.name, onceNamed(names, "contact"));
    banks.declarePlace(fields, contact.bank, "input", contact.input, "contact of its bank", kLastInput);
    fields.optional().read("closes", contact.closes, readAction);
    fields.optional().read("opens", contact.opens, readAction);
    TRY(fields.finish());
    if (!contact.closes && !contact.opens)
        return node.error(fmt::format("'{}' asks for nothing; say what it does when it 'closes' or 'opens'", contact.name));
    return contact;
}

Result<std::vector<std::pair<int, Button>>> readButtons(const ConfigNode& node) {
    std::vector<std::pair<int, Button>> buttons;
    std::set<int> numbers;
    ConfigFields fields(node);
    for (const auto& [key, button] : kButtonKeys) {
        if (button != Button::Go) fields.optional();
        std::optional<int> number;
        fields.read(key, number, onceNumbered(numbers, "button", 1, kLastButton));
        if (number) buttons.emplace_back(*number, button);
    }
    TRY(fields.finish());
    return buttons;
}

}  // namespace

std::string_view nameOf(Button button) {
    for (const auto& [key, known] : kButtonKeys)
        if (known == button) return key;
    FANTASCOPE_CHECK(false, "every button has a key");
}

Site Site::scaled(glm::dvec2 factor) const {
    Site result = *this;
    for (Output& output : result.outputs) {
        Projection& projection = output.projection;
        projection.size = glm::max(glm::ivec2(glm::round(glm::dvec2(projection.size) * factor)), 1);
        projection.warp = Warp::of(projection.warp.shape().scaled(factor)).value();
        for (Mask& mask : projection.masks) {
            for (glm::dvec2& point : mask.polygon) point *= factor;
            mask.feather *= std::sqrt(factor.x * factor.y);
        }
    }
    return result;
}

std::vector<std::size_t> Site::outputsOn(std::string_view canvas) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < outputs.size(); ++i)
        if (outputs[i].canvas == canvas) found.push_back(i);
    return found;
}

std::size_t Site::firstLevel(std::size_t fixture) const {
    std::size_t channels = 0;
    for (std::size_t before = 0; before < fixture; ++before) channels += fixtures[before].channels.size();
    return channels;
}

std::size_t Site::channelCount() const { return firstLevel(fixtures.size()); }

std::size_t Site::coilCount(std::size_t bank) const {
    std::size_t count = 0;
    for (const Relay& relay : relays)
        if (relay.bank == bank) count = std::max(count, static_cast<std::size_t>(relay.coil) + 1);
    return count;
}

std::size_t Site::inputCount(std::size_t bank) const {
    std::size_t count = 0;
    for (const Contact& contact : contacts)
        if (contact.bank == bank) count = std::max(count, static_cast<std::size_t>(contact.input) + 1);
    return count;
}

Result<Site> readSite(const std::filesystem::path& file, DeviceReader* devices) {
    return parseSite(TRY(readFile(file)), file, devices);
}

Result<Site> parseSite(std::string text, const std::filesystem::path& file, DeviceReader* devices) {
    const ConfigNode root = TRY(ConfigNode::parse(text, file));
    DriversWord drivers(devices);
    // As long as there was one bank of each kind.
    for (const auto& [key, value] : TRY(root.entries()))
        for (const auto& [old, members] : {std::pair("relay_bank", "relays"), std::pair("contact_bank", "contacts")})
            if (key == old)
                return value.error(
                    fmt::format("there may be several now; write '{0}s: [{{name: NAME, device: ...}}]', and '{1}' "
                                "beside it instead of in it",
                                old, members));
    Site site;
    site.file = file;
    site.text = std::move(text);
    ConfigFields fields(root);
    fields.header("site", kNewestVersion);

    std::set<std::string> outputNames;
    std::vector<std::pair<std::string, ConfigNode>> canvasNodes;
    fields.list(
        "outputs", site.outputs,
        [&](const ConfigNode& node) -> Result<Output> {
            Output output = TRY(readOutput(node, outputNames, drivers));
            canvasNodes.emplace_back(output.canvas, node);
            if (output.canvas.empty()) output.canvas = output.name;
            return output;
        },
        1);

    Universes universes;
    fields.optional().list("universes", site.universes,
                           [&](const ConfigNode& node) { return readUniverse(node, universes, drivers); });
    std::set<std::string> fixtureNames;
    std::map<std::pair<int, int>, std::string> slotOwners;
    fields.optional().list("fixtures", site.fixtures,
                           [&](const ConfigNode& node) { return readFixture(node, fixtureNames, universes, slotOwners); });

    fields.optional().time("end_fade", site.endFade, 0, kLongestEndFade);

    // What any other device is called, in its status and in a fault script.
    std::set<std::string> deviceNames(outputNames);
    deviceNames.insert({"cue controller", "camera"});
    for (const int number : universes.numbers)
        deviceNames.insert({fmt::format("universe {}", number), fmt::format("desk {}", number)});
    Banks relayBanks("relay_banks", "relays"), contactBanks("contact_banks", "contacts");
    std::set<std::string> relayNames, contactNames;
    fields.optional().list("relay_banks", site.relayBanks,
                           [&](const ConfigNode& node) { return relayBanks.read(node, deviceNames); });
    fields.optional().list("relays", site.relays,
                           [&](const ConfigNode& node) { return readRelay(node, relayNames, relayBanks); });
    fields.optional().list("contact_banks", site.contactBanks,
                           [&](const ConfigNode& node) { return contactBanks.read(node, deviceNames); });
    fields.optional().list("contacts", site.contacts,
                           [&](const ConfigNode& node) { return readContact(node, contactNames, contactBanks); });

    fields.optional().read("cue_controller", site.cueController, [&](const ConfigNode& node) -> Result<DeviceConfig> {
        DeviceConfig device;
        ConfigFields controller(node);
        controller.read("device", device, readDevice);
        if (!device.driver.empty())
            drivers.ask(device.options, [&](DeviceReader& reader) { return reader.cueController(device); });
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
        if (!device.driver.empty()) drivers.ask(device.options, [&](DeviceReader& reader) { return reader.camera(device); });
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
    relayBanks.check(fields);
    contactBanks.check(fields);
    // A look calls outputs and canvases alike.
    for (const auto& [canvas, node] : canvasNodes)
        if (outputNames.contains(canvas))
            fields.check(node, node.error(fmt::format("'{}' is the name of an output; give the canvas another", canvas)));
    for (std::size_t i = 0; i < site.outputs.size(); ++i)
        for (const std::size_t other : site.outputsOn(site.outputs[i].canvas)) {
            const auto &size = site.outputs[i].canvasSize, &otherSize = site.outputs[other].canvasSize;
            if (other >= i || !size || !otherSize || *size == *otherSize) continue;
            fields.check(canvasNodes[i].second,
                         canvasNodes[i].second.error(fmt::format("output '{}' gives the canvas '{}' another 'canvas_size'; "
                                                                 "one of the two is enough",
                                                                 site.outputs[other].name, site.outputs[i].canvas)));
            break;
        }

    relayBanks.each([&](const Bank& bank, std::size_t size) {
        drivers.ask(bank.device.options, [&](DeviceReader& reader) { return reader.relayBank(bank, size); });
    });
    contactBanks.each([&](const Bank& bank, std::size_t size) {
        drivers.ask(bank.device.options, [&](DeviceReader& reader) { return reader.contactBank(bank, size); });
    });
    if (site.simulation && fields.right())
        drivers.ask(*site.simulation, [&](DeviceReader& reader) { return reader.simulation(site); });
    drivers.tell(fields);
    TRY(fields.finish());
    return site;
}

}  // namespace fantascope::show
