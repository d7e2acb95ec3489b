#pragma once

#include "drivers/display/edid.h"

#include "core/config/config.h"
#include "core/result.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::drivers {

// An area of the X screen in pixels, y down.
struct Area {
    glm::ivec2 corner{0}, size{0};  // top left
    bool operator==(const Area&) const = default;
    glm::ivec2 end() const { return corner + size; }
    bool overlaps(const Area& other) const;
};

// A connector of a graphics card and its monitor or projector. Numbers named `...Id` are the X
// server's.
struct Monitor {
    struct Mode {
        std::uint32_t modeId = 0;
        glm::ivec2 size{0};
        double hertz = 0;  // exact, from the mode's timing; fields if interlaced; 0: unknown
        bool interlaced = false;
    };
    struct Picture {
        std::uint32_t crtcId = 0;
        Area area;  // the shown part of the X screen
        Mode mode;
    };

    std::string connector;  // as listed by `xrandr`: "HDMI-1"
    std::uint32_t outputId = 0;
    bool connected = false;
    bool unplugged = false;                    // it was unplugged meanwhile, even if it is back
    std::optional<MonitorIdentity> identity;   // nothing: no EDID, or a broken one
    std::vector<Mode> modes;                   // that it can show
    std::vector<std::uint32_t> possibleCrtcs;  // that can drive it
    std::optional<Picture> on;                 // nothing: switched off

    // For messages, with the identity in the form of the site file's `monitor`: "HDMI-1 {make: EPS,
    // model: EPSON PJ, serial: X4}".
    std::string text() const;
};

// The monitor that an output is bound to. Empty fields match any.
struct MonitorChoice {
    std::string connector, make, model, serial;

    // A connector's name, or a map of at least one of connector, make, model, serial.
    static Result<MonitorChoice> fromConfig(const ConfigNode& node);
    bool fits(const Monitor& monitor) const;
    std::string text() const;  // in the form that fromConfig() reads
};

}  // namespace fantascope::drivers
