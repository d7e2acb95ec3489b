#include "show/site/bank_reader.h"
#include "show/site/output_reader.h"
#include "show/site/site.h"
#include "show/site/site_fields.h"

#include "core/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace fantascope::show {
namespace {

constexpr int kNewestVersion = 1;

constexpr int kLastUniverse = 63999;    // ANSI E1.31
constexpr int kLastSlot = 512;          // ANSI E1.11
constexpr double kLongestEndFade = 60;  // seconds
constexpr int kLastButton = 255;        // more than any hand-held device has

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

// Reads end levels: one for all channels, or a map with the levels of some channels; the others are
// dark.
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

// `owners`: the fixture of each slot (universe, address) that is taken so far.
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

Result<std::vector<SiteButton>> readButtons(const ConfigNode& node) {
    std::vector<SiteButton> buttons;
    std::set<int> numbers;
    const auto read = [&](ConfigFields& fields, Button button, const std::string& list) {
        std::optional<int> number;
        fields.read(nameOf(button), number, onceNumbered(numbers, "button", 1, kLastButton));
        if (number) buttons.push_back({*number, button, list});
    };
    ConfigFields fields(node);
    for (int i = 0; i <= static_cast<int>(Button::Write); ++i) {
        const auto button = static_cast<Button>(i);
        if (button != Button::Go) fields.optional();
        read(fields, button, "");
    }
    bool hasLists = false;
    fields.optional().read("lists", hasLists, [&](const ConfigNode& lists) -> Result<bool> {
        ConfigFaults faults;
        for (const auto& [name, list] : TRY(lists.entries())) {
            ConfigFields ofList(list);
            read(ofList, Button::Go, name);
            read(ofList.optional(), Button::Back, name);
            if (const auto done = ofList.finish(); !done) faults.add(done.error());
        }
        TRY(faults.result());
        return true;
    });
    TRY(fields.finish());
    return buttons;
}

// Refuses the old keys, from when a site had at most one bank of each kind.
Result<void> refuseOldBanks(const ConfigNode& root) {
    for (const auto& [old, members] : {std::pair("relay_bank", "relays"), std::pair("contact_bank", "contacts")})
        if (const auto value = root.find(old))
            return value->error(
                fmt::format("there may be several now; write '{0}s: [{{name: NAME, device: ...}}]', and '{1}' "
                            "beside it instead of in it",
                            old, members));
    return {};
}

// Reads one site file, section by section, in the order of their dependencies.
class SiteReader {
public:
    SiteReader(const ConfigNode& root, DeviceReader* devices) : fields_(root), drivers_(devices) {}

    Result<Site> read(Site site) {
        site_ = std::move(site);
        fields_.header("site", kNewestVersion);
        readOutputs();
        readLighting();
        readBanks();
        readController();
        readCamera();
        readPlace();
        fields_.optional().read("corrections", site_.corrections,
                                [&](const ConfigNode& node) { return readCorrections(node, site_, fields_.right()); });
        fields_.optional().read("simulation", site_.simulation,
                                [](const ConfigNode& node) -> Result<ConfigNode> { return node; });
        relayBanks_.check(fields_);
        contactBanks_.check(fields_);
        checkCanvases();
        askOfBanks();
        if (site_.simulation && fields_.right())
            drivers_.ask(*site_.simulation, [&](DeviceReader& reader) { return reader.simulation(site_); });
        drivers_.tell(fields_);
        TRY(fields_.finish());
        return std::move(site_);
    }

private:
    void readOutputs() {
        fields_.list(
            "outputs", site_.outputs,
            [&](const ConfigNode& node) -> Result<Output> {
                Output output = TRY(readOutput(node, outputNames_, drivers_));
                canvasNodes_.emplace_back(output.canvas, node);
                if (output.canvas.empty()) output.canvas = output.name;
                return output;
            },
            1);
    }

    void readLighting() {
        fields_.optional().list("universes", site_.universes,
                                [&](const ConfigNode& node) { return readUniverse(node, universes_, drivers_); });
        std::set<std::string> fixtureNames;
        std::map<std::pair<int, int>, std::string> slotOwners;
        fields_.optional().list("fixtures", site_.fixtures,
                                [&](const ConfigNode& node) { return readFixture(node, fixtureNames, universes_, slotOwners); });

        fields_.optional().time("end_fade", site_.endFade, 0, kLongestEndFade);
    }

