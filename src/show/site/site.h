#pragma once

#include "show/site/dmx_merge.h"

#include "core/clock.h"
#include "core/config/config.h"
#include "core/geometry.h"
#include "core/result.h"
#include "media/projection.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::show {

constexpr double kBrightestBlack = 0.1;  // of a projector: 10 : 1, in bright surroundings

// A device as the site file declares it: the registry's name of its driver and the driver's own
// keys, which the driver reads.
struct DeviceConfig {
    std::string driver;
    ConfigNode options;  // the whole map, `driver:` included
    friend bool operator==(const DeviceConfig&, const DeviceConfig&) = default;
};

// The plane that an output's picture falls on.
struct Surface {
    glm::dvec3 point{0.0};
    glm::dvec3 normal{0, 0, 1};  // unit, towards the projector
};

// Where a projector or a camera stands by the drawings, and its optics.
struct NominalProjector {
    Pose pose;
    double throwRatio = 1.5;    // distance / picture width
    glm::dvec2 lensShift{0.0};  // in picture widths and heights, right and up
};

struct NominalCamera {
    Pose pose;
    glm::ivec2 size{640, 360};
    double fieldOfView = 1;  // horizontal, radians
    double k1 = 0, k2 = 0;   // radial distortion (Brown 1966)
};

struct Output {
    std::string name;
    DeviceConfig display;
    double refreshRate = 60;               // Hz
    std::string canvas;                    // the outputs of one name throw parts of one picture; its own name where no other does
    std::optional<glm::dvec2> canvasSize;  // width and height of the whole canvas on the wall, metres, as somebody measured it
    Projection projection;
    std::optional<NominalProjector> projector;
    std::optional<Surface> surface;

    glm::ivec2 size() const { return projection.size; }  // pixels of the projector
};

// Somebody else's desk, which may take a universe over.
struct Desk {
    DeviceConfig device;
    DmxMerge::Settings merge;
};

struct Universe {
    int number = 1;  // 1 .. 63999
    DeviceConfig port;
    std::optional<Desk> desk;
};

// A DMX lamp: consecutive slots, one level each.
struct Fixture {
    std::string name;
    int universe = 1;
    int address = 1;                    // 1 .. 512, of the first channel
    std::vector<std::string> channels;  // "intensity", "red", ...
    std::vector<float> end{};           // 0..1, of each channel when the show is over; channels beyond the last one are dark
};

// A module with relays, or one with contacts.
struct Bank {
    std::string name;  // no other device has it
    DeviceConfig device;
};

struct Relay {
    std::string name;
    std::size_t bank = 0;  // of Site::relayBanks
    int coil = 0;          // its place in the bank, from 0; each once
    bool safe = true;      // the state to fall back to; street lamps: on
};

// From Edit on they set the outputs up (SiteEditor).
enum class Button { Go, Back, Blackout, Edit, Left, Right, Up, Down, Next, Output, Tool, Picture, Undo, Write };

std::string_view nameOf(Button button);  // its key in the site file: "go"

// What a contact that moves asks for: a door may be a GO, an emergency button the dark.
enum class ContactAction { Go, Back, Blackout, Dark, Light };

struct Contact {
    std::string name;
    std::size_t bank = 0;                        // of Site::contactBanks
    int input = 0;                               // its place in the bank, from 0; each once
    std::optional<ContactAction> closes, opens;  // at least one
};

// The place as the technician wrote it down: the nominal site. Read at start, constant afterwards.
// See docs/site-format.md.
struct Site {
    std::filesystem::path file;
    std::string text;  // the file as it was read
    std::vector<Output> outputs;
    std::vector<Universe> universes;
    std::vector<Fixture> fixtures;
    Time endFade = std::chrono::seconds(1);  // in which lamps go to Fixture::end when the show is over
    std::vector<Bank> relayBanks;            // each with at least one relay
    std::vector<Relay> relays;
    std::optional<DeviceConfig> cueController;
    std::vector<std::pair<int, Button>> buttons;  // controller button -> what it does; each number once
    std::vector<Bank> contactBanks;               // each with at least one contact
    std::vector<Contact> contacts;
    std::optional<DeviceConfig> camera;
    std::optional<NominalCamera> nominalCamera;  // there whenever `camera` is
    std::optional<ConfigNode> simulation;        // the simulated site's own section

    // The same with projectors that have `factor` times as many pixels across and down.
    Site scaled(glm::dvec2 factor) const;
    // The indices of the outputs that throw parts of one canvas, in the site's order.
    std::vector<std::size_t> outputsOn(std::string_view canvas) const;
    std::size_t firstLevel(std::size_t fixture) const;  // where a fixture's channels begin in Look::levels
    std::size_t channelCount() const;                   // of all fixtures: the size of Look::levels
    std::size_t coilCount(std::size_t bank) const;      // a relay bank's highest coil + 1: its size
    std::size_t inputCount(std::size_t bank) const;     // a contact bank's highest input + 1: its size
};

// Reads the keys of a site file that are a driver's own: show knows no driver. Nothing is opened.
// Each call gives all that is wrong with them.
class DeviceReader {
public:
    virtual ~DeviceReader() = default;
    virtual Result<void> display(const Output& output) = 0;
    virtual Result<void> port(const DeviceConfig& device, int universe) = 0;
    virtual Result<void> desk(const DeviceConfig& device, int universe) = 0;
    virtual Result<void> relayBank(const Bank& bank, std::size_t size) = 0;
    virtual Result<void> contactBank(const Bank& bank, std::size_t size) = 0;
    virtual Result<void> cueController(const DeviceConfig& device) = 0;
    virtual Result<void> camera(const DeviceConfig& device) = 0;
    // Of a site with a `simulation` section, when all other sections are right.
    virtual Result<void> simulation(const Site& site) = 0;
};

// Strict. Besides types, ranges and unknown keys it refuses two things of one name, coil or button;
// fixtures on top of each other, beyond slot 512 or on no universe; a bank without a relay or
// contact, and those of no bank; a contact that asks for nothing; folded corners; a surface turned
// from its projector. `devices` reads what the drivers need; null: nobody does. Error: all that is
// wrong, a line for each with file, line, column, key, advice.
Result<Site> readSite(const std::filesystem::path& file, DeviceReader* devices = nullptr);
// The same of a text that stood in `file`.
Result<Site> parseSite(std::string text, const std::filesystem::path& file, DeviceReader* devices = nullptr);

}  // namespace fantascope::show
