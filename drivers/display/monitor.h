#pragma once

#include "drivers/display/edid.h"

#include "core/config.h"
#include "core/result.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::drivers {

// Pixels of the X screen, y down.
struct Area {
    glm::ivec2 corner{0}, size{0};  // top left
    bool operator==(const Area&) const = default;
    glm::ivec2 end() const { return corner + size; }
    bool overlaps(const Area& other) const;
};

// A connector of a graphics card, and the monitor or projector on it. Numbers named `...Id` are the
// X server's.
struct Monitor {
    struct Mode {
        std::uint32_t modeId = 0;
        glm::ivec2 size{0};
        double hertz = 0;  // exact, from the mode's timing; of an interlaced one its fields; 0: the X server does not tell
        bool interlaced = false;
    };
    struct Picture {
        std::uint32_t crtcId = 0;
        Area area;  // what it shows of the X screen
        Mode mode;
    };

    std::string connector;  // as `xrandr` lists it: "HDMI-1"
    std::uint32_t outputId = 0;
    bool connected = false;
    bool unplugged = false;                    // it was, in the meantime, whatever it is now
    std::optional<MonitorIdentity> identity;   // nothing: it has no EDID, or a broken one
    std::vector<Mode> modes;                   // that it can show
    std::vector<std::uint32_t> possibleCrtcs;  // that can drive it
    std::optional<Picture> on;                 // nothing: it is switched off

    // For a person, with the identity as the site file's `monitor` takes it: "HDMI-1 {make: EPS,
    // model: EPSON PJ, serial: X4}".
    std::string text() const;
};

// Which monitor an output is bound to. What is empty fits any.
struct MonitorChoice {
    std::string connector, make, model, serial;

    // A connector's name, or a map of at least one of connector, make, model, serial.
    static Result<MonitorChoice> fromConfig(const ConfigNode& node);
    bool fits(const Monitor& monitor) const;
    std::string text() const;  // as fromConfig() takes it
};

}  // namespace fantascope::drivers
