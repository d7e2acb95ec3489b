#pragma once

#include "show/schedule/place.h"
#include "show/site/corrections.h"
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

constexpr double kBrightestBlack = 0.1;  // of a projector: a contrast of 10 : 1, with bright ambient light

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

// Where a projector stands by the plan, and its optics.
struct NominalProjector {
    Pose pose;
    double throwRatio = 1.5;    // distance / picture width
    glm::dvec2 lensShift{0.0};  // in picture widths and heights, right and up
};

// Where the camera stands by the plan, and its optics.
struct NominalCamera {
    Pose pose;
    glm::ivec2 size{640, 360};
    double fieldOfView = 1;             // horizontal, radians
    double k1 = 0, k2 = 0;              // radial distortion (Brown 1966)
    std::optional<glm::dvec2> centre;   // where the axis meets the picture, pixels; nothing: in its middle
    std::string lensOf;                 // the camera that the lens was measured on; empty: unknown
    std::vector<double> response;       // linear light of stored values, evenly from 0 to 255; empty: sRGB
    std::vector<glm::ivec2> hotPixels;  // that show light in the dark
};

struct Output {
    std::string name;
    DeviceConfig display;
    double refreshRate = 60;               // Hz
    std::string canvas;                    // outputs with the same canvas show parts of one picture; default: the output's name
    std::optional<glm::dvec2> canvasSize;  // width and height of the whole canvas on the wall, metres, as measured
    Projection projection;
    std::optional<NominalProjector> projector;
    std::optional<Surface> surface;

    glm::ivec2 size() const { return projection.size; }  // pixels of the projector
};

// Another lighting controller, which may take over a universe.
struct Desk {
    DeviceConfig device;
    DmxMerge::Settings merge;
};

struct Universe {
    int number = 1;  // 1 .. 63999
    DeviceConfig port;
    std::optional<Desk> desk;
};

// What DMX lights: consecutive slots, one level each.
struct Fixture {
    std::string name;
    int universe = 1;
    int address = 1;                    // 1 .. 512, of the first channel
    std::vector<std::string> channels;  // "intensity", "red", ...
    std::vector<float> end{};           // 0..1, end levels of the first channels; the other channels end dark
};

// A module with relays, or one with contacts.
struct Bank {
    std::string name;  // unique among all devices
    DeviceConfig device;
};

struct Relay {
    std::string name;
    std::size_t bank = 0;  // of Site::relayBanks
    int coil = 0;          // its place in the bank, from 0; unique
    bool safe = true;      // the safe state; street lamps: on
};

// What a button of the hand controller does. Edit and all after it are for setting up (SiteEditor).
enum class Button {
    Go,
    Back,
    Blackout,
    Pause,
    Freeze,
    Panic,
    Restore,
    Edit,
    Left,
    Right,
    Up,
    Down,
    Next,
    Output,
    Tool,
    Picture,
    Undo,
    Write
};

std::string_view nameOf(Button button);  // its key in the site file: "go"

struct SiteButton {
    int number = 0;  // the device's own; unique
    Button button = Button::Go;
    std::string list{};  // of Go and Back: the name of a show's side list; empty: the main list
    friend bool operator==(const SiteButton&, const SiteButton&) = default;
};

// What a contact asks for when it closes or opens: a door may give GO, an emergency button Panic.
enum class ContactAction { Go, Back, Blackout, Dark, Light, Pause, Freeze, Panic, Restore };

struct Contact {
    std::string name;
    std::size_t bank = 0;                        // of Site::contactBanks
    int input = 0;                               // its place in the bank, from 0; unique
    std::optional<ContactAction> closes, opens;  // at least one
    std::string list{};                          // of Go and Back: the name of a show's side list; empty: the main list
};

// The nominal site: the place as the technician described it. It is read at the start and constant
// afterwards. See docs/site-format.md.
struct Site {
    std::filesystem::path file;
    std::string text;  // the file as it was read
    std::vector<Output> outputs;
    std::vector<Universe> universes;
    std::vector<Fixture> fixtures;
    Time endFade = std::chrono::seconds(1);  // fade of the fixtures to their end levels when the show is over
    std::vector<Bank> relayBanks;            // each with at least one relay
    std::vector<Relay> relays;
    std::optional<DeviceConfig> cueController;
    std::vector<SiteButton> buttons;
    std::vector<Bank> contactBanks;  // each with at least one contact
    std::vector<Contact> contacts;
    std::optional<DeviceConfig> camera;
    std::optional<NominalCamera> nominalCamera;  // set whenever `camera` is
    Corrections corrections;                     // what the program does by itself when the camera sees a difference
    std::optional<Place> place;                  // only schedules need it
    std::optional<ConfigNode> simulation;        // the simulated site's own section

    // The same site with `factor` times as many projector pixels across and down.
    Site scaled(glm::dvec2 factor) const;
    // The indices of the outputs that show parts of one canvas, in the site's order.
    std::vector<std::size_t> outputsOn(std::string_view canvas) const;
    std::size_t firstLevel(std::size_t fixture) const;  // where a fixture's channels begin in Look::levels
    std::size_t channelCount() const;                   // of all fixtures: the size of Look::levels
    std::size_t coilCount(std::size_t bank) const;      // the size of a relay bank: its highest coil + 1
    std::size_t inputCount(std::size_t bank) const;     // the size of a contact bank: its highest input + 1
};

// Checks the drivers' own keys of a site file, because show knows no driver. It opens no device.
// Error of each call: all that is wrong with the keys.
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
    // Called for a site with a `simulation` section, if all other sections are right.
    virtual Result<void> simulation(const Site& site) = 0;
};

// Reads a site file. Strict. Besides wrong types, ranges and unknown keys it refuses: two things
// with one name, coil or button; fixtures that overlap, end beyond slot 512 or are on no universe;
// a bank without relays or contacts; a relay or contact without a bank; a contact without an
// action; folded corners; a surface that faces away from its projector. `devices` checks the
// drivers' keys; null: they are not checked. Error: all faults, one line each, with file, line,
// column, key, advice.
Result<Site> readSite(const std::filesystem::path& file, DeviceReader* devices = nullptr);
// Reads a site from the text of `file`.
Result<Site> parseSite(std::string text, const std::filesystem::path& file, DeviceReader* devices = nullptr);

}  // namespace fantascope::show
