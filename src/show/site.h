#pragma once

#include "core/config.h"
#include "core/geometry.h"
#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::show {

// A device as the site file declares it: the registry's name of its driver and the driver's own keys, which the driver reads.
struct DeviceConfig {
    std::string driver;
    ConfigNode options;  // the whole map, `driver:` included
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
    glm::ivec2 size{1920, 1080};        // pixels of the projector
    double refreshRate = 60;            // Hz
    std::array<glm::dvec2, 4> corners;  // where the canvas's corners go, in projector pixels, clockwise from its top left
    std::optional<NominalProjector> projector;
    std::optional<Surface> surface;

    // The canvas [0, canvasAspect] x [0, 1] onto `corners`, which must make a convex quadrilateral, as those of readSite do.
    Homography projectorFromCanvas(double canvasAspect) const;
};

struct Universe {
    int number = 1;  // 1 .. 63999
    DeviceConfig port;
};

// A DMX lamp: consecutive slots, one level each.
struct Fixture {
    std::string name;
    int universe = 1;
    int address = 1;                    // 1 .. 512, of the first channel
    std::vector<std::string> channels;  // "intensity", "red", ...
};

struct Relay {
    std::string name;
    int coil = 0;      // its place in the bank, from 0
    bool safe = true;  // the state to fall back to; street lamps: on
};

enum class Button { Go, Back, Blackout };

// The place as the technician wrote it down: the nominal site. Read at start, constant afterwards. See docs/site-format.md.
struct Site {
    std::filesystem::path file;
    std::vector<Output> outputs;
    std::vector<Universe> universes;
    std::vector<Fixture> fixtures;
    std::optional<DeviceConfig> relayBank;
    std::vector<Relay> relays;
    std::optional<DeviceConfig> cueController;
    std::vector<std::pair<int, Button>> buttons;  // controller button -> what it does
    std::optional<DeviceConfig> camera;
    std::optional<NominalCamera> nominalCamera;  // there whenever `camera` is
    std::optional<ConfigNode> simulation;        // the simulated site's own section

    std::size_t firstLevel(std::size_t fixture) const;  // where a fixture's channels begin in Look::levels
    std::size_t channelCount() const;                   // of all fixtures: the size of Look::levels
    std::size_t coilCount() const;                      // the highest coil + 1: the size of the relay bank
};

// Strict. Besides types, ranges and unknown keys it refuses two things of one name, coil or button; fixtures on top of each
// other, beyond slot 512 or on no universe; folded corners; a surface turned from its projector. Error: file, line, column, key,
// advice.
Result<Site> readSite(const std::filesystem::path& file);

}  // namespace fantascope::show