    void readBanks() {
        // The names of all other devices, in their status and in a fault script.
        std::set<std::string> deviceNames(outputNames_);
        deviceNames.insert({"cue controller", "camera"});
        for (const int number : universes_.numbers)
            deviceNames.insert({fmt::format("universe {}", number), fmt::format("desk {}", number)});
        std::set<std::string> relayNames, contactNames;
        fields_.optional().list("relay_banks", site_.relayBanks,
                                [&](const ConfigNode& node) { return relayBanks_.read(node, deviceNames); });
        fields_.optional().list("relays", site_.relays,
                                [&](const ConfigNode& node) { return readRelay(node, relayNames, relayBanks_); });
        fields_.optional().list("contact_banks", site_.contactBanks,
                                [&](const ConfigNode& node) { return contactBanks_.read(node, deviceNames); });
        fields_.optional().list("contacts", site_.contacts,
                                [&](const ConfigNode& node) { return readContact(node, contactNames, contactBanks_); });
    }

    void readPlace() {
        fields_.optional().read("place", site_.place, [](const ConfigNode& node) -> Result<std::optional<Place>> {
            return std::optional(TRY(show::readPlace(node)));
        });
    }

    void readController() {
        fields_.optional().read("cue_controller", site_.cueController, [&](const ConfigNode& node) -> Result<DeviceConfig> {
            DeviceConfig device;
            ConfigFields controller(node);
            controller.read("device", device, readDevice);
            if (!device.driver.empty())
                drivers_.ask(device.options, [&](DeviceReader& reader) { return reader.cueController(device); });
            controller.read("buttons", site_.buttons, readButtons);
            TRY(controller.finish());
            return device;
        });
    }

    void readCamera() {
        fields_.optional().read("camera", site_.camera, [&](const ConfigNode& node) -> Result<DeviceConfig> {
            DeviceConfig device;
            NominalCamera camera;
            Aim aim;
            ConfigFields keys(node);
            keys.read("device", device, readDevice);
            if (!device.driver.empty()) drivers_.ask(device.options, [&](DeviceReader& reader) { return reader.camera(device); });
            keys.read("size", camera.size, readSize);
            keys.angle("field_of_view", camera.fieldOfView, 1, 179);
            aim.declare(keys);
            keys.optional().number("k1", camera.k1, -1, 1);
            keys.optional().number("k2", camera.k2, -1, 1);
            keys.optional().read("centre", camera.centre, [](const ConfigNode& value) -> Result<std::optional<glm::dvec2>> {
                return std::optional(TRY(value.vector2(-kMostPixels, 2 * kMostPixels, "px")));
            });
            keys.optional().text("lens_of", camera.lensOf);
            keys.optional().read("response", camera.response, readResponse);
            keys.optional().list("hot_pixels", camera.hotPixels, readWholePixel, 0, kMostHotPixels);
            TRY(keys.finish());
            camera.pose = TRY(aim.pose(node));
            site_.nominalCamera = camera;
            return device;
        });
    }

    void checkCanvases() {
        // A look uses the names of outputs and canvases in the same way.
        for (const auto& [canvas, node] : canvasNodes_)
            if (outputNames_.contains(canvas))
                fields_.check(node, node.error(fmt::format("'{}' is the name of an output; give the canvas another", canvas)));
        for (std::size_t i = 0; i < site_.outputs.size(); ++i)
            for (const std::size_t other : site_.outputsOn(site_.outputs[i].canvas)) {
                const auto &size = site_.outputs[i].canvasSize, &otherSize = site_.outputs[other].canvasSize;
                if (other >= i || !size || !otherSize || *size == *otherSize) continue;
                fields_.check(canvasNodes_[i].second,
                              canvasNodes_[i].second.error(fmt::format("output '{}' gives the canvas '{}' another 'canvas_size'; "
                                                                       "one of the two is enough",
                                                                       site_.outputs[other].name, site_.outputs[i].canvas)));
                break;
            }
    }

    void askOfBanks() {
        relayBanks_.each([&](const Bank& bank, std::size_t size) {
            drivers_.ask(bank.device.options, [&](DeviceReader& reader) { return reader.relayBank(bank, size); });
        });
        contactBanks_.each([&](const Bank& bank, std::size_t size) {
            drivers_.ask(bank.device.options, [&](DeviceReader& reader) { return reader.contactBank(bank, size); });
        });
    }

    ConfigFields fields_;
    DriversWord drivers_;
    Site site_;
    std::set<std::string> outputNames_;
    std::vector<std::pair<std::string, ConfigNode>> canvasNodes_;  // of each output: its canvas as named in the file, or ""
    Universes universes_;
    Banks relayBanks_{"relay_banks", "relays"}, contactBanks_{"contact_banks", "contacts"};
};

}  // namespace

Result<Site> readSite(const std::filesystem::path& file, DeviceReader* devices) {
    return parseSite(TRY(readFile(file)), file, devices);
}

Result<Site> parseSite(std::string text, const std::filesystem::path& file, DeviceReader* devices) {
    const ConfigNode root = TRY(ConfigNode::parse(text, file));
    TRY(refuseOldBanks(root));
    Site site;
    site.file = file;
    site.text = std::move(text);
    return SiteReader(root, devices).read(std::move(site));
}

}  // namespace fantascope::show
